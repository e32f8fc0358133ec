"""Why a goal cannot be reached, as typed records; their fields are those of `explanation`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from harness.core.details import Detail
from harness.core.types import Floats, Pair


@dataclass(frozen=True)
class TouchRecord(Detail):
    """Two bodies and their distance [m], negative where they penetrate each other."""

    pair: Pair
    distance: float


@dataclass(frozen=True)
class CollisionFailure(Detail):
    """Bodies that are too near, nearest first."""

    touches: tuple[TouchRecord, ...]


@dataclass(frozen=True)
class IkResidual(Detail):
    """How far a solution is from its goal [m, rad]."""

    position: float
    orientation: float


@dataclass(frozen=True)
class IkSolution(Detail):
    """A solution of inverse kinematics inside the joint limits.

    Attributes:
        branch: Name of the branch; empty where the solver names none.
        distance: The joint-space distance from the start [rad].
        status: Whether it is free, and whether the motion ends there.
    """

    joint_positions: Floats
    branch: str
    distance: float
    status: Literal["free", "in collision", "chosen"]
    touches: tuple[TouchRecord, ...]
    residual: IkResidual


@dataclass(frozen=True)
class LimitedIkSolution(Detail):
    """A solution of inverse kinematics outside the joint limits, with its worst joint."""

    joint_positions: Floats
    joint: str
    value: float
    limit: float
    excess: float
    branch: str


@dataclass(frozen=True)
class RefusedIkSolution(Detail):
    """A solution of a third-party solver that misses the goal by forward kinematics."""

    joint_positions: Floats
    residual: IkResidual


@dataclass(frozen=True)
class IkStudy(Detail):
    """Every solution of inverse kinematics for a goal, and what rules it out.

    Attributes:
        refused_solutions: Solutions of a third-party solver, least error first.
    """

    ik_method: str
    ik_task: str
    ik_solutions: tuple[IkSolution, ...]
    outside_limits: tuple[LimitedIkSolution, ...]
    refused_solutions: tuple[RefusedIkSolution, ...] | None = None


@dataclass(frozen=True)
class SolverFailure(Detail):
    """The third-party inverse kinematics solver that fails."""

    ik_solver: str


@dataclass(frozen=True)
class IkFailure(Detail):
    """How near the arm gets to a goal that it does not reach [m, rad].

    Attributes:
        point_out_of_reach_by: The distance to the goal's point in any orientation.
        wrist_out_of_reach_by: The distance of the wrist's centre beyond its reach (closed form).
        nearest_position: The nearest point that the link reaches.
    """

    position_error: float
    orientation_error: float
    point_out_of_reach_by: float | None = None
    wrist_out_of_reach_by: float | None = None
    nearest_position: Floats | None = None


@dataclass(frozen=True)
class LinkFailure(Detail):
    """A link that the joints of the group do not move."""

    link: str
    group: str


@dataclass(frozen=True)
class BrokenLimit(Detail):
    """A joint of a goal outside its limits [rad or m]."""

    joint: str
    value: float
    lower: float
    upper: float
    excess: float


@dataclass(frozen=True)
class LimitFailure(Detail):
    """Joints of a goal that are outside their limits, in the group's order."""

    outside_limits: tuple[BrokenLimit, ...]


@dataclass(frozen=True)
class StartLimitFailure(Detail):
    """The joint that starts farthest outside its limits [rad or m]."""

    joint: str
    value: float
    excess: float
