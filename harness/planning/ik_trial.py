"""How often inverse kinematics finds what forward kinematics has shown to be there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.types import FloatArray
from harness.planning.kinematics import PinocchioKinematics
from harness.planning.robot_model import GroupSpace
from harness.ports import PoseGoal


@dataclass(frozen=True)
class IkTrial:
    """What became of poses that the robot can take.

    Attributes:
        solver: That was asked: `ur`, `open_manipulator_x` or `numeric`.
        solved: Poses for which it found joint positions.
        poses: How many there were.
        worst: Largest distance of a found solution from its pose [m].
    """

    solver: str
    solved: int
    poses: int
    worst: float

    @property
    def rate(self) -> float:
        """Part of the poses that were solved."""
        return self.solved / self.poses if self.poses else 0.0


def try_ik(kinematics: PinocchioKinematics, positions: FloatArray, seed: int) -> IkTrial:
    """Ask for the TCP's poses at joint positions, from where the robot starts.

    Args:
        kinematics: Of a robot with an arm group.
        positions: Description order, shape (N, n).
        seed: Of the restarts of numeric solvers.
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
    return IkTrial(solver, solved, len(positions), worst)
