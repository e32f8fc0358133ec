"""`harness import`: files of other programs as files of ours."""

from __future__ import annotations

import argparse
import os
import tempfile
from pathlib import Path

from harness.cli.output import guarded, say
from harness.suite.discovery import UsageError


def run(arguments: argparse.Namespace) -> int:
    """Write a world file; what of the other file is left out is told."""
    return guarded(lambda: _run(arguments))


def _run(arguments: argparse.Namespace) -> int:
    source = Path(arguments.file)
    target = Path(arguments.output) if arguments.output else source.with_suffix(".yaml")
    if target.suffix.lower() not in (".yaml", ".yml"):
        raise UsageError(f"the name of a world file ends in .yaml, not '{target.name}'")
    if arguments.kind == "scene" and arguments.model_path:
        raise UsageError("--model-path is for SDF; a scene holds its meshes itself")
    from harness.importers.scene import load_scene
    from harness.importers.sdf_world import load_sdf
    from harness.importers.stl import stl_bytes
    from harness.importers.world_text import world_text

    meshes: dict[Path, bytes] = {}
    if arguments.kind == "scene":
        scene = load_scene(source)
        imported = scene.imported
        meshes = {target.parent / name: stl_bytes(mesh) for name, mesh in scene.meshes.items()}
    else:
        imported = load_sdf(source, [Path(folder) for folder in arguments.model_path])
    text = world_text(imported.world, target.parent, _comment(source, imported.notes))
    _write({**meshes, target: text.encode()}, is_forced=arguments.force)
    for note in imported.notes:
        say(f"note: {note}")
    count = len(imported.world.objects)
    say(f"wrote {target}: {count} object{'s' if count != 1 else ''}; `world: {target.name}`")
    return 0


def _comment(source: Path, notes: tuple[object, ...]) -> str:
    left_out = "" if not notes else "; not taken over:"
    return "\n".join([f"From {source.name}{left_out}", *(f"  {note}" for note in notes)])


def _write(files: dict[Path, bytes], *, is_forced: bool) -> None:
    """Write all files, or none where one is there already or cannot be written."""
    for path in files:
        if path.exists() and not is_forced:
            raise UsageError(f"'{path}' is there already; nothing was written (--force overwrites)")
    written: list[tuple[str, Path]] = []
    try:
        for path, content in files.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
                written.append((file.name, path))
                file.write(content)
            Path(file.name).chmod(0o666 & ~_umask())
        for name, path in written:
            Path(name).replace(path)
    except OSError as error:
        for name, _ in written:
            Path(name).unlink(missing_ok=True)
        raise UsageError(f"cannot write '{error.filename}': {error.strerror}") from error


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
