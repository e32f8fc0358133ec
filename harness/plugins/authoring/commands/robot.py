"""`harness robot check|show`: check a robot, or draw it."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from harness.cli.arguments import output_file, whole_number
from harness.cli.command import EXCHANGE, Command
from harness.cli.files import refuse_existing, refusing_unwritable, write_text
from harness.cli.output import say, say_json
from harness.cli.robot_options import ROBOT, add_robot_options, source_of
from harness.cli.shared_options import add_json
from harness.cli.work_bar import WorkBar
from harness.suite.discovery import UsageError

if TYPE_CHECKING:
    from harness.robot.description import RobotDescription

PICTURES = (".png", ".jpg", ".jpeg")
SAMPLES, SAMPLES_FOR_SRDF = 2000, 10_000
FORMAT = "armharness-robot/1"


class RobotCommand(Command):
    """Check a robot, or draw it."""

    name: ClassVar[str] = "robot"
    group: ClassVar[str] = EXCHANGE
    reads_geometry: ClassVar[bool] = True

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness robot`."""
        actions = command.add_subparsers(dest="action", metavar="ACTION", required=True)
        check = actions.add_parser(
            "check",
            help="check limits, masses, kinematics, self-collisions and reach",
            description="Check a robot; the exit code is 1 when something is wrong.",
        )
        show = actions.add_parser("show", help="draw the robot", description="Draw a robot.")
        for action in (check, show):
            add = action.add_argument
            add("robot", metavar="ROBOT", help=f"{ROBOT}; or a scenario")
            add_robot_options(action)
            text = "draw the robot in this named state (default: the start)"
            add("--state", metavar="NAME", default="", help=text)
            text = "write the picture to this PNG or JPEG file"
            add("--image", metavar="FILE", type=output_file, default="", help=text)
        add = check.add_argument
        text = "check N random configurations (default: 2000; for an SRDF 10000)"
        add("--samples", metavar="N", type=whole_number, default=None, help=text)
        text = "draw the configurations with this seed (default: 0)"
        add("--seed", metavar="N", type=int, default=0, help=text)
        text = "write an SRDF that disables the pairs that need no collision check"
        add("--write-srdf", metavar="FILE", type=output_file, default="", help=text)
        add("--force", action="store_true", help="overwrite that file")
        add_json(check)

    def run(self, arguments: argparse.Namespace) -> int:
        """Check or draw a robot."""
        return _check(arguments) if arguments.action == "check" else _show(arguments)


def _check(arguments: argparse.Namespace) -> int:
    image = _picture(arguments.image) if arguments.image else None
    srdf = Path(arguments.write_srdf) if arguments.write_srdf else None
    if srdf is not None:
        refuse_existing(srdf, is_forced=arguments.force)
    from harness.plugins.authoring.robot_check import check_robot
    from harness.plugins.authoring.robot_report import page
    from harness.plugins.authoring.srdf_proposal import proposed_srdf
    from harness.reporting.terminal import Style
    from harness.robot.robot_source import load_source

    source = source_of(arguments)
    description = load_source(source)
    checked = check_robot(
        description,
        source.word,
        samples=arguments.samples or (SAMPLES_FOR_SRDF if srdf else SAMPLES),
        seed=arguments.seed,
        propose=source.has_no_srdf or srdf is not None,
        on_progress=WorkBar(),
    )
    extra_lines: list[str] = []
    if srdf is not None:
        write_text(srdf, proposed_srdf(checked.touches, source.own_name or description.name))
        extra_lines.append(f"wrote {srdf}")
    elif source.has_no_srdf:
        pairs = " with these pairs" if checked.report.proposal else ""
        extra_lines.append(f"no SRDF is given: --write-srdf FILE writes one{pairs}")
    if image is not None:
        extra_lines += _draw(description, arguments.state, image)
    code = 0 if checked.report.is_good else 1
    if arguments.json:
        say_json({"format": FORMAT, "exit_code": code, "robot": checked.report})
        return code
    say(*page(checked.report, Style.of(sys.stdout)), *extra_lines)
    return code


def _show(arguments: argparse.Namespace) -> int:
    from harness.robot.robot_source import load_source

    name = Path(arguments.robot).name.split(".")[0] or "robot"
    image = _picture(arguments.image or f"{name}.png")
    for line in _draw(load_source(source_of(arguments)), arguments.state, image):
        say(line)
    return 0


def _draw(description: RobotDescription, state: str, image: Path) -> list[str]:
    """Write a picture; returns the lines to print."""
    from harness.plugins.authoring.robot_picture import save_robot_picture
    from harness.robot.robot_source import positions_of

    positions = positions_of(description, state)
    with refusing_unwritable():
        image.parent.mkdir(parents=True, exist_ok=True)
        note = save_robot_picture(description, positions, image)
    return [f"wrote {image}", *([f"note: {note}"] if note else [])]


def _picture(name: str) -> Path:
    if Path(name).suffix.lower() not in PICTURES:
        raise UsageError(f"the name of a picture ends in {' or '.join(PICTURES)}, not '{name}'")
    return Path(name)
