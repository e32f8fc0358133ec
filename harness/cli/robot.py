"""`harness robot check|show`: a robot looked over, and drawn."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from harness.cli.output import guarded, only_json_on_stdout, say
from harness.cli.robot_options import source_of
from harness.suite.discovery import UsageError

if TYPE_CHECKING:
    from harness.robot.description import RobotDescription

PICTURES = (".png", ".jpg", ".jpeg")
SAMPLES, SAMPLES_FOR_SRDF = 2000, 10_000
FORMAT = "armharness-robot/1"


def run(arguments: argparse.Namespace) -> int:
    """Check or draw a robot."""
    return guarded(lambda: COMMANDS[arguments.action](arguments))


def _check(arguments: argparse.Namespace) -> int:
    image = _picture(arguments.image) if arguments.image else None
    srdf = _new_file(arguments.write_srdf, arguments.force) if arguments.write_srdf else None
    from harness.reporting.robot_report import page
    from harness.reporting.terminal import Style
    from harness.robot_tools.robot_check import check_robot
    from harness.robot_tools.robot_source import load_source
    from harness.robot_tools.srdf_proposal import proposed_srdf

    source = source_of(arguments)
    description = load_source(source)
    checked = check_robot(
        description,
        source.word,
        samples=arguments.samples or (SAMPLES_FOR_SRDF if srdf else SAMPLES),
        seed=arguments.seed,
        propose=source.has_no_srdf or srdf is not None,
    )
    extra_lines: list[str] = []
    if srdf is not None:
        _write(srdf, proposed_srdf(checked.touches, source.own_name or description.name))
        extra_lines.append(f"wrote {srdf}")
    elif source.has_no_srdf:
        extra_lines.append("no SRDF is given: --write-srdf FILE writes one with these pairs")
    if image is not None:
        extra_lines += _draw(description, arguments.state, image)
    code = 0 if checked.report.is_good else 1
    if arguments.json:
        with only_json_on_stdout() as write_json:
            write_json({"format": FORMAT, "exit_code": code, "robot": checked.report})
        return code
    say(*page(checked.report, Style.of(sys.stdout)), *extra_lines)
    return code


def _show(arguments: argparse.Namespace) -> int:
    from harness.robot_tools.robot_source import load_source

    name = Path(arguments.robot).name.split(".")[0] or "robot"
    image = _picture(arguments.image or f"{name}.png")
    for line in _draw(load_source(source_of(arguments)), arguments.state, image):
        say(line)
    return 0


COMMANDS = {"check": _check, "show": _show}


def _draw(description: RobotDescription, state: str, image: Path) -> list[str]:
    """Write a picture; returns the lines to print."""
    from harness.cameras.robot_picture import save_robot_picture
    from harness.robot_tools.robot_source import positions_of

    positions = positions_of(description, state)
    try:
        image.parent.mkdir(parents=True, exist_ok=True)
        note = save_robot_picture(description, positions, image)
    except OSError as error:
        raise UsageError(f"cannot write '{image}': {error.strerror}") from error
    return [f"wrote {image}", *([f"note: {note}"] if note else [])]


def _picture(name: str) -> Path:
    if Path(name).suffix.lower() not in PICTURES:
        raise UsageError(f"the name of a picture ends in {' or '.join(PICTURES)}, not '{name}'")
    return Path(name)


def _new_file(name: str, is_forced: bool) -> Path:
    path = Path(name)
    if path.exists() and not is_forced:
        raise UsageError(f"'{path}' is there already; --force overwrites it")
    return path


def _write(path: Path, text: str) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise UsageError(f"cannot write '{path}': {error.strerror}") from error
