"""`harness ik-test`: property-based tests of a function that solves inverse kinematics."""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path
from typing import ClassVar

from harness.cli.arguments import positive_number, seconds, whole_number
from harness.cli.command import SEARCHES, Command
from harness.cli.output import say, say_json
from harness.cli.robot_options import ROBOT, add_robot_options, source_of
from harness.cli.shared_options import add_json, add_plugin, add_report_dir
from harness.cli.work_bar import WorkBar
from harness.suite.outcome import EXIT_CODES


class IkTestCommand(Command):
    """Test a function that solves inverse kinematics."""

    name: ClassVar[str] = "ik-test"
    group: ClassVar[str] = SEARCHES

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness ik-test`."""
        add = command.add_argument
        text = (
            "module:function, file.py:function, a name of `harness list ik-solvers`, or `own` for"
            " the robot's own solver"
        )
        add("solver", metavar="SOLVER", help=text)
        add_plugin(command)
        add("--robot", metavar="ROBOT", required=True, help=ROBOT)
        add_robot_options(command)
        text = "place this link at the targets (default: the TCP)"
        add("--link", metavar="LINK", default="", help=text)
        text = "test that the function returns every solution for a target"
        add("--branches", action="store_true", help=text)
        text = "try N cases of each property (default: 100)"
        add("--examples", metavar="N", type=whole_number, default=100, help=text)
        text = "draw the cases with this seed (default: 0)"
        add("--seed", metavar="N", type=int, default=0, help=text)
        length, angle = positive_number("metres"), positive_number("radians")
        text = "accept answers within this distance of the target [m] (default: 0.0001)"
        add("--position-tolerance", metavar="M", type=length, default=1e-4, help=text)
        text = "accept answers within this angle of the target [rad] (default: 0.001)"
        add("--orientation-tolerance", metavar="RAD", type=angle, default=1e-3, help=text)
        text = "count a call as hanging after this processor time (default: 5)"
        add("--call-limit", metavar="SECONDS", type=seconds, default=5.0, help=text)
        add_report_dir(command)
        add("--no-report", action="store_true", help="write no report and no pictures")
        add_json(command)

    def run(self, arguments: argparse.Namespace) -> int:
        """Test the function; 1 when anything is found."""
        sys.path.insert(0, str(Path.cwd()))  # a module is found in the folder where one works
        from harness.plugins.iktest.kit import IkTest, run_ik_test
        from harness.plugins.iktest.text import report_lines

        folder = None
        if not arguments.no_report:
            folder = Path(arguments.report_dir) / "ik_test" / _folder_name(arguments.solver)
        test = IkTest(
            solver=arguments.solver,
            robot=source_of(arguments),
            link=arguments.link,
            branches=arguments.branches,
            examples=arguments.examples,
            seed=arguments.seed,
            position_tolerance=arguments.position_tolerance,
            orientation_tolerance=arguments.orientation_tolerance,
            patience=arguments.call_limit,
            report_dir=folder,
            on_case=WorkBar(),
        )
        report = run_ik_test(test)
        if arguments.json:
            say_json(report.facts())
        else:
            for line in report_lines(report, folder or Path()):
                say(line)
            if folder is not None:
                say(f"report: {folder}")
        return EXIT_CODES["passed" if report.has_passed else "failed"]


def _folder_name(solver: str) -> str:
    """`scenarios/ik_test/student_ik.py:ik` is `student_ik.ik`."""
    place, _, function = solver.rpartition(":")
    stem = Path(place).stem if place.endswith(".py") else place
    return re.sub(r"[^\w.-]", "_", f"{stem}.{function}" if stem else function)
