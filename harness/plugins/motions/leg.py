"""Legs of a motion, and the transitions between them."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pinocchio as pin

from harness.core.errors import PlanningFailed
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.planning.cartesian.linear_path import POINT, LinkPath
from harness.planning.cartesian.link_timing import LinkRates
from harness.planning.cartesian.tracing import SOLVED
from harness.planning.collision import wording
from harness.planning.collision.checker import MotionChecker, touch_records
from harness.planning.ik.numeric import LinkTask
from harness.planning.ik.task import part_of_pose
from harness.planning.timing.cubic_spline import CubicSpline
from harness.recording.goal_failures import CollisionFailure
from harness.recording.motion_failures import AdvisedFailure


@dataclass(frozen=True)
class BlendFailure(AdvisedFailure):
    """A blend that cannot be made with its radius [m]."""

    blend_radius: float

    @property
    def advice(self) -> str:
        """A smaller radius, or a stop."""
        return "make the `blend_radius` smaller, or leave it out: then the motion stops there"


JOINT_STEP = 0.03  # Between the samples of a joint motion [rad]
BLEND_STEP = 0.002  # Between the poses that are solved in a transition [m], about
_FEWEST = 8  # samples of a part, however short: a spline needs some
_SEARCHED = 400  # points of a leg looked at for where it enters a sphere
_SAME = 1e-5  # [rad] a transition that ends farther from the next leg is on another branch


class Leg:
    """A motion whose parameter runs from 0 to 1.

    Attributes:
        link: The link whose path is timed.
        path: The path of the link through space; None for a joint motion.
        rates: What the link may do; None for a joint motion.
        positions: Group positions at even parameters, shape (K, dof).
        name: The name in messages: `item 2 (lin)`.
    """

    def __init__(
        self,
        link: str,
        checker: MotionChecker,
        positions: FloatArray,
        path: LinkPath | None = None,
        rates: LinkRates | None = None,
        name: str = "",
    ) -> None:
        self.link, self.path, self.rates, self.name = link, path, rates, name
        self.positions = positions
        self._space = checker.space
        self._spline = CubicSpline.even(positions)

    @classmethod
    def straight(cls, link: str, checker: MotionChecker, end: FloatArray, start: FloatArray) -> Leg:
        """All joints together, straight in joint space."""
        space = checker.space
        count = max(_FEWEST, int(np.ceil(space.distance(start, end) / JOINT_STEP)))
        shares = np.linspace(0.0, 1.0, count + 1)[:, None]
        return cls(link, checker, start + shares * (end - start))

    @property
    def is_still(self) -> bool:
        """Whether the leg ends where it starts."""
        if self.path is not None:
            return self.path.is_point
        return bool(np.all(np.abs(self.positions[-1] - self.positions[0]) < POINT))

    def at(self, parameters: FloatArray) -> FloatArray:
        """Group positions at parameters (N,), shape (N, dof)."""
        return self._spline.evaluate(np.asarray(parameters, dtype=float))[0]

    def pose(self, parameter: float) -> SE3:
        """T_world_link at a parameter."""
        if self.path is not None:
            return self.path.pose(parameter)
        positions = self.at(np.array([parameter]))[0]
        return self._space.robot.link_pose(self._space.whole(positions), self.link)

    def part(self, first: float, last: float) -> FloatArray:
        """Samples from one parameter to another, both included, shape (N, dof)."""
        count = max(_FEWEST, int(np.ceil((last - first) * (len(self.positions) - 1))))
        return self.at(np.linspace(first, last, count + 1))

    def leaves(self, center: FloatArray, radius: float, *, backwards: bool) -> float | None:
        """Where the leg leaves a sphere about its start, or, `backwards`, about its end.

        None when it stays inside.
        """
        shares = np.linspace(0.0, 1.0, _SEARCHED + 1)
        if backwards:
            shares = shares[::-1]

        def outside(share: float) -> bool:
            away = self.pose(share).translation - center
            return float(np.linalg.norm(away)) >= radius

        for inner, outer in pairwise(shares):
            if outside(float(outer)):
                low, high = float(inner), float(outer)
                for _ in range(40):
                    middle = 0.5 * (low + high)
                    low, high = (low, middle) if outside(middle) else (middle, high)
                return high
        return None


@dataclass(frozen=True, eq=False)
class Transition:
    """The transition from one leg into the next, inside a sphere about the point between them.

    Attributes:
        leaves: Parameter of the first leg at which it begins.
        enters: Parameter of the second at which it ends.
        positions: Group positions on it, shape (N, dof).
    """

    leaves: float
    enters: float
    positions: FloatArray


def transition(first: Leg, second: Leg, radius: float, checker: MotionChecker) -> Transition:
    """Blend two legs in space, as Pilz's transition window does.

    The link's pose is a mean of where both legs have it, whose weight goes over from the first to
    the second by 6 u^5 - 15 u^4 + 10 u^3, so that it joins both with the same velocity and
    acceleration. A redundant arm has many joint positions for a pose: it takes those next to the
    same mean of the joint positions of both legs, so that it arrives where the second leg is.

    Raises:
        PlanningFailed: INVALID_MOTION_PLAN, when the sphere is larger than a leg or something is
            in the way; PLANNING_FAILED, when the joints cannot go over so.
    """
    corner = first.pose(1.0).translation
    leaves = first.leaves(corner, radius, backwards=True)
    enters = second.leaves(corner, radius, backwards=False)
    for leg, found in ((first, leaves), (second, enters)):
        if found is None:
            raise PlanningFailed(
                "INVALID_MOTION_PLAN",
                f"the blend radius of {1000 * radius:.1f} mm is larger than {leg.name}",
                BlendFailure(radius),
            )
    if leaves is None or enters is None:
        raise ValueError("both were found")
    count = max(10, int(np.ceil(2 * radius / BLEND_STEP)))
    positions = [first.at(np.array([leaves]))[0]]
    for u in np.linspace(0.0, 1.0, count + 1)[1:]:
        before, after = leaves + u * (1 - leaves), u * enters
        pose = _between(first.pose(before), second.pose(after), u)
        guess = 2 * positions[-1] - positions[-2] if len(positions) > 1 else positions[-1]
        if checker.space.task_space.has_choice:
            start, end = first.at(np.array([before]))[0], second.at(np.array([after]))[0]
            guess = start + _weight(u) * (end - start)
        positions.append(_follow(first, pose, guess, checker))
    last = second.at(np.array([enters]))[0]
    if float(np.abs(positions[-1] - last).max()) > _SAME:
        raise PlanningFailed(
            "PLANNING_FAILED",
            f"the blend from {first.name} into {second.name} ends on another branch of inverse "
            "kinematics; make its radius smaller",
            BlendFailure(radius),
        )
    positions[-1] = last
    return Transition(leaves, enters, np.array(positions))


def _weight(u: float) -> float:
    return ((6 * u - 15) * u + 10) * u**3


def _between(first: SE3, second: SE3, u: float) -> SE3:
    weight = _weight(u)
    turn = pin.log3(second.rotation @ first.rotation.T)
    return SE3(
        pin.exp3(weight * turn) @ first.rotation,
        first.translation + weight * (second.translation - first.translation),
    )


def _follow(leg: Leg, pose: SE3, guess: FloatArray, checker: MotionChecker) -> FloatArray:
    """The free joint positions that bring the link to a pose, next to a guess."""
    goal = part_of_pose(checker.space.task_space, leg.link, pose)
    task = LinkTask(checker.space, goal)
    found, error = task.polish(guess, iterations=20)
    space = checker.space
    if error > SOLVED or np.any(found < space.lower) or np.any(found > space.upper):
        raise PlanningFailed(
            "NO_IK_SOLUTION", f"{leg.link} cannot follow the blend after {leg.name}"
        )
    if not checker.state_free(found):
        touches = checker.touches(found)
        raise PlanningFailed(
            "INVALID_MOTION_PLAN",
            f"in the blend after {leg.name} these come too near: {wording.touches(touches)}",
            CollisionFailure(touch_records(touches)),
        )
    return found
