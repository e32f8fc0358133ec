"""What a film's frames show: which samples, for how long, with which words."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from harness.recording.run import Run
from harness.recording.step_record import StepRecord
from harness.recording.stored_run import StoredRun
from harness.recording.verdict import Verdict
from harness.reporting.margins import allowance_used

HELD = 1.5  # [s] for which a moment that failed stands still, long enough to read it


@dataclass(frozen=True)
class Moment:
    """A moment that decided.

    Attributes:
        time: The simulated time [s].
        text: A sentence on what happened.
        is_good: Whether it did not fail.
    """

    time: float
    text: str
    is_good: bool


@dataclass(frozen=True)
class Frame:
    """One picture of a film.

    Attributes:
        sample: The recorded sample that is drawn.
        step: The step that runs; None between steps.
        moment: What is decided at that time; None where nothing is.
        repeats: The number of pictures for which it stands still.
    """

    sample: int
    step: StepRecord | None
    moment: Moment | None
    repeats: int = 1


def deciding_moment(stored: StoredRun) -> Moment:
    """The first failure; of a run that passed the verdict with the least room, else its end."""
    failures = _failures(stored)
    if failures:
        return failures[0]
    judged = [each for each in stored.verdicts if np.isfinite(each.time) and each.measures]
    if judged:
        nearest = max(judged, key=lambda each: allowance_used(each.measures[0]) or 0.0)
        return Moment(nearest.time, _sentence(nearest), is_good=True)
    return Moment(stored.run.duration, stored.outcome, is_good=stored.outcome == "passed")


def _failures(stored: StoredRun) -> list[Moment]:
    """Steps and expectations that failed, in the order in which a page lists them."""
    failed = [step for step in stored.run.steps if step.status == "failed"]
    steps = [
        Moment(each.end_time, f"{each.error_code} {each.message}".strip(), is_good=False)
        for each in failed
        if np.isfinite(each.end_time)
    ]
    verdicts = [
        Moment(each.time, _sentence(each), is_good=False)
        for each in stored.verdicts
        if each.status == "failed" and np.isfinite(each.time)
    ]
    return [*steps, *verdicts]


def _sentence(verdict: Verdict) -> str:
    return ": ".join(filter(None, (verdict.expectation, verdict.reason or verdict.status)))


def frames_of(stored: StoredRun, rate: float) -> Iterator[Frame]:
    """The frames of a film in real time, which stands still where something failed.

    Args:
        stored: The run with its verdicts.
        rate: Frames per second of simulated time.
    """
    run, times = stored.run, stored.run.signals.times
    due = sorted(_failures(stored), key=lambda moment: moment.time)
    count = int(np.floor(run.duration * rate + 1e-6)) + 1
    for number in range(count):
        is_last = number == count - 1
        while due and (due[0].time < (number + 0.5) / rate or is_last):
            moment = due.pop(0)
            sample = _sample_at(times, moment.time)
            repeats = max(1, round(HELD * rate))
            yield Frame(sample, _step_at(run, moment.time), moment, repeats)
        sample = _sample_at(times, number / rate)
        yield Frame(sample, _step_at(run, float(times[sample])), None)


def _sample_at(times: np.ndarray, time: float) -> int:
    return min(int(np.searchsorted(times, time - 1e-9)), len(times) - 1)


def _step_at(run: Run, time: float) -> StepRecord | None:
    """The innermost step that runs at a time, the later one where two meet."""
    running = [
        step
        for step in run.steps
        if step.status != "not reached" and step.start_time <= time <= step.end_time
    ]
    return max(running, key=lambda step: (step.start_time, len(step.path)), default=None)
