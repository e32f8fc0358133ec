"""A joint trajectory controller: follows one trajectory at a time within tolerances."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.types import BoolArray, FloatArray
from harness.robot.description import Joint
from harness.ros.control.goals import Code, Tolerance, TrajectoryGoal, checked_goal
from harness.ros.control.spline import Rows, Spline

TIME_SLACK = 1e-9


@dataclass(frozen=True)
class Defaults:
    """Tolerances that goals have which name none [rad, m, s]."""

    path: float = np.inf
    goal: float = np.inf
    goal_time: float = 1.0


@dataclass(frozen=True)
class Finished:
    """How a trajectory ended.

    Attributes:
        goal: The goal's identifier; empty for one from a topic.
        code: The error code of its result.
        message: What happened, with numbers; empty for success.
    """

    goal: str
    code: Code
    message: str = ""


@dataclass(frozen=True, eq=False)
class Tracking:
    """Desired and actual motion at one moment, for feedback; shape (dof,) each."""

    goal: str
    time: float
    desired: FloatArray
    desired_velocities: FloatArray
    actual: FloatArray
    actual_velocities: FloatArray


@dataclass(eq=False)
class _Active:
    goal: str
    spline: Spline
    path: tuple[FloatArray, FloatArray]
    target: tuple[FloatArray, FloatArray]
    deadline: float


class TrajectoryController:
    """Follows trajectories of its joints; a new one replaces the one that is followed."""

    def __init__(self, name: str, joints: Sequence[Joint], defaults: Defaults) -> None:
        self.name, self.joints = name, tuple(joints)
        self.joint_names = tuple(joint.name for joint in joints)
        self._defaults = defaults
        self._active: _Active | None = None

    @property
    def is_active(self) -> bool:
        """Whether it follows a trajectory."""
        return self._active is not None

    @property
    def goal(self) -> str:
        """The identifier of the goal that it follows; empty for none, or one from a topic."""
        return self._active.goal if self._active else ""

    def begin(self, goal: str, content: Mapping[str, Any], now: float, start: Rows) -> None:
        """Follow a trajectory from now on.

        Args:
            goal: Its identifier; empty for one from a topic.
            content: The message, as `checked_goal` takes it.
            now: The present simulated time [s].
            start: The last set point, shape (1, dof) each.

        Raises:
            GoalRefused: It cannot be followed; what was followed goes on.
        """
        checked = checked_goal(content, self.joints, now)
        spline = _spline(checked, now, start)
        limit = checked.goal_time or self._defaults.goal_time
        self._active = _Active(
            goal,
            spline,
            self._bounds(checked.path, self._defaults.path),
            self._bounds(checked.goal, self._defaults.goal),
            np.inf if limit < 0 else spline.end + limit,
        )

    def stop(self) -> str:
        """Follow nothing any more; the identifier of the goal that was followed."""
        goal, self._active = self.goal, None
        return goal

    def set_points(self, times: FloatArray) -> Rows | None:
        """Set points at some times; None where it follows nothing."""
        return None if self._active is None else self._active.spline.at(times)

    def judge(
        self, times: FloatArray, desired: Rows, positions: FloatArray, velocities: FloatArray
    ) -> Finished | None:
        """Compare the motion with its tolerances.

        Args:
            times: Simulated times of the samples [s], shape (N,).
            desired: Set points at these times.
            positions: Measured positions, shape (N, dof).
            velocities: Measured velocities, shape (N, dof).

        Returns:
            How it ended; None while it goes on.
        """
        active = self._active
        if active is None:
            return None
        errors = np.abs(desired[0] - positions), np.abs(desired[1] - velocities)
        moving = times < active.spline.end - TIME_SLACK
        beyond = self._first_beyond(errors, active.path, moving)
        if beyond:
            row, text = beyond
            said = f"path tolerance: {text} at t={times[row]:.3f} s"
            return Finished(self.stop(), Code.PATH_TOLERANCE_VIOLATED, said)
        now = float(times[-1])
        if now < active.spline.end - TIME_SLACK:
            return None
        last = tuple(each[-1:] for each in errors)
        missed = self._first_beyond((last[0], last[1]), active.target, np.array([True]))
        if missed is None:
            return Finished(self.stop(), Code.SUCCESSFUL)
        if now < active.deadline:
            return None
        said = f"goal tolerance: {missed[1]} {now - active.spline.end:.3f} s after the end"
        return Finished(self.stop(), Code.GOAL_TOLERANCE_VIOLATED, said)

    def _bounds(
        self, own: Mapping[str, Tolerance], default: float
    ) -> tuple[FloatArray, FloatArray]:
        """Bounds of position and velocity errors; a goal's 0 is the default."""
        given = [own.get(name, Tolerance(np.nan, np.nan)) for name in self.joint_names]
        position = np.array([each.position for each in given])
        velocity = np.array([each.velocity for each in given])
        return (
            np.where(np.isnan(position), default, position),
            np.where(np.isnan(velocity), np.inf, velocity),
        )

    def _first_beyond(
        self,
        errors: tuple[FloatArray, FloatArray],
        bounds: tuple[FloatArray, FloatArray],
        rows: BoolArray,
    ) -> tuple[int, str] | None:
        """The first sample beyond a bound, and what is said of its worst joint."""
        beyond = ((errors[0] > bounds[0]) | (errors[1] > bounds[1])) & rows[:, None]
        if not beyond.any():
            return None
        row = int(np.flatnonzero(beyond.any(axis=1))[0])
        for which, noun in enumerate(("", "/s")):
            excess = errors[which][row] - bounds[which]
            if (excess > 0).any():
                column = int(np.argmax(excess))
                joint = self.joints[column]
                unit = ("m" if joint.kind == "prismatic" else "rad") + noun
                return row, (
                    f"'{joint.name}' is off by {errors[which][row, column]:.4g} {unit}"
                    f" (tolerance {bounds[which][column]:.4g} {unit})"
                )
        raise AssertionError


def _spline(goal: TrajectoryGoal, now: float, start: Rows) -> Spline:
    """The spline from the last set point through the points that are not over yet."""
    times = goal.times + (goal.stamp or now)
    left = times > now + TIME_SLACK
    left[-1] = True
    if not goal.stamp and goal.times[0] == 0:
        left[0] = True  # a point at time 0 is where the trajectory starts
    parts = [each if each is None else each[left]
             for each in (goal.positions, goal.velocities, goal.accelerations)]  # fmt: skip
    times = times[left]
    if times[0] > now + TIME_SLACK:
        times = np.concatenate([[now], times])
        parts = [None if part is None else np.vstack([at, part])
                 for part, at in zip(parts, start, strict=True)]  # fmt: skip
    positions = parts[0]
    assert positions is not None
    return Spline(times, positions, parts[1], parts[2])
