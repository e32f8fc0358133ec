"""`harness import`: files of other programs as harness files."""

from __future__ import annotations

import argparse
from contextlib import ExitStack
from pathlib import Path
from typing import ClassVar

from harness.cli.arguments import output_path
from harness.cli.command import EXCHANGE, Command
from harness.cli.files import refuse_existing, refusing_unwritable
from harness.cli.output import say
from harness.cli.robot_options import add_robot_options, source_of
from harness.cli.work_bar import WorkBar
from harness.core.files import replaced
from harness.core.printable import counted
from harness.suite.discovery import SUFFIX, UsageError

MOST_NOTES = 20  # printed; the rest is counted


class ImportCommand(Command):
    """Convert files of other programs."""

    name: ClassVar[str] = "import"
    group: ClassVar[str] = EXCHANGE
    reads_geometry: ClassVar[bool] = True

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness import`."""
        add = command.add_argument
        text = "the format of FILE"
        add("kind", choices=("sdf", "mjcf", "scene", "srdf", "moveit"), help=text)
        text = (
            "an SDF world, an MJCF scene, a MoveIt .scene or an SRDF; for `moveit`, any number of"
            " PlanningScene and MotionPlanRequest files in YAML"
        )
        add("files", metavar="FILE", nargs="+", help=text)
        text = (
            "write to this path (default: FILE's name with .yaml; of an SRDF a folder of FILE's"
            " name; for `moveit` the folder `scenarios` next to the first FILE)"
        )
        add("-o", "--output", metavar="FILE", type=output_path, help=text)
        text = "look models up here before GZ_SIM_RESOURCE_PATH; an MJCF may read files in it"
        add("--model-path", metavar="DIR", action="append", default=[], help=text)
        add("--force", action="store_true", help="overwrite what exists")
        text = (
            "the robot of an SRDF or of MoveIt's files: a URDF, xacro, MJCF or SDF; for `moveit`"
            " also a bundled name"
        )
        add("--robot", metavar="FILE", default="", help=text)
        add_robot_options(command)

    def run(self, arguments: argparse.Namespace) -> int:
        """Write a world file or a robot's folder; what is left out of the other is reported."""
        if arguments.kind == "moveit":
            return _moveit(arguments)
        if arguments.srdf:
            raise UsageError(
                "--srdf goes with `import moveit`; `import srdf FILE` names it as FILE"
            )
        if len(arguments.files) > 1:
            raise UsageError(
                f"`import {arguments.kind}` takes one FILE, not {len(arguments.files)}"
            )
        [arguments.file] = arguments.files
        return _robot(arguments) if arguments.kind == "srdf" else _world(arguments)


def _moveit(arguments: argparse.Namespace) -> int:
    """Write a world for each scene, and a scenario for each request."""
    if not arguments.robot:
        raise UsageError(
            "MoveIt's files do not say which robot they are for: add --robot FILE or --robot NAME"
        )
    files = [Path(name) for name in arguments.files]
    folder = Path(arguments.output) if arguments.output else files[0].parent / "scenarios"
    if folder.suffix:
        raise UsageError(f"'{folder}' is no folder: a world and a scenario are written into one")
    from harness.plugins.formats.moveit_import import import_moveit

    found = import_moveit(files, source_of(arguments), folder, WorkBar())
    _write(found.files, is_forced=arguments.force)
    for note in found.notes[:MOST_NOTES]:
        say(f"note: {note}")
    if len(found.notes) > MOST_NOTES:
        say(f"note: {len(found.notes) - MOST_NOTES} more of the other files")
    scenarios = sum(path.name.endswith(SUFFIX) for path in found.files)
    say(f"wrote {counted(scenarios, 'scenario')} into {folder}")
    return 0


def _robot(arguments: argparse.Namespace) -> int:
    """Write robot.yaml, and the URDF and SRDF that it names."""
    source = Path(arguments.file)
    if arguments.model_path:
        raise UsageError("--model-path is for SDF; an SRDF's robot has --package-path")
    if source.is_dir():
        raise UsageError(f"'{source}' is a folder: name the SRDF in it")
    if not arguments.robot:
        raise UsageError("an SRDF says nothing without its robot: --robot FILE (URDF, MJCF, SDF)")
    folder = Path(arguments.output) if arguments.output else source.with_suffix("")
    folder = folder.parent if folder.name == "robot.yaml" else folder
    if folder.suffix:
        raise UsageError(f"'{folder}' is no folder: robot.yaml, URDF and SRDF are written into one")
    from harness.language.scenario import RobotSpec
    from harness.plugins.formats.robot_files.robot_folder import robot_folder
    from harness.robot.robot_source import KINDS

    robot = source_of(argparse.Namespace(**{**vars(arguments), "srdf": arguments.file}))
    if robot.kind not in KINDS.values():
        raise UsageError(f"--robot is a URDF, xacro, MJCF or SDF file, not '{arguments.robot}'")
    found = robot_folder(RobotSpec.of_options(robot.words()), Path(), folder)
    contents = {folder / name: text.encode() for name, text in found.files.items()}
    _write(contents, is_forced=arguments.force)
    for note in found.notes:
        say(f"note: {note}")
    say(f"wrote {', '.join(map(str, contents))}; `robot: {{model: {folder}}}`")
    return 0


def _world(arguments: argparse.Namespace) -> int:
    source = Path(arguments.file)
    if arguments.robot:
        raise UsageError("--robot goes with an SRDF")
    if source.is_dir():
        raise UsageError(f"'{source}' is a folder: name the file in it")
    target = Path(arguments.output) if arguments.output else source.with_suffix(".yaml")
    if target.suffix.lower() not in (".yaml", ".yml"):
        raise UsageError(f"the name of a world file ends in .yaml, not '{target.name}'")
    if arguments.kind == "scene" and arguments.model_path:
        raise UsageError("--model-path is for SDF; a scene holds its meshes itself")
    from harness.plugins.formats.mjcf.scene import load_mjcf
    from harness.plugins.formats.moveit_scene.scene import load_scene
    from harness.plugins.formats.sdf.round_meshes import round_meshes
    from harness.plugins.formats.sdf.world import load_sdf
    from harness.plugins.formats.stl import stl_bytes
    from harness.plugins.formats.world_text import world_text

    meshes: dict[Path, bytes] = {}
    if arguments.kind == "scene":
        scene = load_scene(source)
        imported = scene.imported
        meshes = {target.parent / name: stl_bytes(mesh) for name, mesh in scene.meshes.items()}
    else:
        load = load_mjcf if arguments.kind == "mjcf" else load_sdf
        imported = load(source, [Path(folder) for folder in arguments.model_path])
        meshes = {
            target.parent / mesh.name: mesh.read_bytes() for mesh in round_meshes(imported.world)
        }
    imported.refuse_unusable()
    text = world_text(imported.world, target.parent, _comment(source, imported.notes))
    _write({**meshes, target: text.encode()}, is_forced=arguments.force)
    for note in imported.notes:
        say(f"note: {note}")
    count = len(imported.world.objects)
    say(f"wrote {target}: {counted(count, 'object')}; `world: {target.name}`")
    return 0


def _comment(source: Path, notes: tuple[object, ...]) -> str:
    left_out = "" if not notes else "; not taken over:"
    return "\n".join([f"From {source.name}{left_out}", *(f"  {note}" for note in notes)])


def _write(files: dict[Path, bytes], *, is_forced: bool) -> None:
    """Write all files, or none where one is there already or cannot be written."""
    for path in files:
        refuse_existing(path, is_forced=is_forced)
    with refusing_unwritable(), ExitStack() as parts:
        for path, content in files.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            file = parts.enter_context(replaced(path))
            file.write(content)
            file.flush()
