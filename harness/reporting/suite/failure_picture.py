"""The picture of the moment that decided a case."""

from __future__ import annotations

import math
from pathlib import Path

from harness.recording.step_record import is_nested
from harness.reporting.result import CaseResult, StepLine
from harness.reporting.suite.record import SuiteCase


def picture_of(case: SuiteCase) -> str:
    """The path of the picture of what failed; empty without one, or where the case passed."""
    still = None if case.result.outcome == "passed" else deciding_still(case.result)
    return str(still or "")


def deciding_still(result: CaseResult) -> Path | None:
    """The picture of the step within which a case failed, else of the last one.

    Pictures are numbered as the steps that were carried out: `03-pick-lift.jpg`. The one that
    explains a failure comes first: `03-pick-lift-why.jpg`.
    """
    if not result.report_dir:
        return None
    number = _deciding_step(result)
    files = sorted(Path(result.report_dir, "images").glob(f"{number:02d}-*.jpg"))
    return min(files, key=lambda file: not file.stem.endswith("-why"), default=None)


def deciding_picture(result: CaseResult, width: int) -> bytes | None:
    """The same picture as WebP of a width [pixels]."""
    still = deciding_still(result)
    if still is None:
        return None
    from harness.reporting.html.still import small_still  # loads Pillow

    return small_still(still.parents[1], f"{still.parent.name}/{still.name}", width)


def _deciding_step(result: CaseResult) -> int:
    """The number of the step, from 1, at whose end or within which a case failed."""
    for number, step in _innermost(result):
        if step.status == "failed":
            return number
    verdict = next((each for each in result.verdicts if each.status != "passed"), None)
    return step_at(result, math.nan if verdict is None else verdict.time)


def step_at(result: CaseResult, time: float) -> int:
    """The number, from 1, of the step that was carried out at a time [s]; NaN: of the last one."""
    found, end = 1, 0.0
    for number, step in _innermost(result):
        found, end = number, end + step.sim_time
        if end >= time - 1e-9:
            break
    return found


def _innermost(result: CaseResult) -> list[tuple[int, StepLine]]:
    """Numbers of the steps that were carried out, without those that others are nested in."""
    steps = [step for step in result.steps if step.status != "not reached"]
    return [
        (number, step)
        for number, step in enumerate(steps, start=1)
        if not any(is_nested(other.path, step.path) for other in steps)
    ]
