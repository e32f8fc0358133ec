"""When steps ran and objects were there, as a recording's events say."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from operator import itemgetter
from typing import Any, get_args

import numpy as np

from harness.core.types import BoolArray, FloatArray
from harness.plugins.grading.bag.clocks import Timeline
from harness.plugins.grading.bag.content import BagContent
from harness.recording.step_record import StepRecord, StepStatus

RESOLUTION = 1e-6  # tolerance of comparisons of times [s]; stamps are whole nanoseconds
STATUSES: Mapping[str, StepStatus] = {
    **{status: status for status in get_args(StepStatus)},
    "expected_error": "expected error",  # of bags that earlier versions wrote
}
Timed = tuple[float, dict[str, Any]]
StepInterval = tuple[float, float]


def timed_events(content: BagContent, timeline: Timeline, begin: float) -> list[Timed]:
    """Every event from a time on with its own time [s], in order."""
    logged = np.array([time for time, _ in content.events], dtype=np.int64)
    moments = timeline.at_logged(logged).tolist() if len(logged) else []
    timed = zip(moments, (event for _, event in content.events), strict=True)
    return sorted((each for each in timed if each[0] >= begin - RESOLUTION), key=itemgetter(0))


def steps_of(
    events: list[Timed], times: FloatArray, known: Mapping[str, tuple[int, str]]
) -> tuple[StepRecord, ...]:
    """Steps that began; without an end event, a step lasts until the next step or the run's end.

    Args:
        times: Times of the run's samples [s].
        known: Line and summary of the scenario's steps, by id and by path.
    """
    events = [(time, event) for time, event in events if "step" in event]
    steps: list[StepRecord] = []
    for number, (begin, event) in enumerate(events):
        if event.get("event") == "step_not_reached":
            steps.append(_step(event, known, (begin, begin), times, "not reached"))
        elif event.get("event") == "step_started":
            end, final = _end(event, events[number + 1 :], float(times[-1]))
            status = STATUSES.get(str(final.get("status")), "passed")
            steps.append(_step({**event, **final}, known, (begin, end), times, status))
    return tuple(steps)


def presence_of(events: list[Timed], name: str, times: FloatArray) -> tuple[StepInterval, ...]:
    """Intervals (from, to) [s] of an object in the scene; the whole run without events."""
    changes = [
        (time, event["event"] == "object_added")
        for time, event in events
        if event.get("event") in ("object_added", "object_removed")
        and str(event.get("object")) == name
    ]
    intervals: list[StepInterval] = []
    begin = None if changes and changes[0][1] else float(times[0])
    for time, is_added in changes:
        if is_added and begin is None:
            begin = time
        elif not is_added and begin is not None:
            intervals.append((begin, time))
            begin = None
    return (*intervals, *([] if begin is None else [(begin, float(times[-1]))]))


def is_present(intervals: Sequence[StepInterval], times: FloatArray) -> BoolArray:
    """Whether each sample is in one of the intervals, shape (N,)."""
    inside: BoolArray = np.zeros(len(times), dtype=bool)
    for begin, end in intervals:
        inside |= (times >= begin - RESOLUTION) & (times <= end + RESOLUTION)
    return inside


def _end(event: dict[str, Any], later: list[Timed], last: float) -> Timed:
    """Time at which a step ended, and its last event."""
    for time, other in later:
        if other.get("event") == "step_finished" and _path(other) == _path(event):
            return time, other
    begins = (time for time, other in later if other.get("event") == "step_started")
    return next(begins, last), {}


def _path(event: Mapping[str, Any]) -> str:
    return str(event.get("path", event["step"]))


def _step(
    event: Mapping[str, Any],
    known: Mapping[str, tuple[int, str]],
    span: tuple[float, float],
    times: FloatArray,
    status: StepStatus,
) -> StepRecord:
    name, path = str(event["step"]), _path(event)
    line, summary = known.get(name, known.get(path, (0, "")))
    begin, end = span
    # a step without duration is judged on the first sample after it
    start = min(int(np.searchsorted(times, begin - RESOLUTION)), len(times) - 1)
    return StepRecord(
        id=name,
        path=path,
        verb=str(event.get("verb", "")),
        summary=str(event.get("summary", summary)),
        line=line,
        status=status,
        start_time=begin,
        end_time=end,
        start_index=start,
        end_index=max(int(np.searchsorted(times, end + RESOLUTION)), start + 1),
        error_code=str(event.get("error_code", "")),
        message=str(event.get("message", "")),
    )
