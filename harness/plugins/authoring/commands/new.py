"""`harness new`: a scenario to start from."""

from __future__ import annotations

import argparse
import shlex
from pathlib import Path
from typing import ClassVar

from harness.cli.arguments import output_path
from harness.cli.command import SCENARIOS, Command
from harness.cli.output import output, say, say_text
from harness.cli.robot_options import ROBOT, add_robot_options, source_of
from harness.core.files import write_whole
from harness.core.registry import registry
from harness.core.resources import data_folder
from harness.plugins.authoring.new_project import SCENARIO, SCHEMA, files_outside, write_project
from harness.suite.discovery import SUFFIX, UsageError

TEMPLATE = Path(__file__).parents[1] / "templates" / "new.scenario.yaml"


class NewCommand(Command):
    """Write a commented scenario that passes, or a project of scenarios."""

    name: ClassVar[str] = "new"
    group: ClassVar[str] = SCENARIOS
    reads_geometry: ClassVar[bool] = True

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness new`."""
        text = "the scenario file to write, as first.scenario.yaml; with --assignment a folder"
        command.add_argument(
            "file", metavar="FILE", type=output_path, nargs="?", default="", help=text
        )
        text = (
            "write a folder for a repository of scenarios instead: a first scenario, a baseline of"
            " margins, and files for pytest, GitHub and GitLab"
        )
        command.add_argument("--project", metavar="DIR", type=output_path, default="", help=text)
        command.add_argument("--robot", metavar="ROBOT", default="", help=ROBOT)
        add_robot_options(command)
        names = list(registry("starter").built_in_modules)
        if names:
            text = "write a whole folder for this grading system in place of a scenario"
            command.add_argument("--assignment", choices=names, default="", help=text)
        command.set_defaults(assignment="")

    def run(self, arguments: argparse.Namespace) -> int:
        """Write a scenario to a new file, or a project to a new folder."""
        if bool(arguments.file) == bool(arguments.project):
            raise UsageError("name either a file, such as first.scenario.yaml, or --project DIR")
        if arguments.project:
            return _new_project(arguments)
        file = Path(arguments.file)
        if arguments.assignment:
            say_text("\n".join(registry("starter").find(arguments.assignment)().write(file)))
            return 0
        if not file.name.endswith(SUFFIX):
            better = file.with_name(f"{file.stem}{SUFFIX}")
            raise UsageError(f"the name of a scenario ends in {SUFFIX}: try '{better}'")
        if file.exists():
            raise UsageError(f"'{file}' exists already; nothing was written")
        lines = _write(arguments, file)
        name = shlex.quote(str(file))
        say(f"wrote {file}")
        for line in lines:
            say_text(line)
        say(f"check it: harness check {name}", f"run it:   harness run {name}")
        return 0


def _new_project(arguments: argparse.Namespace) -> int:
    folder = Path(arguments.project)
    lines: list[str] = []
    write_project(folder, lambda file: lines.extend(_write(arguments, file)))
    say(f"wrote {folder}: README.md describes its files")
    for line in lines:
        say_text(line)
    outside = files_outside(folder)
    if outside:
        robot = f"a pipeline has this folder alone: copy the robot into it, and correct {SCENARIO}"
        say_text(f"{', '.join(outside)} {'is' if len(outside) == 1 else 'are'} outside; {robot}")
    again = "harness run scenarios --baseline margins.json"
    say(f"run it:   cd {shlex.quote(str(folder))} && {again}")
    say(f"then keep its margins: {again} --update-baseline")
    return 0


def _write(arguments: argparse.Namespace, file: Path) -> list[str]:
    """Write a scenario; return what there is to say about it.

    Raises:
        UsageError: The file cannot be written.
    """
    is_new_folder = not file.parent.exists()
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        text, lines = _content(arguments, file)
        write_whole(file, f"# yaml-language-server: $schema={_schema(file)}\n{text}")
    except OSError as error:
        raise UsageError(f"cannot write '{file}': {error.strerror}") from error
    finally:
        if is_new_folder and file.parent.is_dir() and not any(file.parent.iterdir()):
            file.parent.rmdir()
    return lines


def _schema(file: Path) -> str:
    """The schema for editors: in the file's folder or above it, else the bundled one."""
    folder = file.parent.resolve()
    for level, above in enumerate((folder, *folder.parents)):
        if (above / SCHEMA).is_file():
            return "../" * level + SCHEMA
    return str(data_folder("scenarios") / SCHEMA)


def _content(arguments: argparse.Namespace, file: Path) -> tuple[str, list[str]]:
    """The scenario, and what to say about it."""
    if not arguments.robot:
        for option in ("srdf", "gripper", "group", "tcp_link", "package_path", "args"):
            if getattr(arguments, option):
                raise UsageError(f"--{option.replace('_', '-')} goes with --robot")
        return TEMPLATE.read_text(encoding="utf-8"), []
    from harness.plugins.authoring.first_scenario import first_scenario

    source = source_of(arguments)
    if source.kind == "scenario":
        raise UsageError(f"--robot is a robot, and '{arguments.robot}' a scenario")
    found = first_scenario(source, file, lambda text: output().status(lambda: text))
    lines = [f"it is a motion and no pick: {found.no_pick}"] if found.no_pick else []
    if found.trouble:
        return found.text, [*lines, f"no steps were found that pass; the last: {found.trouble}"]
    return found.text, [*lines, "it was run once and passed"]
