"""The part of a run that an expectation is judged over, and the answers that are no verdict."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from harness.core.types import BoolArray, FloatArray, IntArray
from harness.recording.run import ObjectRecord, Run
from harness.recording.step_record import StepRecord, is_nested
from harness.recording.step_results import SceneChange

D = TypeVar("D", bound=np.dtype[Any])


class NotReached(Exception):
    """There was nothing to judge; the message says why."""


class NotObservable(Exception):
    """The record lacks what the expectation is about; the message says what."""


@dataclass(frozen=True, eq=False)
class Window:
    """Samples [start, stop) of a run.

    Attributes:
        step: The step it belongs to; None for the whole run.
    """

    run: Run
    start: int
    stop: int
    step: StepRecord | None = None

    @property
    def times(self) -> FloatArray:
        """Times of the window's samples [s], shape (n,)."""
        return self.run.signals.times[self.start : self.stop]

    @property
    def tcp_position(self) -> FloatArray:
        """Positions of the TCP in the world [m], shape (n, 3)."""
        robot, signals = self.run.robot, self.run.signals
        is_recorded = robot.tcp_link == robot.recorded_tcp
        poses = signals.tcp_pose if is_recorded else signals.frames[robot.tcp_link]
        return self.cut(poses)[:, :3]

    def cut(self, values: np.ndarray[Any, D]) -> np.ndarray[Any, D]:
        """The window's part of an array over the run's samples."""
        return values[self.start : self.stop]

    def time(self, index: int) -> float:
        """Time of a sample of the window [s]."""
        return float(self.run.signals.times[self.start + index])

    @property
    def cut_short(self) -> str:
        """Why the window ends before its time: a step failed unexpectedly. Empty where it does not.

        A step that timed out has had all of its time, and so has one that was expected to fail.
        """
        if self.step is None and not self.run.ended_early:
            return ""
        failed = [step for step in self.run.steps if step.status == "failed" and step.error_code]
        if self.step is None:
            if not failed:
                return f"the run ended before then: {self.run.ended_early}"
        elif self.step not in failed or self.step.error_code == "TIMED_OUT":
            return ""
        root = failed[-1]  # steps nested in others are recorded after them
        return f"step '{root.title}' failed before then: {root.error_code}"


def lasting(mask: BoolArray) -> BoolArray:
    """A mask over a window without a first sample that is true alone, shape (n,).

    A window begins with the last sample of the step before: what that step removed is still there.
    """
    is_alone = len(mask) > 1 and mask[0] and not mask[1]
    return mask & (np.arange(len(mask)) > 0) if is_alone else mask


def window_of(run: Run, step_id: str) -> Window:
    """The samples of a step (by id, or by path), or of the whole run for an empty id.

    Raises:
        NotReached: There is no such step, it was not reached, or nothing was recorded in it.
        NotObservable: The recording does not say when steps ran.
    """
    if not step_id:
        window = Window(run, 0, len(run.signals.times))
    else:
        step = next((step for step in run.steps if step_id in (step.id, step.path)), None)
        if step is None and "steps" in run.unrecorded:
            raise NotObservable(f"when step '{step_id}' ran was not recorded")
        if step is None:
            raise NotReached(f"there is no step '{step_id}' in this run")
        if step.status == "not reached":
            raise NotReached(f"the run ended before step '{step.title}'")
        window = Window(run, *_samples(run, step), step)
    if window.stop <= window.start:
        raise NotReached("nothing was recorded in the time it is judged over")
    return window


def _samples(run: Run, step: StepRecord) -> tuple[int, int]:
    """The samples [start, stop) that show a step.

    The physics shows one sample later what a step did that puts, adds or removes objects. That
    sample belongs to the step and to those that it is part of, and later steps begin with it.
    """
    start, stop = step.start_index, step.end_index
    place = run.steps.index(step)
    for index, other in enumerate(run.steps):
        if other.result.find(SceneChange) is None:
            continue
        if index <= place and other.end_index == step.start_index + 1:
            start, stop = other.end_index, max(stop, other.end_index + 1)
        if index == place or is_nested(other.path, step.path):
            stop = max(stop, other.end_index + 1)
    return start, min(stop, len(run.signals.times))


def refuse_changed_later(run: Run, step_id: str, names: Collection[str]) -> None:
    """Refuse to judge a step by objects that later steps changed before a sample was recorded.

    Steps that take no time follow each other at one moment. The sample after it shows what all of
    them did, and belongs to each.

    Args:
        step_id: The id or the path of the step; empty for the whole run.
        names: The names of the objects that the expectation is about.

    Raises:
        NotObservable: The expectation names such an object.
    """
    steps = [step for step in run.steps if step_id and step_id in (step.id, step.path)]
    if not steps or steps[0].status == "not reached":
        return
    step = steps[0]
    start, stop = _samples(run, step)
    for other in run.steps[run.steps.index(step) + 1 :]:
        change = other.result.find(SceneChange)
        if change is None or is_nested(other.path, step.path):
            continue
        if not start <= other.end_index < stop:
            continue
        for name in change.names:
            if name in names:
                raise NotObservable(
                    f"step '{other.title}' changed '{name}' at the same moment, before a sample"
                    f" showed what '{step.title}' did: put `wait: 10 ms` between them"
                )


def object_record(run: Run, name: str) -> ObjectRecord:
    """The record of an object.

    Raises:
        NotObservable: The run knows no such object.
    """
    for record in run.objects:
        if record.name == name:
            return record
    raise NotObservable(f"there is no object '{name}' in this run")


def put_samples(run: Run, name: str) -> IntArray:
    """Samples at which a step has put an object somewhere else, ascending; none of a link.

    Nothing moved from the pose before to this one: between the two there is no speed and no
    distance.
    """
    records = [record for record in run.objects if record.name == name]
    return records[0].put_samples(run.signals.times) if records else np.zeros(0, dtype=np.int64)


def refuse_unrecorded_steps(run: Run) -> None:
    """Refuse a run whose steps are unknown, so that it is not taken for one without results.

    Raises:
        NotObservable: The steps, or their results, were not recorded.
    """
    if {"steps", "step_results"} & set(run.unrecorded):
        raise NotObservable("what the steps reported was not recorded")
