"""Follows a link's way through space with the joints, as far as it goes."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from harness.core.errors import ErrorCode
from harness.core.spatial import SE3
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.checker import MotionChecker, describe_touches, touch_facts
from harness.planning.ik_numeric import LinkGoal, LinkTask, pitch_of
from harness.ports import JumpThreshold, PoseGoal, PositionGoal

STEP_LENGTH = 0.005
"""Distance between the poses that are solved on a way [m]."""
STEP_ANGLE = 0.02
"""Turn between them [rad]."""
STEP_SWEEP = 0.1
"""Angle of an arc between them [rad]."""

JUMP = JumpThreshold(revolute=0.15, prismatic=0.05)
"""A joint that moves farther from one pose to the next has jumped, or is at a singularity."""

CODES: dict[str, ErrorCode] = {
    "unreachable": "NO_IK_SOLUTION",
    "limit": "NO_IK_SOLUTION",
    "jump": "PLANNING_FAILED",
    "collision": "INVALID_MOTION_PLAN",
}
"""Failure of a way that must be followed to its end, by the reason of the stop."""

_FEWEST_STEPS = 8
_SOLVED = 1e-8  # [m, rad]


class LinkPath(Protocol):
    """A link's way through space, its parameter running evenly from 0 to 1."""

    link: str
    name: str
    start: SE3

    @property
    def length(self) -> float:
        """Of the translation [m]."""
        ...

    @property
    def angle(self) -> float:
        """Of the turn [rad]."""
        ...

    @property
    def radius(self) -> float:
        """Of the curvature [m]."""
        ...

    def pose(self, parameter: float) -> SE3:
        """T_world_link at a parameter."""
        ...

    def nearest(self, pose: SE3) -> tuple[float, float]:
        """The parameter nearest to a pose's origin, and the distance there [m]."""
        ...


@dataclass(frozen=True, eq=False)
class Trace:
    """Joint positions along a way, as far as they go.

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
        """How much of the way was traced."""
        return float(self.parameters[-1])

    @property
    def reached_end(self) -> bool:
        """Whether nothing stopped it."""
        return self.reason == "end"

    @property
    def largest_step(self) -> float:
        """Farthest that a joint moves from one pose to the next [rad or m]."""
        if len(self.positions) < 2:
            return 0.0
        return float(np.abs(np.diff(self.positions, axis=0)).max())


def trace(
    path: LinkPath,
    checker: MotionChecker,
    start: FloatArray,
    step_length: float = STEP_LENGTH,
    jump: JumpThreshold = JUMP,
) -> Trace:
    """Follow a way from the start's branch of inverse kinematics until its end, or what stops it.

    Arms with fewer than six joints keep position and pitch; their yaw follows from the position.

    Args:
        path: Where the link goes.
        checker: Of the states on it.
        start: Group positions at the way's start.
        step_length: Between the poses that are solved [m].
        jump: What no joint may exceed from one pose to the next.
    """
    space = checker.space
    steps = max(path.length / min(step_length, STEP_SWEEP * path.radius), path.angle / STEP_ANGLE)
    count = max(_FEWEST_STEPS, int(np.ceil(steps)))
    largest = np.where(space.wraps, jump.revolute, jump.prismatic)
    parameters = np.linspace(0.0, 1.0, count + 1)
    positions = [np.asarray(start, dtype=float)]
    for number in range(1, count + 1):
        goal = link_goal(path.link, path.pose(float(parameters[number])), space.dof)
        task = LinkTask(space, goal)
        guess = 2 * positions[-1] - positions[-2] if number > 1 else positions[-1]
        found, error = task.polish(guess, iterations=20)
        stopped = _stopped(path, checker, positions[-1], found, error, largest)
        if stopped is not None:
            reason, message, facts = stopped
            reached = parameters[:number]
            return Trace(reached, np.array(positions), message, reason, facts)
        positions.append(found)
    return Trace(parameters, np.array(positions))


def link_goal(link: str, pose: SE3, dof: int) -> LinkGoal:
    """What the joints must do for a pose: all of it, or its position and pitch."""
    if dof >= 6:
        return PoseGoal(link, pose)
    return PositionGoal(link, pose.translation, pitch_of(pose.rotation))


def _stopped(
    path: LinkPath,
    checker: MotionChecker,
    previous: FloatArray,
    found: FloatArray,
    error: float,
    largest: FloatArray,
) -> tuple[str, str, dict[str, Any]] | None:
    space = checker.space
    if error > _SOLVED:
        message = f"the arm reaches no farther on this {path.name}"
        return "unreachable", message, {"residual": error}
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
    fastest = int(np.argmax(jump / largest))
    if jump[fastest] > largest[fastest]:
        name = space.joint_names[fastest]
        unit = "rad" if space.wraps[fastest] else "m"
        message = (
            f"{name} would jump by {jump[fastest]:.2f} {unit} from one point of the {path.name} to "
            "the next (the arm is at or near a singularity)"
        )
        return "jump", message, {"joint": name, "jump": float(jump[fastest])}
    if not checker.state_free(found):
        touches = checker.touches(found)
        message = f"then these come too near: {describe_touches(touches)}"
        return "collision", message, {"touches": touch_facts(touches)}
    return None


def deviation(
    path: LinkPath,
    trajectory: JointTrajectory,
    pose_of: Callable[[FloatArray], SE3],
    *,
    pitch_only: bool,
) -> tuple[float, float]:
    """Largest distance [m] and turn [rad] of a trajectory's link from its way.

    With `pitch_only` (arms of fewer than six joints) the turn is the difference of pitch.
    """
    worst_shift, worst_turn = 0.0, 0.0
    for positions in trajectory.positions:
        pose = pose_of(positions)
        share, shift = path.nearest(pose)
        wanted = path.pose(min(max(share, 0.0), 1.0))
        if pitch_only:
            turn = abs(pitch_of(pose.rotation) - pitch_of(wanted.rotation))
        else:
            turn = wanted.distance_to(pose)[1]
        worst_shift, worst_turn = max(worst_shift, shift), max(worst_turn, turn)
    return worst_shift, worst_turn
