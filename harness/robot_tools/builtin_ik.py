"""The inverse kinematics that this program plans with, as a function that can be tested."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.ports import PoseGoal, PositionGoal
from harness.robot.chain import Chain
from harness.robot_tools.robot_source import RobotSource, load
from harness.strategies.tasks import natural_task

Solutions = Sequence[FloatArray]


def own_solver(robot: RobotSource, link: str = "") -> Callable[..., Any]:
    """A solver of what an arm can reach: a pose, a position and pitch, or a position.

    Args:
        robot: The arm to be solved.
        link: The link that is placed; by default the TCP.
    """
    chain = Chain.of(load(robot), link=link)
    name = chain.description.arm_group
    kinematics = PinocchioKinematics(chain.description)

    def pose(matrix: FloatArray, seed: FloatArray) -> Solutions:
        goal = PoseGoal(chain.link, SE3.from_matrix(matrix))
        return kinematics.solve(name, goal, chain.whole(seed), 0)

    def position_and_pitch(position: FloatArray, pitch: float, seed: FloatArray) -> Solutions:
        goal = PositionGoal(chain.link, position, pitch)
        return kinematics.solve(name, goal, chain.whole(seed), 0)

    def position_alone(position: FloatArray, seed: FloatArray) -> Solutions:
        goal = PositionGoal(chain.link, position)
        return kinematics.solve(name, goal, chain.whole(seed), 0)

    solvers: dict[str, Callable[..., Any]] = {
        "pose": pose,
        "position and pitch": position_and_pitch,
        "position": position_alone,
    }
    return solvers[natural_task(chain)]
