"""Straight lines of a link in space, as joint motions: LIN and MoveRelative."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pinocchio as pin

from harness.core.spatial import SE3
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.checker import MotionChecker, describe_touches, touch_facts
from harness.planning.ik_numeric import LinkGoal, LinkTask, pitch_of
from harness.planning.profiles import GRID, Curve, Trapezoid, sample
from harness.planning.timing import Limits, slowed_to_limits
from harness.ports import PoseGoal, PositionGoal

MAX_TRANSLATION_VELOCITY = 1.0
"""pilz_cartesian_limits of ur_moveit_config [m/s]."""
MAX_TRANSLATION_ACCELERATION = 2.25
"""[m/s^2]"""
MAX_ROTATION_VELOCITY = 1.57
"""[rad/s]; the acceleration is in proportion, as Pilz has it."""

STEP_LENGTH = 0.005
"""Distance between the poses that are solved on a line [m]."""
STEP_ANGLE = 0.02
"""Turn between them [rad]."""
LARGEST_JOINT_STEP = 0.15
"""A joint that moves farther from one pose to the next has jumped, or is at a singularity [rad]."""

POSITION_DEVIATION = 1e-4
"""How far the timed motion may leave the line [m]."""
ORIENTATION_DEVIATION = 1e-3
"""How far it may be turned away from where it should be [rad]."""

_FEWEST_STEPS = 8
_SOLVED = 1e-8  # [m, rad]


class Line:
    """A link's way from one pose along a constant twist: translation and turn at an even rate.

    Attributes:
        start: T_world_link at parameter 0.
        shift: Translation from 0 to 1, world axes [m].
        turn: Rotation vector from 0 to 1, world axes [rad].
    """

    def __init__(self, link: str, start: SE3, shift: FloatArray, turn: FloatArray) -> None:
        self.link = link
        self.start = start
        self.shift = np.asarray(shift, dtype=float)
        self.turn = np.asarray(turn, dtype=float)

    @classmethod
    def between(cls, link: str, start: SE3, end: SE3) -> Line:
        """The straight line between two poses, turning the shortest way."""
        turn = pin.log3(end.rotation @ start.rotation.T)
        return cls(link, start, end.translation - start.translation, turn)

    @property
    def length(self) -> float:
        """Of the translation [m]."""
        return float(np.linalg.norm(self.shift))

    @property
    def angle(self) -> float:
        """Of the turn [rad]."""
        return float(np.linalg.norm(self.turn))

    def pose(self, parameter: float) -> SE3:
        """T_world_link at a parameter from 0 to 1."""
        rotation = pin.exp3(parameter * self.turn) @ self.start.rotation
        return SE3(rotation, self.start.translation + parameter * self.shift)

    def goal(self, parameter: float, *, whole_pose: bool) -> LinkGoal:
        """What the joints must do at a parameter: the pose, or its position and pitch."""
        pose = self.pose(parameter)
        if whole_pose:
            return PoseGoal(self.link, pose)
        return PositionGoal(self.link, pose.translation, pitch_of(pose.rotation))

    def part(self, share: float) -> Line:
        """The line's first part."""
        return Line(self.link, self.start, share * self.shift, share * self.turn)


@dataclass(frozen=True, eq=False)
class Trace:
    """Joint positions along a line, as far as they go.

    Attributes:
        parameters: Even, from 0; ends at 1 when nothing stopped it, shape (K,).
        positions: Group positions, shape (K, dof).
        stop: Why it went no farther: in words; empty when it reached the end.
        reason: `end`, `unreachable`, `limit`, `jump` or `collision`.
        facts: The numbers behind `stop`.
    """

    parameters: FloatArray
    positions: FloatArray
    stop: str = ""
    reason: str = "end"
    facts: dict[str, Any] = field(default_factory=dict)

    @property
    def share(self) -> float:
        """How much of the line was traced."""
        return float(self.parameters[-1])


def trace(
    line: Line, checker: MotionChecker, start: FloatArray, step_length: float = STEP_LENGTH
) -> Trace:
    """Follow a line from the start's branch of inverse kinematics until its end, or what stops it.

    Arms with fewer than six joints keep position and pitch; their yaw follows from the position.

    Args:
        line: Where the link goes.
        checker: Of the states on it.
        start: Group positions at the line's start.
        step_length: Between the poses that are solved [m].
    """
    space = checker.space
    steps = max(line.length / step_length, line.angle / STEP_ANGLE)
    count = max(_FEWEST_STEPS, int(np.ceil(steps)))
    parameters = np.linspace(0.0, 1.0, count + 1)
    positions = [np.asarray(start, dtype=float)]
    for number in range(1, count + 1):
        goal = line.goal(float(parameters[number]), whole_pose=space.dof >= 6)
        task = LinkTask(space, goal)
        guess = 2 * positions[-1] - positions[-2] if number > 1 else positions[-1]
        found, error = task.polish(guess, iterations=20)
        stopped = _stopped(checker, positions[-1], found, error)
        if stopped is not None:
            reason, message, facts = stopped
            reached = parameters[:number]
            return Trace(reached, np.array(positions), message, reason, facts)
        positions.append(found)
    return Trace(parameters, np.array(positions))


def _stopped(
    checker: MotionChecker, previous: FloatArray, found: FloatArray, error: float
) -> tuple[str, str, dict[str, Any]] | None:
    space = checker.space
    if error > _SOLVED:
        return "unreachable", "the arm reaches no farther on this line", {"residual": error}
    outside = np.maximum(space.lower - found, found - space.upper)
    worst = int(np.argmax(outside))
    if outside[worst] > 1e-9:
        name = space.joint_names[worst]
        limit = space.lower[worst] if found[worst] < space.lower[worst] else space.upper[worst]
        return (
            "limit",
            f"{name} meets its limit {limit:.4f}",
            {"joint": name, "limit": float(limit)},
        )
    jump = np.abs(found - previous)
    fastest = int(np.argmax(jump))
    if jump[fastest] > LARGEST_JOINT_STEP:
        name = space.joint_names[fastest]
        message = (
            f"{name} would jump by {jump[fastest]:.2f} rad from one point of the line to the next "
            "(the arm is at or near a singularity)"
        )
        return "jump", message, {"joint": name, "jump": float(jump[fastest])}
    if not checker.state_free(found):
        touches = checker.touches(found)
        message = f"then these come too near: {describe_touches(touches)}"
        return "collision", message, {"touches": touch_facts(touches)}
    return None


def time_line(
    line: Line, traced: Trace, checker: MotionChecker, limits: Limits, scaling: tuple[float, float]
) -> JointTrajectory:
    """Time a whole trace: the link's velocity a trapezoid, slower where a joint could not follow.

    Args:
        line: What was traced, to its end.
        traced: The joint positions.
        checker: Knows the joints.
        limits: Of the joints, scaled.
        scaling: Of velocity and acceleration, for the Cartesian limits.
    """
    acceleration_share = MAX_TRANSLATION_ACCELERATION / MAX_TRANSLATION_VELOCITY
    rate = scaling[0] * min(
        MAX_TRANSLATION_VELOCITY / max(line.length, 1e-9),
        MAX_ROTATION_VELOCITY / max(line.angle, 1e-9),
    )
    change = scaling[1] * acceleration_share * rate / scaling[0]
    spline = uniform_spline(traced.positions)
    for _ in range(2):  # gentler ramps and a lower middle, before everything is slowed down
        profile = Trapezoid.fastest(1.0, rate, change)
        _, velocities, accelerations = _along(spline, profile)(_fine(profile))
        rate /= max(1.0, float(np.max(np.abs(velocities) / limits.velocity)))
        change /= max(1.0, float(np.max(np.abs(accelerations) / limits.acceleration)))
    profile = Trapezoid.fastest(1.0, rate, change)
    slowed, total = slowed_to_limits(_along(spline, profile), profile.duration, limits)
    return sample(checker.space.joint_names, slowed, total)


def _fine(profile: Trapezoid) -> FloatArray:
    return np.arange(0.0, profile.duration, GRID)


def _along(spline: Curve, profile: Trapezoid) -> Curve:
    """A spline over its parameter, as a curve over time."""

    def curve(times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        s, ds, dds = (column[:, None] for column in profile(times))
        value, slope, bend = spline(s[:, 0])
        return value, slope * ds, slope * dds + bend * ds**2

    return curve


def deviation(
    line: Line,
    trajectory: JointTrajectory,
    pose_of: Callable[[FloatArray], SE3],
    *,
    pitch_only: bool,
) -> tuple[float, float]:
    """Largest distance [m] and turn [rad] of a trajectory's link from its line.

    With `pitch_only` (arms of fewer than six joints) the turn is the difference of pitch.
    """
    axis = line.shift / line.length if line.length > 1e-9 else np.zeros(3)
    worst_shift, worst_turn = 0.0, 0.0
    for positions in trajectory.positions:
        pose = pose_of(positions)
        offset = pose.translation - line.start.translation
        along = float(offset @ axis)
        share = along / line.length if line.length > 1e-9 else None
        worst_shift = max(worst_shift, float(np.linalg.norm(offset - along * axis)))
        if share is None:
            continue
        wanted = line.pose(share)
        turn = (
            abs(pitch_of(pose.rotation) - pitch_of(wanted.rotation))
            if pitch_only
            else wanted.distance_to(pose)[1]
        )
        worst_turn = max(worst_turn, turn)
    return worst_shift, worst_turn


def uniform_spline(values: FloatArray) -> Curve:
    """Cubic spline through rows (K, dof) at even parameters from 0 to 1, with two derivatives.

    Slopes at the ends are the cubic's through the four outermost rows.
    """
    count = len(values) - 1
    h = 1.0 / count
    ends = np.array([-11.0, 18.0, -9.0, 2.0]) / (6 * h)
    matrix = np.zeros((count + 1, count + 1))
    right = np.zeros_like(values)
    matrix[0, 0] = matrix[-1, -1] = 1.0
    right[0], right[-1] = ends @ values[:4], -ends @ values[:-5:-1]
    inner = np.arange(1, count)
    matrix[inner, inner - 1] = matrix[inner, inner + 1] = 1.0
    matrix[inner, inner] = 4.0
    right[1:-1] = 3 * (values[2:] - values[:-2]) / h
    slopes = np.linalg.solve(matrix, right)

    def spline(parameters: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        s = np.clip(parameters, 0.0, 1.0)
        piece = np.minimum((s / h).astype(int), count - 1)
        u = (s / h - piece)[:, None]
        p0, p1 = values[piece], values[piece + 1]
        m0, m1 = h * slopes[piece], h * slopes[piece + 1]
        a, b = 2 * p0 - 2 * p1 + m0 + m1, -3 * p0 + 3 * p1 - 2 * m0 - m1
        return (
            ((a * u + b) * u + m0) * u + p0,
            ((3 * a * u + 2 * b) * u + m0) / h,
            (6 * a * u + 2 * b) / h**2,
        )

    return spline
