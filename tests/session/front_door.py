"""Runs and checks scenario texts as a user would, each in its own folder."""

import textwrap

from harness.recording.read_run import read_run
from harness.session.check import check_file
from tests.approved import SAID, problem_text
from tests.running import run_case

UR = "{model: ur3e, gripper: rh_p12_rn_a, base: {xyz: [0, 0, 1.02]}}"
TABLE_TOP = 1.015


def file_of(folder, steps, *, robot=UR, world="empty", rest=""):
    """A scenario file with some steps, written as a list of YAML."""
    text = f"scenario: a test\nrobot: {robot}\nworld: {world}\nsteps:\n"
    text += textwrap.indent(textwrap.dedent(steps).strip("\n"), "  ")
    path = folder / "test.scenario.yaml"
    path.write_text(f"{text}\n{textwrap.dedent(rest)}", encoding="utf-8")
    return path


def run(folder, steps, **words):
    """The case's result, and the run as it was saved."""
    path = file_of(folder, steps, **words)
    result = run_case(path, report_dir=folder / "report", stills=False, page=False)
    assert result.outcome in ("passed", "failed"), (result.problems, result.message)
    return result, read_run(folder / "report").run


def check(folder, steps, **words):
    """What a check finds."""
    report = check_file(file_of(folder, steps, **words))
    SAID.extend(problem_text(each).replace(str(folder), "FOLDER") for each in report.problems)
    return report


def problems(folder, steps, **words):
    """Line and message of each problem of a file."""
    return [(problem.line, problem.message) for problem in check(folder, steps, **words).problems]


def failures(result):
    """Expectations that do not hold, as status and text."""
    return [
        f"{verdict.status}: {verdict.expectation}: {verdict.reason}"
        for verdict in result.verdicts
        if verdict.status != "passed"
    ]
