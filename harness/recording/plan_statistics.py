"""Numbers of a plan, as typed records; their fields are those of a step's `planner` in run.json."""

from __future__ import annotations

from dataclasses import dataclass

from harness.core.details import Detail
from harness.core.types import Floats

DIRECT = "direct joint motion"  # the planner of a motion that needed no search


@dataclass(frozen=True)
class PlanStatistics(Detail):
    """What every planned motion has.

    Attributes:
        planner_id: The planner, or `direct joint motion` where no search was needed.
        path_length: Joint-space length of the path [rad].
        raw_path_length: Its length before it was shortened [rad].
        duration: The time that the motion takes [s].
        raw_path: Group positions of the waypoints before; None where nothing was shortened.
    """

    planner_id: str
    state_checks: int
    waypoints: int
    path_length: float
    raw_path_length: float
    duration: float
    raw_path: tuple[Floats, ...] | None = None


@dataclass(frozen=True)
class SearchStatistics(Detail):
    """What a search took.

    Attributes:
        attempts: How often it began anew, the last one included.
        search_checks: The part of the state checks that the search made.
        resolution: The largest distance between two checked states [rad].
        path_deviation: The largest distance of the motion from its path [rad].
    """

    attempts: int
    search_checks: int | None = None
    vertices: int | None = None
    resolution: float | None = None
    path_deviation: float | None = None


@dataclass(frozen=True)
class WayStatistics(Detail):
    """How far a link leaves the way that it follows [m, rad]."""

    position_deviation: float
    orientation_deviation: float


@dataclass(frozen=True)
class RateStatistics(Detail):
    """The largest speed [m/s], acceleration [m/s^2] and turning speed [rad/s] of a link."""

    link_velocity: float
    link_acceleration: float
    link_turning: float
