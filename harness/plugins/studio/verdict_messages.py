"""Messages about steps and verdicts to a page, as plain data."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from harness.core.printable import printable
from harness.plugins.studio.session import Message
from harness.recording.step_record import StepRecord
from harness.recording.verdict import Verdict
from harness.reporting.result import StepLine


def verdicts_message(
    outcome: str = "",
    digest: str = "",
    steps: Iterable[StepRecord | StepLine] = (),
    verdicts: Iterable[tuple[Verdict, bool]] = (),
) -> Message:
    """The steps and the verdicts of a run.

    Args:
        outcome: The outcome of the run; empty while steps remain.
        digest: The digest of the run; empty where it has none.
        verdicts: Each verdict, and whether it is decided: others can still change.
    """
    return {
        "type": "verdicts",
        "outcome": outcome,
        "digest": digest,
        "steps": [
            {"summary": printable(step.summary), "status": step.status, "line": step.line}
            for step in steps
        ],
        "verdicts": [_verdict(verdict, is_decided) for verdict, is_decided in verdicts],
    }


NO_VERDICTS = verdicts_message()


def _verdict(verdict: Verdict, is_decided: bool) -> Message:
    margin = verdict.margin
    return {
        "text": printable(verdict.expectation),
        "status": verdict.status,
        "open": not is_decided,
        "margin": None if margin is None or not np.isfinite(margin) else margin,
        "unit": verdict.unit,
        "line": verdict.line,
        "reason": printable(verdict.reason),
    }
