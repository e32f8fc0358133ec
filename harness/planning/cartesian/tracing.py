"""Follows a link's path through space with the joints, as far as possible."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.errors import ErrorCode
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.planning.cartesian.linear_path import LinkPath
from harness.planning.collision import wording
from harness.planning.collision.checker import MotionChecker, touch_records
from harness.planning.ik.numeric import LinkTask
from harness.planning.ik.task import part_of_pose
from harness.planning.timing.cubic_spline import CubicSpline
from harness.ports.motions import JumpThreshold
from harness.recording.motion_failures import TraceFailure
from harness.robot.task_space import TaskSpace

STEP_LENGTH = 0.005  # Distance between the poses that are solved on a way [m]
STEP_ANGLE = 0.02  # Turn between them [rad]
STEP_SWEEP = 0.1  # Angle of an arc between them [rad]
JUMP = JumpThreshold(revolute=0.15, prismatic=0.05)
"""A joint that moves farther from one pose to the next has jumped, or is at a singularity."""

CODES: dict[str, ErrorCode] = {
    "unreachable": "NO_IK_SOLUTION",
    "limit": "NO_IK_SOLUTION",
    "jump": "PLANNING_FAILED",
    "collision": "INVALID_MOTION_PLAN",
}
"""Failure of a way that must be followed to its end, by the reason of the stop."""

STRIDES = (1, 2, 4, 8)
"""How many poses are tried for one step, until a curve through them stays on the way."""

OFF_BETWEEN = 3e-5  # How far the curve may leave it in the middle between two poses [m]
_FEWEST_STEPS = 8  # of a path, however short: a spline needs some
SOLVED = 1e-8  # Error of a solved state at most [m, rad]


@dataclass(frozen=True, eq=False)
class Trace:
    """Joint positions along a way, as far as they go.

    Attributes:
        parameters: Even, from 0; ends at 1 when nothing stopped it, shape (K,).
        positions: Group positions, shape (K, dof).
        stop: Why the trace ends before the path; empty when it reaches the end.
        failure: The numbers of `stop`; None where nothing stopped it.
        stride: The number of poses per requested step.
    """

    parameters: FloatArray
    positions: FloatArray
    stop: str = ""
    failure: TraceFailure | None = None
    stride: int = 1

    @property
    def share(self) -> float:
        """How much of the way was traced."""
        return float(self.parameters[-1])

    @property
    def reached_end(self) -> bool:
        """Whether nothing stopped it."""
        return self.failure is None


def trace(
    path: LinkPath,
    checker: MotionChecker,
    start: FloatArray,
    step_length: float = STEP_LENGTH,
    jump: JumpThreshold = JUMP,
) -> Trace:
    """Follow a way from the start's branch of inverse kinematics until its end, or what stops it.

    What the group cannot hold of the link's poses follows from the rest.

    Where a curve through the joint positions leaves the way between them, as near a singularity,
    the poses are taken nearer to each other; the trace ends where that does not help.

    Args:
        step_length: Between the poses that are solved [m].
    """
    if path.is_point:
        parameters = np.linspace(0.0, 1.0, _FEWEST_STEPS + 1)
        return Trace(parameters, np.tile(start, (len(parameters), 1)))
    space = checker.space
    steps = max(path.length / min(step_length, STEP_SWEEP * path.radius), path.angle / STEP_ANGLE)
    count = max(_FEWEST_STEPS, int(np.ceil(steps)))
    largest = np.where(space.wraps, jump.revolute, jump.prismatic)
    traced, off = _attempt(path, checker, start, count, largest, 1), np.zeros(0)
    for stride in STRIDES:
        if stride > 1:
            traced = _attempt(path, checker, start, count, largest, stride)
        if len(traced.positions) <= _FEWEST_STEPS:
            return traced
        off = _off_between(path, traced, checker)
        if np.all(off <= OFF_BETWEEN):
            return traced
    kept = max(1, int(np.argmax(off > OFF_BETWEEN)) - _FEWEST_STEPS)
    return Trace(
        traced.parameters[:kept],
        traced.positions[:kept],
        f"the joints cannot turn as fast as the {path.name} requires (the arm is at or near a "
        "singularity)",
        TraceFailure("jump", deviation=float(off.max())),
        traced.stride,
    )


def _attempt(
    path: LinkPath,
    checker: MotionChecker,
    start: FloatArray,
    count: int,
    largest: FloatArray,
    stride: int,
) -> Trace:
    """A trace with `stride` poses for each of `count` steps."""
    space = checker.space
    parameters = np.linspace(0.0, 1.0, count * stride + 1)
    positions = [np.asarray(start, dtype=float)]
    for number in range(1, len(parameters)):
        pose = path.pose(float(parameters[number]))
        goal = part_of_pose(space.task_space, path.link, pose)
        task = LinkTask(space, goal)
        guess = 2 * positions[-1] - positions[-2] if number > 1 else positions[-1]
        found, error = task.polish(guess, iterations=20)
        stopped = _stopped(path, checker, positions[-1], found, error, largest / stride)
        if stopped is not None:
            message, failure = stopped
            reached = parameters[:number]
            return Trace(reached, np.array(positions), message, failure, stride)
        positions.append(found)
    return Trace(parameters, np.array(positions), stride=stride)


def _off_between(path: LinkPath, traced: Trace, checker: MotionChecker) -> FloatArray:
    """How far a spline through a trace leaves the way between neighbouring poses [m], (K - 1,)."""
    middles = (np.arange(len(traced.positions) - 1) + 0.5) / (len(traced.positions) - 1)
    between = CubicSpline.even(traced.positions).evaluate(middles)[0]
    space = checker.space
    return np.array(
        [
            path.nearest(space.robot.link_pose(space.whole(positions), path.link))[1]
            for positions in between
        ]
    )


def _stopped(
    path: LinkPath,
    checker: MotionChecker,
    previous: FloatArray,
    found: FloatArray,
    error: float,
    largest: FloatArray,
) -> tuple[str, TraceFailure] | None:
    space = checker.space
    if error > SOLVED:
        message = f"the arm reaches no farther on this {path.name}"
        return message, TraceFailure("unreachable", residual=error)
    outside = np.maximum(space.lower - found, found - space.upper)
    worst = int(np.argmax(outside))
    if outside[worst] > 1e-9:
        name = space.joint_names[worst]
        limit = space.lower[worst] if found[worst] < space.lower[worst] else space.upper[worst]
        failure = TraceFailure("limit", joint=name, limit=float(limit))
        return f"{name} meets its limit {wording.joint_value(space, name, float(limit))}", failure
    jump = np.abs(found - previous)
    fastest = int(np.argmax(jump / largest))
    if jump[fastest] > largest[fastest]:
        name = space.joint_names[fastest]
        unit = "rad" if space.wraps[fastest] else "m"
        message = (
            f"{name} would jump by {jump[fastest]:.2f} {unit} from one point of the {path.name} to "
            "the next (the arm is at or near a singularity)"
        )
        return message, TraceFailure("jump", joint=name, jump=float(jump[fastest]))
    if not checker.state_free(found):
        touches = checker.touches(found)
        message = f"then these come too near: {wording.touches(touches)}"
        return message, TraceFailure("collision", touches=touch_records(touches))
    return None


def off_path(path: LinkPath, pose: SE3, held: TaskSpace) -> tuple[float, float]:
    """Distance [m] and turn [rad] of a pose from its path, as far as the group can hold them."""
    share, shift = path.nearest(pose)
    return shift, held.turn_between(path.pose(min(max(share, 0.0), 1.0)), pose)
