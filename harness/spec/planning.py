"""How motions are planned: PlanRequestParameters' words."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from harness.spec.base import (
    Angle,
    Count,
    Duration,
    JointValue,
    Name,
    NonNegativeAngle,
    NonNegativeLength,
    Number,
    PositiveLength,
    SpecModel,
)
from harness.spec.poses import Pose, Position

Scaling = Annotated[Number, Field(ge=0.001, le=1)]
"""Share of a limit; below a thousandth a motion would take hours."""


class Planning(SpecModel):
    """Planning parameters; what is not given comes from the scenario, then from the defaults."""

    pipeline: Literal["ompl", "pilz_industrial_motion_planner"] | None = None
    planner_id: Name | None = Field(
        default=None, description="`RRTConnect`, or MoveIt's configuration name."
    )
    planning_time: Annotated[Duration, Field(gt=0)] | None = Field(
        default=None, description="Converted to state checks at a fixed rate; never a wall clock."
    )
    max_state_checks: Annotated[Count, Field(ge=1, le=10_000_000)] | None = None
    planning_attempts: Annotated[Count, Field(ge=1, le=100)] | None = None
    max_velocity_scaling_factor: Scaling | None = None
    max_acceleration_scaling_factor: Scaling | None = None
    padding: NonNegativeLength | None = Field(
        default=None,
        description="Distance kept between the robot, what it holds, and every object [m].",
    )
    parameters: dict[Name, Number] | None = Field(
        default=None, description="Of the planner: `range` ..."
    )


class OrientationConstraint(SpecModel):
    """Keep a link turned as given, within a tolerance about each axis."""

    link: Name | None = None
    pose: Pose
    tolerance: tuple[NonNegativeAngle, NonNegativeAngle, NonNegativeAngle]


class PositionConstraint(SpecModel):
    """Keep a link's origin inside a box."""

    link: Name | None = None
    center: Position
    size: tuple[PositiveLength, PositiveLength, PositiveLength]


class JointConstraint(SpecModel):
    """Keep a joint near a position."""

    position: JointValue
    tolerance_above: Annotated[Angle, Field(ge=0)]
    tolerance_below: Annotated[Angle, Field(ge=0)]


class PathConstraints(SpecModel):
    """moveit_msgs/Constraints held along the path."""

    orientation: OrientationConstraint | None = None
    position: PositionConstraint | None = None
    joints: dict[Name, JointConstraint] | None = None
