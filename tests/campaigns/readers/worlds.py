"""Readers of worlds of other formats: SDF, MoveIt's scenes and messages."""

from __future__ import annotations

from pathlib import Path

from tests.campaigns import mutation
from tests.campaigns.reader import Reader, of_file


def _sdfs(folder: Path) -> list[bytes]:
    from tests.damaged.trials import SDF_WORLDS

    del folder
    frames = Path(__file__).parents[2] / "world" / "files" / "frames.sdf"
    return [*(text.encode() for text in SDF_WORLDS), frames.read_bytes()]


def _scenes(folder: Path) -> list[bytes]:
    from tests.world.test_scene import NEW, OLD

    del folder
    return [NEW.encode(), OLD.encode()]


def _load_sdf(path: Path) -> None:
    from harness.plugins.formats.sdf.world import load_sdf

    load_sdf(path)


def _load_scene(path: Path) -> None:
    from harness.plugins.formats.moveit_scene.scene import load_scene

    load_scene(path)


def _messages(folder: Path) -> list[bytes]:
    from tests.cli.test_import_moveit import LISTS, MAPPINGS, REQUEST

    del folder
    return [text.encode() for text in (LISTS, MAPPINGS, REQUEST)]


def _load_message(path: Path) -> None:
    from harness.plugins.formats.moveit_messages.request import read_request
    from harness.plugins.formats.moveit_messages.scene import read_scene
    from harness.robot.packages import PackagePath

    if "goal_constraints" in path.read_text(encoding="utf-8", errors="replace"):
        read_request(path)
    else:
        read_scene(path, {"base_link"}, PackagePath.of_file(path))


READERS: dict[str, Reader] = {
    "sdf": Reader(_sdfs, mutation.of_xml, of_file("a.sdf", _load_sdf)),
    "scene": Reader(_scenes, mutation.of_text, of_file("a.scene", _load_scene)),
    "messages": Reader(_messages, mutation.of_yaml, of_file("a.yaml", _load_message)),
}
