"""Inverse kinematics solvers as functions that can be tested."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from harness.core.errors import RobotError
from harness.core.registry import described, registry
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.planning.ik.numeric import LinkGoal
from harness.planning.ik.third_party import read_solutions
from harness.planning.model.robot_model import GroupSpace
from harness.plugins.iktest.chain import Chain
from harness.plugins.iktest.strategies.tasks import natural_task
from harness.ports.goals import PoseGoal, PositionGoal
from harness.ports.kinematics import IkRequest, IkSolver
from harness.robot.robot_source import RobotSource, load_source

Solutions = Sequence[FloatArray]


def own_solver(robot: RobotSource, link: str = "") -> Callable[..., Any]:
    """The robot's solver as a function of a pose, a position and pitch, or a position.

    Args:
        link: The link that is placed; by default the TCP.
    """
    chain = Chain.of(load_source(robot), link=link)
    kinematics = PinocchioKinematics(chain.description)

    def solve(goal: LinkGoal, seed: FloatArray) -> Solutions:
        return kinematics.solve(chain.description.arm_group, goal, chain.whole(seed), 0)

    return _function_of(chain, solve)


def plugin_solver(name: str, robot: RobotSource, link: str = "") -> Callable[..., Any]:
    """A registered solver as such a function; answers of third-party solvers are not filtered.

    The function raises UnusableIkResult where such a solver returns no joint positions.

    Raises:
        RobotError: The solver is not made for the arm.
    """
    solver: type[IkSolver] = registry(IkSolver.plugin_kind)[name]
    chain = Chain.of(load_source(robot), link=link)
    kinematics = PinocchioKinematics(replace(chain.description, ik_solver=name))
    group = chain.description.arm_group

    def request(goal: LinkGoal, seed: FloatArray) -> IkRequest:
        space = GroupSpace(kinematics.robot, group, chain.whole(seed))
        return kinematics.request(space, goal, chain.whole(seed), 0)

    def solve(goal: LinkGoal, seed: FloatArray) -> Solutions:
        if registry(IkSolver.plugin_kind).is_own(name):
            return kinematics.solve(group, goal, chain.whole(seed), 0)
        return read_solutions(solver().solve(request(goal, seed)), len(chain.joint_names))

    function = _function_of(chain, solve)
    home = chain.link_pose(chain.home)
    goals: dict[str, LinkGoal] = {
        "pose": PoseGoal(chain.link, home),
        "position and pitch": PositionGoal(chain.link, home.translation, 0.0),
        "position": PositionGoal(chain.link, home.translation),
    }
    if not solver.fits(request(goals[natural_task(chain)], chain.home)):
        raise RobotError(
            f"{described(IkSolver.plugin_kind, name)} is not made for '{chain.description.name}' "
            f"and a {natural_task(chain)}"
        )
    return function


def _function_of(
    chain: Chain, solve: Callable[[LinkGoal, FloatArray], Solutions]
) -> Callable[..., Any]:
    """What an arm can be given as a goal, as a function that `harness ik-test` can call."""
    functions: dict[str, Callable[..., Any]] = {
        "pose": lambda matrix, seed: solve(PoseGoal(chain.link, SE3.from_matrix(matrix)), seed),
        "position and pitch": lambda position, pitch, seed: solve(
            PositionGoal(chain.link, position, pitch), seed
        ),
        "position": lambda position, seed: solve(PositionGoal(chain.link, position), seed),
    }
    return functions[natural_task(chain)]
