"""Which scenario files a command line, or a test run, means."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path

from harness.core.errors import HarnessError
from harness.core.resources import data_folder

SUFFIX = ".scenario.yaml"


class UsageError(HarnessError):
    """A command names something that does not exist (exit code 2)."""


def discover(paths: Sequence[str | Path]) -> list[Path]:
    """Find scenario files.

    A path is a file (of any name), a folder (its `*.scenario.yaml`, at any depth, in the order of
    their names), or, where no such path exists, a bundled scenario or folder of them, with or
    without `.scenario.yaml`: `lessons`, `lessons/01_gripper_and_joints`.

    Returns:
        Files in the order of `paths`, each once.

    Raises:
        UsageError: A path does not exist, or is a folder without scenarios.
    """
    found: dict[Path, Path] = {}
    for path in paths:
        for file in _files(Path(path)):
            found.setdefault(file.resolve(), file)
    return list(found.values())


def bundled_scenarios() -> dict[str, Path]:
    """Names of the bundled scenarios and their files."""
    folder = data_folder("scenarios")
    here = Path.cwd()
    if folder.is_relative_to(here):
        folder = folder.relative_to(here)
    return {
        file.relative_to(folder).as_posix().removesuffix(SUFFIX): file
        for file in _in_folder(folder)
    }


def _files(path: Path) -> list[Path]:
    if path.is_file():
        return [path]
    if path.is_dir():
        files = _in_folder(path)
        if not files:
            raise UsageError(f"no *{SUFFIX} in folder '{path}'")
        return files
    bundled = bundled_scenarios()
    name = path.as_posix().removesuffix(SUFFIX)
    if name in bundled:
        return [bundled[name]]
    below = [file for each, file in bundled.items() if each.startswith(f"{name}/")]
    if below and not path.is_absolute():
        return below
    raise UsageError(f"no such file or folder: '{path}'{_hint(path, bundled)}")


def _in_folder(folder: Path) -> list[Path]:
    files = (file for file in folder.rglob(f"*{SUFFIX}") if file.is_file())
    return sorted(
        file
        for file in files
        if not any(part.startswith(".") for part in file.relative_to(folder).parts)
    )


def _hint(path: Path, bundled: dict[str, Path]) -> str:
    siblings = [
        str(file)
        for file in (path.parent.iterdir() if path.parent.is_dir() else ())
        if _usable(file)
    ]
    near = get_close_matches(str(path), sorted(siblings) + sorted(bundled), n=1, cutoff=0.5)
    if near:
        return f"; did you mean '{near[0]}'?"
    return "; `harness new FILE` writes a scenario to start from"


def _usable(file: Path) -> bool:
    return file.name.endswith(SUFFIX) or (file.is_dir() and not file.name.startswith("."))
