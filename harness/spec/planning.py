"""How motions are planned: PlanRequestParameters' words."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from harness.spec.base import (
    Angle,
    Count,
    Duration,
    JointJerk,
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

    pipeline: Literal["ompl", "pilz_industrial_motion_planner"] | None = Field(
        default=None,
        description="Only `ompl`, the default; Pilz's planners are the steps `ptp`, `lin`, `circ`.",
    )
    planner_id: Name | None = Field(
        default=None, description="Default `RRTConnect`; `harness list planners` has the others."
    )
    planning_time: Annotated[Duration, Field(gt=0)] | None = Field(
        default=None, description="Converted to state checks at a fixed rate; never a wall clock."
    )
    max_state_checks: Annotated[Count, Field(ge=1, le=10_000_000)] | None = Field(
        default=None,
        description="Budget of a search: states checked for collision; default 200000.",
    )
    planning_attempts: Annotated[Count, Field(ge=1, le=100)] | None = Field(
        default=None,
        description="Searches at most, each with its own seed, until one succeeds; default 1.",
    )
    max_velocity_scaling_factor: Scaling | None = Field(
        default=None, description="Share of the joints' velocity limits; default 0.3."
    )
    max_acceleration_scaling_factor: Scaling | None = Field(
        default=None, description="Share of the joints' acceleration limits; default 0.3."
    )
    max_jerk: Annotated[JointJerk, Field(gt=0)] | None = Field(
        default=None, description="Of every joint; by default the jerk is not limited."
    )
    padding: NonNegativeLength | None = Field(
        default=None,
        description="Kept between every object and the robot with what it holds [m]; default 2 mm.",
    )
    parameters: dict[Name, Number] | None = Field(
        default=None, description="Of the planner: `range` ..."
    )


class OrientationConstraint(SpecModel):
    """Keep a link turned as given, within a tolerance about each axis."""

    link: Name | None = Field(default=None, description="Default: the TCP.")
    pose: Pose = Field(description="Its rotation.")
    tolerance: tuple[NonNegativeAngle, NonNegativeAngle, NonNegativeAngle] = Field(
        description="About x, y, z [rad]."
    )


class PositionConstraint(SpecModel):
    """Keep a link's origin inside a box."""

    link: Name | None = Field(default=None, description="Default: the TCP.")
    center: Position = Field(description="Of the box.")
    size: tuple[PositiveLength, PositiveLength, PositiveLength] = Field(
        description="Full size of the box [m]."
    )


class JointConstraint(SpecModel):
    """Keep a joint near a position."""

    position: JointValue = Field(description="Where it shall stay.")
    tolerance_above: Annotated[Angle, Field(ge=0)] = Field(description="So much more.")
    tolerance_below: Annotated[Angle, Field(ge=0)] = Field(description="So much less.")


class PathConstraints(SpecModel):
    """moveit_msgs/Constraints held along the path."""

    orientation: OrientationConstraint | None = Field(default=None, description="Of a link.")
    position: PositionConstraint | None = Field(default=None, description="Of a link.")
    joints: dict[Name, JointConstraint] | None = Field(default=None, description="By name.")
