"""Why a motion was not found: the stages of planning in order, a state to draw, and advice."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, get_args

from harness.core.details import Detail, Details
from harness.core.types import Floats, Pair
from harness.recording.goal_failures import TouchRecord
from harness.recording.plain import PlainError, from_plain

StageName = Literal["reach", "inverse kinematics", "start state", "path", "time parameterisation"]
StageStatus = Literal["passed", "failed", "skipped"]

STAGES: tuple[StageName, ...] = get_args(StageName)
"""In the order in which they are reported."""


@dataclass(frozen=True)
class Stage(Detail):
    """One stage of planning a motion.

    Attributes:
        text: The result in one sentence, with its numbers.
        code: The failure's name in moveit_msgs/MoveItErrorCodes; empty unless it failed.
        details: A line each: a branch of inverse kinematics and what removed it, a pair too near.
    """

    stage: StageName
    status: StageStatus
    text: str
    code: str = ""
    details: tuple[str, ...] = ()


@dataclass(frozen=True)
class FreeShift(Detail):
    """The shortest move along an axis of the world that frees a goal [m], and the robot there."""

    shift: Floats
    joint_positions: Mapping[str, float]


@dataclass(frozen=True)
class NearestState(Detail):
    """A state of the robot that shows why a motion was not found.

    Attributes:
        shows: What the state is, in words.
        joint_positions: Every joint of the robot by name.
        link: The link that has a goal; empty without one.
        target: T_world_link of the goal (xyz, quat wxyz), or its point (xyz).
        pose: T_world_link in the state.
        position_error: Between pose and target [m].
        orientation_error: Between pose and target [rad].
        nearest_free: Where the goal would be free.
    """

    shows: str
    joint_positions: Mapping[str, float]
    link: str | None = None
    target: Floats | None = None
    pose: Floats | None = None
    position_error: float | None = None
    orientation_error: float | None = None
    touches: tuple[TouchRecord, ...] | None = None
    nearest_free: FreeShift | None = None


@dataclass(frozen=True)
class Explanation(Detail):
    """The explanation of a failed motion.

    Attributes:
        nearest: A state to draw.
        advice: What the user can do about the failure.
        picture: File of the drawn state in the run's folder.
    """

    stages: tuple[Stage, ...] | None = None
    nearest: NearestState | None = None
    advice: str | None = None
    picture: str | None = None


@dataclass(frozen=True)
class LoweredMargin(Detail):
    """A pair that may stay nearer than its margin, because it starts nearer [m]."""

    pair: Pair
    start_distance: float
    margin: float


@dataclass(frozen=True)
class LoweredMargins(Detail):
    """Every pair whose margin is lowered during a motion."""

    lowered_margins: tuple[LoweredMargin, ...]


@dataclass(frozen=True)
class StraightResult(Detail):
    """How far a link moved in a straight line [m or rad], and what stopped it."""

    stopped_by: str
    distance: float | None = None


@dataclass(frozen=True)
class Alternative(Detail):
    """One of several goals: its solutions, or its failure."""

    error_code: str
    message: str | None = None
    ways: int | None = None


@dataclass(frozen=True)
class Alternatives(Detail):
    """The goals of which one is enough."""

    alternatives: tuple[Alternative, ...]


@dataclass(frozen=True)
class GoalRegion(Detail):
    """How many poses of a goal's region have a solution."""

    poses_of_region: int


@dataclass(frozen=True)
class ApproachFailure(Detail):
    """Which end of a straight approach cannot be reached, and its direction in the world."""

    is_start_of_approach: bool
    approach_direction: tuple[float, float, float] | None = None


def recorded_explanation(details: Details) -> Explanation:
    """The stages, the state and the advice in a step's record; empty where they do not fit."""
    try:
        return from_plain(details.plain(), Explanation)
    except PlainError:
        return Explanation()
