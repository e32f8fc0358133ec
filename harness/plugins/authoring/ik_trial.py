"""Measures the success rate of inverse kinematics on poses from forward kinematics."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from harness.core.types import FloatArray
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.planning.model.robot_model import GroupSpace
from harness.ports.goals import PoseGoal


@dataclass(frozen=True)
class IkTrial:
    """The result of a trial on reachable poses.

    Attributes:
        solver: The solver: `ur`, `open_manipulator_x` or `numeric`.
        solved: The number of poses with a solution.
        poses: The number of poses.
        worst: The largest distance of a found solution from its pose [m].
    """

    solver: str
    solved: int
    poses: int
    worst: float

    @property
    def rate(self) -> float:
        """Share of the poses that are solved."""
        return self.solved / self.poses if self.poses else 0.0


def try_ik(
    kinematics: PinocchioKinematics,
    positions: FloatArray,
    seed: int,
    on_solved: Callable[[int], None] = lambda _: None,
) -> IkTrial:
    """Solve for the TCP's poses at joint positions, seeded with the robot's start state.

    Args:
        kinematics: The kinematics of a robot with an arm group.
        positions: Joint positions in description order, shape (N, n).
        seed: The seed of solvers that draw joint positions.
        on_solved: Called with the number of poses that were tried.
    """
    description = kinematics.description
    start = description.start_positions()
    space = GroupSpace(kinematics.robot, description.arm_group, start)
    solver, solved, worst = "", 0, 0.0
    for number, row in enumerate(positions):
        reached = space.whole(space.part(row))  # joints outside the group stay
        pose = kinematics.link_pose(reached, description.tcp_link)
        goal = PoseGoal(description.tcp_link, pose)
        answer = kinematics.analyse(space, goal, start, seed + number)
        solver = answer.method
        if answer.solutions:
            solved += 1
            found = kinematics.link_pose(space.whole(answer.solutions[0]), description.tcp_link)
            worst = max(worst, float(np.linalg.norm(found.translation - pose.translation)))
        on_solved(number + 1)
    return IkTrial(solver, solved, len(positions), worst)
