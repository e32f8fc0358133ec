"""`harness ik-test`: property-based tests of a function that solves inverse kinematics."""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

from harness.cli.output import guarded, only_json_on_stdout, say
from harness.cli.robot_options import source_of
from harness.suite.outcome import EXIT_CODES


def run(arguments: argparse.Namespace) -> int:
    """Test the function; 1 when anything is found."""
    return guarded(lambda: _run(arguments))


def _run(arguments: argparse.Namespace) -> int:
    sys.path.insert(0, str(Path.cwd()))  # a module is found in the folder where one works
    from harness.iktest.kit import IkTest, run_ik_test
    from harness.iktest.text import report_lines

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
    )
    if arguments.json:
        with only_json_on_stdout() as write_json:
            report = run_ik_test(test)
            write_json(report.facts())
    else:
        report = run_ik_test(test)
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
