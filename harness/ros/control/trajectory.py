"""A joint trajectory controller: follows one trajectory at a time within tolerances."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.types import FloatArray
from harness.robot.description import Joint
from harness.ros.control.controller import Controller, Outcome, Window
from harness.ros.control.goals import Code, Defaults, TrajectoryGoal, checked_goal
from harness.ros.control.spline import Rows, Spline

TIME_SLACK = 1e-9


@dataclass(frozen=True, eq=False)
class Finished(Outcome):
    """How a trajectory ended.

    Attributes:
        code: The error code of its result.
        message: What happened, with numbers; empty for success.
    """

    code: Code = Code.SUCCESSFUL
    message: str = ""


@dataclass(frozen=True, eq=False)
class Tracking:
    """Desired and actual motion at one moment, for feedback.

    Attributes:
        goal: The identifier of the goal.
        time: The simulated time [s].
        desired: The desired positions and velocities, shape (2, dof).
        actual: The measured ones, shape (2, dof).
    """

    goal: str
    time: float
    desired: FloatArray
    actual: FloatArray


@dataclass(eq=False)
class _Active:
    goal: str
    spline: Spline
    path: FloatArray
    target: FloatArray
    deadline: float


class TrajectoryController(Controller[_Active]):
    """Follows trajectories of its joints within tolerances."""

    def __init__(self, name: str, joints: Sequence[Joint], defaults: Defaults) -> None:
        super().__init__(name, joints)
        self._defaults = defaults

    def begin(
        self, goal: str, content: Mapping[str, Any], now: float, start: Rows, measured: FloatArray
    ) -> None:
        del measured  # it starts from the last set point
        checked = checked_goal(content, self.joints, now, self._defaults)
        spline = _spline(checked, now, start)
        deadline = spline.end + checked.goal_time
        self._active = _Active(goal, spline, checked.path, checked.goal, deadline)

    def set_points(self, times: FloatArray) -> Rows | None:
        return None if self._active is None else self._active.spline.at(times)

    def judge(self, window: Window) -> Finished | None:
        """Compare the motion with its tolerances."""
        active, times = self._active, window.times
        if active is None:
            return None
        errors = np.abs(window.desired[:2] - window.measured)
        last, now, end = window.measured[0, -1], float(times[-1]), active.spline.end
        moving = times < end - TIME_SLACK
        beyond = self._first_beyond(errors[:, moving], active.path)
        if beyond:
            row, text = beyond
            said = f"path tolerance: {text} at t={times[row]:.3f} s"
            return Finished(self.stop(), last, Code.PATH_TOLERANCE_VIOLATED, said)
        if now < end - TIME_SLACK:
            return None
        missed = self._first_beyond(errors[:, -1:], active.target)
        if missed is None:
            return Finished(self.stop())
        if now < active.deadline:
            return None
        said = f"goal tolerance: {missed[1]} {now - end:.3f} s after the end"
        return Finished(self.stop(), last, Code.GOAL_TOLERANCE_VIOLATED, said)

    def interrupted(self, goal: str, code: Code, reason: str, window: Window) -> Finished:
        del window
        return Finished(goal, None, code, reason)

    def _first_beyond(self, errors: FloatArray, bounds: FloatArray) -> tuple[int, str] | None:
        """The first sample with an error beyond a bound, and what is said of its worst joint."""
        excess = errors - bounds[:, None]
        beyond = (excess > 0).any(axis=(0, 2))
        if not beyond.any():
            return None
        row = int(np.argmax(beyond))
        which = 0 if (excess[0, row] > 0).any() else 1
        column = int(np.argmax(excess[which, row]))
        joint = self.joints[column]
        unit = ("m" if joint.kind == "prismatic" else "rad") + ("", "/s")[which]
        return row, (
            f"'{joint.name}' is off by {errors[which, row, column]:.4g} {unit}"
            f" (tolerance {bounds[which, column]:.4g} {unit})"
        )


def _spline(goal: TrajectoryGoal, now: float, start: Rows) -> Spline:
    """The spline from the last set point through the points that are not over yet."""
    times = goal.times + (goal.stamp or now)
    left = times > now + TIME_SLACK
    left[-1] = True
    if not goal.stamp and goal.times[0] == 0:
        left[0] = True  # a point at time 0 is where the trajectory starts
    times = times[left]
    parts = [None if part is None else part[left] for part in goal.motion]
    if times[0] > now + TIME_SLACK:
        times = np.concatenate([[now], times])
        parts = [None if part is None else np.vstack([at, part])
                 for part, at in zip(parts, start, strict=True)]  # fmt: skip
    positions, velocities, accelerations = parts
    assert positions is not None
    return Spline(times, positions, velocities, accelerations)
