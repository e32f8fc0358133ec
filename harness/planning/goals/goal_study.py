"""Studies a goal: its solutions of inverse kinematics, their postures, and whether each is free."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from harness.core.registry import registry
from harness.core.types import FloatArray
from harness.planning.collision.checker import touch_records
from harness.planning.collision.wording import joint_value
from harness.planning.ik.answer import IkAnswer
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.planning.ik.numeric import LinkGoal
from harness.planning.model.robot_model import GroupSpace
from harness.ports.kinematics import IkSolver
from harness.ports.scene import Touch
from harness.recording.goal_failures import (
    BrokenLimit,
    IkResidual,
    IkSolution,
    IkStudy,
    RefusedIkSolution,
)

MOST_GOALS = 8
"""Number of solutions of inverse kinematics that are checked and planned to, nearest first."""

LIMIT_ROUNDING = 1e-5
"""Excess over a joint limit that counts as rounding [rad or m]: files write pi as 3.14159."""

FindTouches = Callable[[FloatArray], Sequence[Touch]]
"""Pairs too near at group positions; empty where they are free."""


@dataclass(frozen=True, eq=False)
class Branch:
    """A solution inside the limits, and whether it is free.

    Attributes:
        name: The posture of the arm; empty where the solver has no branches.
        distance: The joint-space distance from the start [rad].
        residual: The position error [m] and the orientation error [rad].
    """

    positions: FloatArray
    name: str
    distance: float
    touches: tuple[Touch, ...]
    residual: tuple[float, float]

    @property
    def record(self) -> IkSolution:
        """The solution as a step's record has it."""
        return IkSolution(
            joint_positions=tuple(map(float, self.positions)),
            branch=self.name,
            distance=self.distance,
            status="in collision" if self.touches else "free",
            touches=touch_records(self.touches),
            residual=IkResidual(*self.residual),
        )


@dataclass(frozen=True, eq=False)
class GoalStudy:
    """The solutions of inverse kinematics for a goal, and the collisions of the nearest ones.

    Attributes:
        branches: The nearest solutions, all checked, nearest first.
        outside: The names of the branches outside the limits, in the answer's order.
    """

    answer: IkAnswer
    branches: tuple[Branch, ...]
    unchecked: int
    outside: tuple[str, ...]

    @property
    def record(self) -> IkStudy:
        """The study as a step's record has it."""
        answer = self.answer
        limited = zip(answer.outside_limits, self.outside, strict=True)
        return IkStudy(
            answer.method,
            answer.task,
            tuple(branch.record for branch in self.branches),
            tuple(solution.record(name) for solution, name in limited),
            tuple(
                RefusedIkSolution(
                    tuple(map(float, refused.positions)), IkResidual(refused.shift, refused.turn)
                )
                for refused in answer.refused
            )
            or None,
        )


def study_goal(
    kinematics: PinocchioKinematics,
    space: GroupSpace,
    find_touches: FindTouches,
    start: FloatArray,
    goal: LinkGoal,
    seed: int,
) -> GoalStudy:
    """Solve a goal and check the nearest solutions.

    Raises:
        PlanningFailed: INVALID_LINK_NAME.
    """
    answer = kinematics.analyse(space, goal, start, seed)
    reference = space.part(start)

    request = kinematics.request(space, goal, start, seed)
    solver: type[IkSolver] = registry(IkSolver.plugin_kind)[answer.method]

    branches = tuple(
        Branch(
            positions,
            solver.branch_name(request, positions),
            space.distance(reference, positions),
            tuple(find_touches(positions)),
            kinematics.residual(space, goal, positions),
        )
        for positions in answer.solutions[:MOST_GOALS]
    )
    outside = tuple(
        solver.branch_name(request, solution.positions) for solution in answer.outside_limits
    )
    return GoalStudy(answer, branches, len(answer.solutions) - len(branches), outside)


def broken_limits(space: GroupSpace, positions: FloatArray) -> tuple[BrokenLimit, ...]:
    """The joints outside their limits and their excess, in the group's order."""
    return tuple(
        BrokenLimit(
            name, float(value), float(low), float(high), float(max(low - value, value - high))
        )
        for name, value, low, high in zip(
            space.joint_names, positions, space.lower, space.upper, strict=True
        )
        if not low - LIMIT_ROUNDING <= value <= high + LIMIT_ROUNDING
    )


def limit_sentence(space: GroupSpace, broken: BrokenLimit) -> str:
    """`elbow_joint would be at 3.500 rad (200.5°), 0.360 rad (20.6°) beyond its limit ...`."""
    name, value, excess = broken.joint, broken.value, broken.excess
    limit = broken.lower if value < broken.lower else broken.upper
    return (
        f"{name} would be at {joint_value(space, name, value)}, "
        f"{joint_value(space, name, excess)} beyond its limit {joint_value(space, name, limit)}"
    )
