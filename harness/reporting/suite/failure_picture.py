"""The picture of a report that shows a failure best."""

from __future__ import annotations

from pathlib import Path

from harness.reporting.suite.record import SuiteCase
from harness.reporting.terminal import root_failures


def picture_of(case: SuiteCase) -> str:
    """The path of the picture of the step that failed, else of the last one; empty without one.

    Pictures are named after the steps that they show: `03-pick-lift.jpg`.
    """
    if not case.result.report_dir or case.result.outcome == "passed":
        return ""
    pictures = sorted(Path(case.result.report_dir, "images").glob("*.jpg"))
    failed = [step.id for step in root_failures(case.result.steps)]
    failed += [each.step for each in case.result.verdicts if each.status != "passed" and each.step]
    for step in filter(None, failed):
        found = [each for each in pictures if each.stem.partition("-")[2].startswith(step)]
        if found:
            return str(found[-1])
    return str(pictures[-1]) if pictures else ""
