"""Results of inverse kinematics: solutions, and those outside limits or tolerances."""

from __future__ import annotations

from dataclasses import dataclass

from harness.core.types import FloatArray
from harness.planning.ik.nearest_pose import NearestPose
from harness.recording.goal_failures import LimitedIkSolution


@dataclass(frozen=True, eq=False)
class LimitedSolution:
    """A geometric solution outside the position limits.

    Attributes:
        positions: Group positions, turned by whole turns towards the limits.
        value: The joint's position [rad or m].
    """

    positions: FloatArray
    joint: str
    value: float
    limit: float

    def record(self, branch: str) -> LimitedIkSolution:
        """The solution as a step's record has it, with the name of its branch."""
        return LimitedIkSolution(
            joint_positions=tuple(map(float, self.positions)),
            joint=self.joint,
            value=self.value,
            limit=self.limit,
            excess=abs(self.value - self.limit),
            branch=branch,
        )


@dataclass(frozen=True)
class IkAnswer:
    """The complete result of inverse kinematics.

    Attributes:
        solutions: Solutions inside the limits and the tolerance, nearest to the seed first.
        excess: How far the goal is beyond the chain's reach [m]; 0 when unknown or within reach.
        method: The name of the solver, a plug-in of the kind `ik_solver`.
        task: What is solved for: `pose`, or for an arm with too few joints `position and pitch`
            (four or five joints) or `position` (three).
        missed: Solutions of that task inside the limits and outside the pose's tolerance, least
            error first.
        refused: Answers of a third-party solver that miss the goal, least error first.
    """

    solutions: tuple[FloatArray, ...]
    outside_limits: tuple[LimitedSolution, ...]
    excess: float
    method: str
    task: str = "pose"
    missed: tuple[NearestPose, ...] = ()
    refused: tuple[NearestPose, ...] = ()
