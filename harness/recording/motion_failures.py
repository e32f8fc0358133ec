"""Why no motion reaches a goal, as typed records; their fields are those of `explanation`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from harness.core.details import Detail
from harness.core.types import Floats
from harness.recording.goal_failures import CollisionFailure, TouchRecord

BrokenRule = Literal[
    "timing",
    "stamps",
    "start",
    "end",
    "rest at start",
    "rest at end",
    "position limit",
    "velocity limit",
    "acceleration limit",
    "jerk limit",
    "effort limit",
    "standing effort",
    "path constraints",
    "path",
    "collision",
]
StopReason = Literal["unreachable", "limit", "jump", "collision"]


@dataclass(frozen=True)
class TrajectoryFailure(Detail):
    """The first rule that a timed motion breaks.

    Attributes:
        distance: The distance from the required position [rad or m].
        path_deviation: The distance from the path that was checked [rad].
        time: The time since the motion's start [s].
    """

    broken: BrokenRule
    joint: str | None = None
    distance: float | None = None
    speed: float | None = None
    excess: float | None = None
    path_deviation: float | None = None
    time: float | None = None


@dataclass(frozen=True)
class OverloadFailure(Detail):
    """A joint whose effort limit is too small to stand still [N m or N].

    Attributes:
        held: The objects that the robot holds; None without a payload.
        most_mass: The mass that the robot can hold there [kg].
    """

    effort: float
    limit: float
    held: tuple[str, ...] | None = None
    unloaded: float | None = None
    most_mass: float | None = None


@dataclass(frozen=True)
class ConstraintFailure(Detail):
    """The path constraint that a state breaks most."""

    constraint_value: float
    constraint_lower: float
    constraint_upper: float


@dataclass(frozen=True)
class DurationFailure(Detail):
    """A joint that needs longer than the requested duration [s]."""

    joint: str
    shortest_duration: float
    duration: float


@dataclass(frozen=True)
class BlockedWay(Detail):
    """How much of a straight way is free, and what blocks the rest."""

    free_share: float
    touches: tuple[TouchRecord, ...]


@dataclass(frozen=True)
class SearchFailure(Detail):
    """A search that found no path.

    Attributes:
        gap: Joint-space distance between the search trees [rad].
    """

    state_checks: int
    gap: float | None = None
    straight_way: BlockedWay | None = None


class AdvisedFailure(Detail):
    """A failure that no obstacle causes, and that has an advice of its own."""

    @property
    def advice(self) -> str:
        """What the user can do about it."""
        raise NotImplementedError


@dataclass(frozen=True)
class PipelineFailure(AdvisedFailure):
    """The third-party planning pipeline whose search or path fails."""

    planner: str

    @property
    def advice(self) -> str:
        """What the user can do about a pipeline that does not keep to its contract."""
        return f"correct the plug-in `{self.planner}`, or plan without `pipeline`"


@dataclass(frozen=True)
class PathCollision(CollisionFailure):
    """Bodies that are too near on a path, and the first positions of the group where they are."""

    joint_positions: Floats


@dataclass(frozen=True)
class TraceFailure(Detail):
    """What stopped a link on its way.

    Attributes:
        joint_positions: The positions of the group where the link stops.
        residual: The error of inverse kinematics [m, rad].
        joint: The joint that meets its limit, or jumps.
        limit: The limit that it meets [rad or m].
        jump: The size of the jump [rad or m].
        deviation: The distance of the curve through the poses from the way [m].
    """

    reason: StopReason
    joint_positions: Floats | None = None
    free_share: float | None = None
    residual: float | None = None
    joint: str | None = None
    limit: float | None = None
    jump: float | None = None
    deviation: float | None = None
    touches: tuple[TouchRecord, ...] | None = None


@dataclass(frozen=True)
class DistanceFailure(Detail):
    """A relative motion that ends before its least distance [m or rad]."""

    reached: float
    least: float


@dataclass(frozen=True)
class DeviationFailure(AdvisedFailure):
    """A timed motion whose link leaves its way too far [m, rad]."""

    position_deviation: float
    orientation_deviation: float

    @property
    def advice(self) -> str:
        """Another posture, or another kind of motion."""
        return (
            "begin the motion in another posture (a `move_to` with `joints` before it), or use "
            "`move_to`, which need not keep to a line"
        )


@dataclass(frozen=True)
class SequenceFailure(Detail):
    """The item of a sequence that cannot be carried out, from 0."""

    item: int
