"""Kinematics of the robot, and solvers of inverse kinematics as plug-ins."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from harness.core.registry import Plugin
from harness.core.spatial import SE3
from harness.core.types import BoolArray, FloatArray
from harness.ports.goals import PoseGoal, PositionGoal
from harness.robot.description import RobotDescription


class Kinematics(Protocol):
    """Where the robot's links are, and which joint positions put them somewhere."""

    def link_pose(self, joint_positions: FloatArray, link: str) -> SE3:
        """T_world_link at joint positions in description order."""
        ...

    def link_poses(self, joint_positions: FloatArray, links: Sequence[str]) -> FloatArray:
        """T_world_link of many samples: (N, n) -> (N, len(links), 7) as xyz, quat wxyz."""
        ...

    def solve(
        self,
        group: str,
        goal: PoseGoal | PositionGoal,
        seed_positions: FloatArray,
        seed: int,
        *,
        enough: int | None = None,
    ) -> Sequence[FloatArray]:
        """Every known solution within position limits, nearest to `seed_positions` first.

        Args:
            group: The name of a chain group.
            goal: What the link must do.
            seed_positions: Description order; joints outside the group stay there.
            seed: The seed of solvers that draw joint positions; no built-in one does.
            enough: The number of solutions with which a numeric solver stops; None for a spread.

        Returns:
            Group joint positions, shape (dof,) each; empty when there is none.
        """
        ...


class JointSpace(Protocol):
    """The joints of a planning group and their limits; the rest of the robot stands still."""

    joint_names: tuple[str, ...]
    lower: FloatArray
    """Position limits, shape (dof,) [rad or m]; -inf for continuous joints."""
    upper: FloatArray
    """The upper ones, shape (dof,)."""
    wraps: BoolArray
    """Which joints turn, so that a whole turn more is the same place, shape (dof,)."""
    metric: FloatArray
    """Weights of joint-space distances, shape (dof,): 1 for radians, more for metres."""

    @property
    def dof(self) -> int:
        """Number of joints."""
        ...

    def distance(self, first: FloatArray, second: FloatArray) -> float:
        """Joint-space distance in the metric [rad]."""
        ...


@dataclass(frozen=True, eq=False)
class IkRequest:
    """What an inverse kinematics solver must find: joint positions that put a link somewhere.

    Attributes:
        goal: The link and its pose, or its position; in world axes.
        space: The joints that move, and their limits.
        seed_positions: Joint positions to start from, shape (dof,).
        description: The robot, with its URDF and SRDF.
        link_pose: T_world_link of the goal's link at joint positions of shape (dof,).
        seed: The only source of randomness; the same request must give the same answer.
        enough: The number of solutions with which a search may stop; None for a spread.
    """

    goal: PoseGoal | PositionGoal
    space: JointSpace
    seed_positions: FloatArray
    description: RobotDescription
    link_pose: Callable[[FloatArray], SE3]
    seed: int
    enough: int | None = None

    @property
    def rng(self) -> np.random.Generator:
        """A generator of random numbers at the start of its sequence."""
        return np.random.default_rng(self.seed)


@dataclass(frozen=True, eq=False)
class IkResult:
    """What an inverse kinematics solver found.

    Attributes:
        solutions: Joint positions, shape (dof,) each, in any order; whole turns are shifted into
            the limits by the caller. Empty when the goal is not reached.
        excess: How far the goal is beyond the chain's reach [m]; 0 when unknown or within reach.
    """

    solutions: tuple[FloatArray, ...]
    excess: float = 0.0


class IkSolver(Plugin, ABC):
    """An inverse kinematics solver, selected by `robot: {ik_solver: NAME}`.

    Its answers are compared with forward kinematics, and those that miss the goal are refused.

    Attributes:
        title: What explanations call it; empty for its name.
        is_closed_form: A built-in one that `auto` tries before the numeric solver.
        is_refined: Answers are exact only for an ideal arm, and are refined by Newton steps.
    """

    plugin_kind: ClassVar[str] = "ik_solver"
    title: ClassVar[str] = ""
    is_closed_form: ClassVar[bool] = False
    is_refined: ClassVar[bool] = False

    @classmethod
    def fits(cls, request: IkRequest) -> bool:
        """Whether the solver is made for such an arm and goal; otherwise `numeric` is used."""
        del request
        return True

    @abstractmethod
    def solve(self, request: IkRequest) -> IkResult:
        """Find joint positions; a new object of the class is made for every goal."""

    @classmethod
    def branch_name(cls, request: IkRequest, positions: FloatArray) -> str:
        """Name the posture of a solution, `forwards, elbow up`; empty without branches."""
        del request, positions
        return ""
