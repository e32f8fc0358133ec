"""What inverse kinematics found: solutions, and those that limits or tolerances forbid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from harness.core.spatial import SE3
from harness.core.types import FloatArray


@dataclass(frozen=True, eq=False)
class LimitedSolution:
    """A solution of the geometry that the position limits forbid.

    Attributes:
        positions: Group positions, as near to the limits as whole turns bring them.
        joint: The joint that is farthest outside.
        value: Its position [rad or m].
        limit: The limit it breaks.
    """

    positions: FloatArray
    joint: str
    value: float
    limit: float

    def facts(self) -> dict[str, Any]:
        """As plain data."""
        return {
            "joint_positions": [float(value) for value in self.positions],
            "joint": self.joint,
            "value": self.value,
            "limit": self.limit,
            "excess": abs(self.value - self.limit),
        }


@dataclass(frozen=True, eq=False)
class MissedSolution:
    """Inside the limits, at the goal in what the arm can choose, too far from it in the rest.

    Attributes:
        positions: Group positions.
        pose: T_world_link there.
        shift: From the goal's point [m].
        turn: From the goal's orientation [rad].
    """

    positions: FloatArray
    pose: SE3
    shift: float
    turn: float


@dataclass(frozen=True)
class IkAnswer:
    """Everything inverse kinematics found.

    Attributes:
        solutions: Inside the limits and the tolerance, nearest to the seed first.
        outside_limits: Solutions of the geometry that limits forbid.
        excess: How much too far away the goal is for the chain [m]; 0 when unknown or within.
        method: `ur`, `open_manipulator_x` or `numeric`.
        task: What was solved for: `pose`; of an arm with too few joints for one, `position and
            pitch` (four or five joints) or `position` (three).
        missed: Solutions of that task that miss the pose's tolerance, least turned first.
    """

    solutions: tuple[FloatArray, ...]
    outside_limits: tuple[LimitedSolution, ...]
    excess: float
    method: str
    task: str = "pose"
    missed: tuple[MissedSolution, ...] = ()
