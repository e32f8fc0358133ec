"""Goals of FollowJointTrajectory: what a message must hold before the arm moves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from itertools import takewhile
from typing import Any

import numpy as np

from harness.core.types import FloatArray
from harness.recording.commands import CommandRecord
from harness.robot.description import TrackingTolerances
from harness.robot.mechanism import Joint

LIMIT_SLACK = 1e-4  # excess of a position limit that is rounding of a decimal number [rad or m]
LARGEST = 1e6  # position, velocity or acceleration that is no motion of an arm
LONGEST_NAME, MOST_NAMES = 40, 8  # characters of a name in a message, and names in a list
OTHER_CLOCK = 1e6  # [s]; stamps that differ by more are those of another clock


MOTION = ("positions", "velocities", "accelerations")
"""What points have; accelerations count where there are velocities too."""


class Code(IntEnum):
    """Error codes of FollowJointTrajectory's result."""

    SUCCESSFUL = 0
    INVALID_GOAL = -1
    INVALID_JOINTS = -2
    OLD_HEADER_TIMESTAMP = -3
    PATH_TOLERANCE_VIOLATED = -4
    GOAL_TOLERANCE_VIOLATED = -5


class GoalRefused(Exception):
    """A goal that cannot be followed, and the error code of its result."""

    def __init__(self, message: str, code: Code = Code.INVALID_GOAL) -> None:
        self.code = code
        super().__init__(message)


@dataclass(frozen=True, eq=False)
class TrajectoryGoal:
    """A trajectory in the order of the controller's joints, checked.

    Attributes:
        times: Time from start of each point [s], shape (N,).
        motion: The positions and, where the points have them, the velocities and accelerations,
            shape (N, dof) each.
        stamp: Simulated time at which it starts [s]; 0 for at once.
        path: Largest errors of position and velocity on the way, shape (2, dof).
        goal: Largest errors at the end, shape (2, dof).
        goal_time: Time after the end in which the goal must be reached [s].
    """

    times: FloatArray
    motion: Sequence[FloatArray]
    stamp: float
    path: FloatArray
    goal: FloatArray
    goal_time: float


def checked_goal(
    command: CommandRecord, joints: Sequence[Joint], defaults: TrackingTolerances
) -> TrajectoryGoal:
    """The goal that a command holds for a controller of these joints.

    Args:
        command: Its content has `joint_names`, `points` (lists of time, positions, velocities,
            accelerations), `stamp`, and the tolerances of an action.
        defaults: Tolerances where the goal has none of its own.

    Raises:
        GoalRefused: With the error code that the message's own result has for it.
    """
    content, now = command.content, command.time
    order = _order(content["joint_names"], [joint.name for joint in joints])
    points = content["points"]
    if not points:
        raise GoalRefused("the trajectory has no points")
    times = np.array([point["time"] for point in points], dtype=float)
    _check_times(times)
    columns = (_column(points, key, order) for key in MOTION)
    motion = [*takewhile(lambda column: column.size, columns)]
    if not motion:
        raise GoalRefused("the points have no positions")
    _check_limits(motion[0], joints)
    if len(motion) > 1 and np.abs(motion[1][-1]).max() > 1e-6:
        raise GoalRefused("the last point has a velocity; a trajectory must end at rest")
    stamp = float(content.get("stamp", 0.0))
    if abs(stamp - now) > OTHER_CLOCK:
        stamp = 0.0
    if stamp and stamp + times[-1] < now:
        raise GoalRefused(
            f"the trajectory ends at t={stamp + times[-1]:.3f} s, and it is t={now:.3f} s",
            Code.OLD_HEADER_TIMESTAMP,
        )
    path = _bounds(content.get("path_tolerance", ()), joints, defaults.trajectory)
    goal = _bounds(content.get("goal_tolerance", ()), joints, defaults.goal)
    limit = float(content.get("goal_time", 0.0)) or defaults.goal_time
    return TrajectoryGoal(times, motion, stamp, path, goal, np.inf if limit < 0 else limit)


def _order(given: Sequence[str], names: Sequence[str]) -> list[int]:
    """Columns of the message for the controller's joints."""
    unknown = [_quoted(name) for name in given if name not in names]
    if unknown:
        reason = f"this controller has no joint {', '.join(unknown[:MOST_NAMES])}; it has"
        raise GoalRefused(f"{reason} {', '.join(names)}", Code.INVALID_JOINTS)
    if sorted(given) != sorted(names):
        reason = (
            f"the trajectory names {', '.join(given[:MOST_NAMES]) or 'no joints'}; it must name"
        )
        raise GoalRefused(f"{reason} each of {', '.join(names)} once", Code.INVALID_JOINTS)
    return [list(given).index(name) for name in names]


def _quoted(name: str) -> str:
    return repr(name if len(name) <= LONGEST_NAME else f"{name[:LONGEST_NAME]}...")


def _check_times(times: FloatArray) -> None:
    falls = ~(np.diff(times, prepend=-1e-9) > 0)
    if falls.any():
        place = int(np.argmax(falls))
        before = f", after {times[place - 1]:.6g} s" if place else ""
        reason = f"point {place} is at {times[place]:.6g} s{before}"
        raise GoalRefused(f"time_from_start must rise from 0 on; {reason}")


def _column(points: Sequence[Mapping[str, Any]], key: str, order: list[int]) -> FloatArray:
    """Positions, velocities or accelerations of all points; empty where the points have none."""
    lengths = [len(point[key]) for point in points]
    if not any(lengths):
        return np.empty(0)
    for place, length in enumerate(lengths):
        if length != len(order):
            reason = f"point {place} has {length} {key}, and there are {len(order)} joints"
            raise GoalRefused(reason)
    values = np.array([point[key] for point in points], dtype=float)[:, order]
    is_bad = ~(np.abs(values) < LARGEST).all(axis=1)  # which is also true of NaN
    if is_bad.any():
        reason = f"point {np.argmax(is_bad)} has {key} that are not numbers below {LARGEST:g}"
        raise GoalRefused(reason)
    return values


def _check_limits(positions: FloatArray, joints: Sequence[Joint]) -> None:
    lower, upper = np.array([(joint.lower, joint.upper) for joint in joints]).T
    excess = np.maximum(lower - positions, positions - upper)
    if (excess > LIMIT_SLACK).any():
        row, column = map(int, np.argwhere(excess > LIMIT_SLACK)[0])
        joint = joints[column]
        raise GoalRefused(
            f"point {row} puts '{joint.name}' to {positions[row, column]:.6g}; it goes from"
            f" {joint.lower:.6g} to {joint.upper:.6g}"
        )


def _bounds(
    given: Sequence[Mapping[str, Any]], joints: Sequence[Joint], default: float
) -> FloatArray:
    """Bounds of errors, shape (2, dof), where 0 is the default and a negative number is none."""
    bounds = np.array([[default] * len(joints), [np.inf] * len(joints)])
    places = {joint.name: place for place, joint in enumerate(joints)}
    for each in given:
        name = each["name"]
        if name not in places:
            reason = f"a tolerance is for {_quoted(name)}, which is no joint here"
            raise GoalRefused(reason, Code.INVALID_JOINTS)
        for row, value in enumerate((float(each["position"]), float(each["velocity"]))):
            if not np.isfinite(value):
                raise GoalRefused(f"the tolerance of '{name}' is no number")
            if value:
                bounds[row, places[name]] = np.inf if value < 0 else value
    return bounds
