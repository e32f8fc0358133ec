"""Studies a goal: its solutions of inverse kinematics, their postures, and whether each is free."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.planning.collision.checker import touch_records
from harness.planning.collision.wording import joint_value
from harness.planning.ik.answer import IkAnswer
from harness.planning.ik.kinematics import CLOSED_FORMS, PinocchioKinematics
from harness.planning.ik.numeric import LinkGoal
from harness.planning.model.robot_model import GroupSpace
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
_STRAIGHT = 1e-6  # [m] an elbow this near the line from shoulder to wrist is neither up nor down


def branch_name(
    kinematics: PinocchioKinematics, space: GroupSpace, method: str, positions: FloatArray
) -> str:
    """Name the posture of an arm: `forwards, elbow up, wrist_2_joint < 0`.

    Forwards is the side to which the arm is stretched at zero; up is along joint 1's axis. Both
    require a turntable (joint 1) followed by two links (joints 2 and 3), as for analytic solvers.

    Args:
        kinematics: The kinematics of the robot.
        space: The space of the planning group.
        method: The solver's name; only closed forms have branches, so others' names are empty.
        positions: The positions of the group's joints.
    """
    if method not in CLOSED_FORMS:
        return ""
    shoulder, elbow, wrist, turntable = _landmarks(kinematics, space, positions)
    up = turntable.rotation @ _axis(space)
    reach = wrist - shoulder
    ahead = reach - up * float(reach @ up)
    forwards = turntable.rotation @ _zero_heading(kinematics, space)
    words = ["forwards" if float(ahead @ forwards) >= 0 else "backwards"]
    normal = up - reach * float(up @ reach) / max(float(reach @ reach), 1e-12)
    rise = float((elbow - shoulder) @ normal)
    words.append(
        "elbow straight" if abs(rise) < _STRAIGHT else f"elbow {'up' if rise > 0 else 'down'}"
    )
    if method == "ur":
        turned = float(np.sin(positions[4]))
        words.append(f"{space.joint_names[4]} {'<' if turned < 0 else '>'} 0")
    return ", ".join(words)


def _landmarks(
    kinematics: PinocchioKinematics, space: GroupSpace, positions: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, SE3]:
    """Origins of joints 2, 3 and 4, and T_world_link1."""
    links = _links(space)
    whole = space.whole(positions)
    poses = [kinematics.link_pose(whole, link) for link in links[:4]]
    return poses[1].translation, poses[2].translation, poses[3].translation, poses[0]


def _zero_heading(kinematics: PinocchioKinematics, space: GroupSpace) -> FloatArray:
    """Direction from joint 2 to joint 4 at zero, across joint 1's axis, in link 1's frame."""
    shoulder, _, wrist, turntable = _landmarks(kinematics, space, np.zeros(space.dof))
    ahead = turntable.rotation.T @ (wrist - shoulder)
    axis = _axis(space)
    return ahead - axis * float(ahead @ axis)


def _axis(space: GroupSpace) -> FloatArray:
    joint = space.robot.description.joint_by_name[space.joint_names[0]]
    return np.asarray(joint.axis, dtype=float)


def _links(space: GroupSpace) -> list[str]:
    joints = space.robot.description.joint_by_name
    return [joints[name].child for name in space.joint_names]


@dataclass(frozen=True, eq=False)
class Branch:
    """A solution inside the limits, and whether it is free.

    Attributes:
        positions: The positions of the group's joints.
        name: The posture of the arm; empty where the solver has no branches.
        distance: The joint-space distance from the start [rad].
        touches: The pairs that are too near.
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
        answer: The result of inverse kinematics.
        branches: The nearest solutions, all checked, nearest first.
        unchecked: The number of further solutions.
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

    def name(positions: FloatArray) -> str:
        return branch_name(kinematics, space, answer.method, positions)

    branches = tuple(
        Branch(
            positions,
            name(positions),
            space.distance(reference, positions),
            tuple(find_touches(positions)),
            kinematics.residual(space, goal, positions),
        )
        for positions in answer.solutions[:MOST_GOALS]
    )
    outside = tuple(name(solution.positions) for solution in answer.outside_limits)
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
