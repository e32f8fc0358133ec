"""How motions are planned: PlanRequestParameters' words."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from harness.language.base import (
    Angle,
    Count,
    Duration,
    JointJerk,
    JointValue,
    Length,
    Name,
    NonNegativeLength,
    Number,
    Share,
    SpecModel,
)
from harness.language.poses import Pose, Position

Scaling = Annotated[Share, Field(ge=0.001, le=1)]
"""Share of a limit; below a thousandth a motion would take hours."""


class Planning(SpecModel):
    """Planning parameters; what is not given comes from the scenario, then from the defaults."""

    pipeline: Literal["ompl", "pilz_industrial_motion_planner"] | None = Field(
        default=None,
        description="Only `ompl`, the default; Pilz's planners are the steps `ptp`, `lin`, `circ`.",
    )
    planner_id: Name | None = Field(
        default=None,
        description="Default `auto`: a straight joint motion, else the fast planner, else the "
        "patient one; `harness list planners` has the others.",
    )
    planning_time: Annotated[Duration, Field(gt=0)] | None = Field(
        default=None, description="Converted to state checks at a fixed rate; never a wall clock."
    )
    max_state_checks: Annotated[Count, Field(ge=1, le=10_000_000)] | None = Field(
        default=None,
        description="Budget of a search: states checked for collision and path constraints; "
        "default 200000. Planners that improve their path (`RRTstar`, `PRMstar`, `BITstar` ...) "
        "do so for a fifth of it.",
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
        default=None,
        description="Of the planner, by OMPL's names: `range`, `goal_bias`, "
        "`max_nearest_neighbors`, `samples_per_batch` ...",
    )


BandAngle = Annotated[Angle, Field(ge=0.001)]
BandValue = Annotated[JointValue, Field(ge=0.0005)]
BandLength = Annotated[Length, Field(ge=0.0005)]


class OrientationConstraint(SpecModel):
    """Keep a link turned as given, within a tolerance about each axis."""

    link: Name | None = Field(default=None, description="Default: the TCP.")
    pose: Pose = Field(description="Its rotation.")
    tolerance: tuple[BandAngle, BandAngle, BandAngle] = Field(
        description="About x, y, z of `pose`, 0.001 at least; 3.15 and more: any turn [rad]."
    )


class PositionConstraint(SpecModel):
    """Keep a link's origin inside a box."""

    link: Name | None = Field(default=None, description="Default: the TCP.")
    center: Position = Field(description="Of the box.")
    size: tuple[BandLength, BandLength, BandLength] = Field(
        description="Full size along the axes of the centre's frame, 0.5 mm at least [m]."
    )


class JointConstraint(SpecModel):
    """Keep a joint near a position."""

    position: JointValue = Field(description="Where it shall stay.")
    tolerance_above: BandValue = Field(description="So much more, 0.0005 at least.")
    tolerance_below: BandValue = Field(description="So much less, 0.0005 at least.")


class PathConstraints(SpecModel):
    """moveit_msgs/Constraints held along the path; at least one."""

    orientation: OrientationConstraint | None = Field(default=None, description="Of a link.")
    position: PositionConstraint | None = Field(default=None, description="Of a link.")
    joints: dict[Name, JointConstraint] | None = Field(default=None, description="By name.")

    @model_validator(mode="after")
    def _some(self) -> PathConstraints:
        if self.orientation is None and self.position is None and not self.joints:
            raise ValueError("path constraints are at least one of orientation, position, joints")
        return self
