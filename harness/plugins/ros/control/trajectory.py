"""Splines through the points of a trajectory, followed within tolerances as in ros2_control."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import factorial, perm
from typing import Any

import numpy as np
from scipy.interpolate import PPoly

from harness.core.types import FloatArray
from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.control.controller import Outcome, Rows, Window
from harness.plugins.ros.control.goals import Code, TrajectoryGoal, checked_goal
from harness.plugins.ros.interfaces import FOLLOW, POINT, header
from harness.recording.commands import CommandRecord
from harness.robot.description import TrackingTolerances
from harness.robot.mechanism import Joint

TIME_SLACK = 1e-9


class Spline:
    """Segments between knots: linear, cubic or quintic, by what the points give.

    Attributes:
        end: The time of the last knot [s].
    """

    def __init__(self, times: FloatArray, *motion: FloatArray) -> None:
        """Fit the segments.

        Args:
            times: Strictly rising [s], shape (K,).
            motion: The positions at the knots and, where given, the velocities and accelerations,
                shape (K, dof) each.
        """
        self.begin, self.end, self._target = float(times[0]), float(times[-1]), motion[0][-1]
        if len(times) == 1:  # a motion of no length, ahead of which and after which it rests
            times, motion = np.array([times[0], times[0] + 1.0]), (motion[0][[0, 0]],)
        self._polynomial = _hermite(times, motion)

    def at(self, times: FloatArray) -> Rows:
        """The motion at some times [s], shape (N,); at rest before the first knot and after."""
        inside, over = np.maximum(times, self.begin), times >= self.end
        rows = np.array([self._polynomial(inside, nu=order) for order in range(3)])
        rows[0, over] = self._target
        rows[1:, over | (times < self.begin)] = 0.0
        return rows


def _hermite(times: FloatArray, motion: Sequence[FloatArray]) -> PPoly:
    """Polynomials with the given derivatives, of order 0, 1, ... , at both ends of each segment.

    In the share s of its segment, a polynomial has factors of s^i: those for i < len(motion) follow
    from its begin, and the others from what they have to add to these until its end.
    """
    known, span = range(len(motion)), np.diff(times)[:, None]
    low = [motion[i][:-1] * span**i / factorial(i) for i in known]
    lack = [
        motion[order][1:] * span**order - sum(perm(i, order) * low[i] for i in known)
        for order in known
    ]
    added = [[perm(i + len(motion), order) for i in known] for order in known]
    high = np.tensordot(np.linalg.inv(added), lack, axes=1)
    factors = [factor / span**i for i, factor in enumerate([*low, *high])]
    return PPoly(np.array(factors[::-1]), times)


def start_trajectory(
    joints: Sequence[Joint], defaults: TrackingTolerances, command: CommandRecord, start: Rows
) -> TrajectoryMotion:
    """The motion of a trajectory from the last set point on, shape (3, 1, dof).

    Raises:
        GoalRefused: It cannot be followed.
    """
    goal = checked_goal(command, joints, defaults)
    return TrajectoryMotion(command.goal, joints, goal, _spline(goal, command.time, start))


def follow_result(code: Code, reason: str) -> object:
    """The result message of FollowJointTrajectory."""
    return message(f"{FOLLOW}_Result", error_code=int(code), error_string=reason)


@dataclass(eq=False)
class TrajectoryMotion:
    """A trajectory that is followed within the tolerances of its goal."""

    goal: str
    joints: Sequence[Joint]
    checked: TrajectoryGoal
    spline: Spline
    effort: float = 0.0

    def at(self, times: FloatArray) -> Rows:
        return self.spline.at(times)

    def judge(self, window: Window) -> Outcome | None:
        """Compare the motion with its tolerances."""
        errors = np.abs(window.desired[:2] - window.measured)
        times, last = window.times, window.measured[0, -1]
        now, end = float(times[-1]), self.spline.end
        moving = times < end - TIME_SLACK
        beyond = self._first_beyond(errors[:, moving], self.checked.path)
        if beyond:
            row, text = beyond
            reason = f"path tolerance: {text} at t={times[row]:.3f} s"
            return self._ended(Code.PATH_TOLERANCE_VIOLATED, reason, last)
        if now < end - TIME_SLACK:
            return None
        missed = self._first_beyond(errors[:, -1:], self.checked.goal)
        if missed is None:
            return self._ended(Code.SUCCESSFUL)
        if now < end + self.checked.goal_time:
            return None
        reason = f"goal tolerance: {missed[1]} {now - end:.3f} s after the end"
        return self._ended(Code.GOAL_TOLERANCE_VIOLATED, reason, last)

    def feedback(self, window: Window) -> Any:
        def point(motion: FloatArray) -> Any:
            positions, velocities = np.ascontiguousarray(motion)
            return message(POINT, positions=positions, velocities=velocities)

        desired, actual = window.desired[:2, -1], window.measured[:, -1]
        return message(
            f"{FOLLOW}_Feedback",
            header=header(float(window.times[-1])),
            joint_names=[joint.name for joint in self.joints],
            desired=point(desired),
            actual=point(actual),
            error=point(desired - actual),
        )

    def interrupted(self, code: Code, reason: str, window: Window) -> Outcome:
        del window
        return self._ended(code, reason)

    def _ended(self, code: Code, reason: str = "", hold: FloatArray | None = None) -> Outcome:
        return Outcome(self.goal, code == Code.SUCCESSFUL, follow_result(code, reason), hold)

    def _first_beyond(self, errors: FloatArray, bounds: FloatArray) -> tuple[int, str] | None:
        """The first sample with an error beyond a bound, and a text about its worst joint."""
        excess = errors - bounds[:, None]
        beyond = (excess > 0).any(axis=(0, 2))
        if not beyond.any():
            return None
        row = int(np.argmax(beyond))
        which = 0 if (excess[0, row] > 0).any() else 1
        column = int(np.argmax(excess[which, row]))
        joint = self.joints[column]
        unit = joint.position_unit + ("", "/s")[which]
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
    times, motion = times[left], [part[left] for part in goal.motion]
    if times[0] > now + TIME_SLACK:
        times = np.concatenate([[now], times])
        motion = [np.vstack([at, part]) for part, at in zip(motion, start, strict=False)]
    return Spline(times, *motion)
