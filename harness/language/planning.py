"""How motions are planned: PlanRequestParameters' words."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Field, model_validator

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
    refuse_percent,
)
from harness.language.plugin_field import PluginName
from harness.language.poses import Pose, Position

Scaling = Annotated[Share, BeforeValidator(refuse_percent), Field(ge=0.001, le=1)]
"""Share of a limit; below a thousandth a motion would take hours."""


_NOT_HERE = "the pipeline is not part of this program"
Pipeline = Annotated[
    Name,
    PluginName(
        "planner",
        refused={
            "pilz_industrial_motion_planner": (
                "Pilz's planners are steps here",
                "write `ptp:`, `lin:` or `circ:` instead of `move_to:`",
            ),
            "chomp": (_NOT_HERE, "leave it out, or install a plug-in that provides it"),
            "stomp": (_NOT_HERE, "leave it out, or install a plug-in that provides it"),
        },
    ),
]


class Planning(SpecModel):
    """Planning parameters; what is not given comes from the scenario, then from the defaults."""

    pipeline: Pipeline | None = Field(
        default=None,
        description="The planning pipeline of free motions: `ompl`, the default, or a plug-in, "
        "whose paths are verified and timed like those of `ompl`; `harness list pipelines` has "
        "their names. Pilz's planners are the steps `ptp`, `lin`, `circ`.",
    )
    planner_id: Name | None = Field(
        default=None,
        description="A planner of the pipeline. The default of `ompl` is `auto`: a direct joint "
        "motion, else `BalancedConnect`, else `RRTConnect`; `harness list planners` has the "
        "others.",
    )
    planning_time: Annotated[Duration, Field(gt=0)] | None = Field(
        default=None,
        description="A time budget that is converted to state checks at a fixed rate; it is never "
        "a wall clock.",
    )
    max_state_checks: Annotated[Count, Field(ge=1, le=10_000_000)] | None = Field(
        default=None,
        description="The budget of a search: states checked for collision and path constraints; "
        "the default is 2000000. Planners that improve their path (`RRTstar`, "
        "`PRMstar`, `BITstar` ...) do so for a fiftieth of it.",
    )
    planning_attempts: Annotated[Count, Field(ge=1, le=100)] | None = Field(
        default=None,
        description="The largest number of searches, each with its own seed, until one succeeds; "
        "the default is 1.",
    )
    max_velocity_scaling_factor: Scaling | None = Field(
        default=None,
        description="The share of the joints' velocity limits that a motion may use; the default "
        "is 0.3.",
    )
    max_acceleration_scaling_factor: Scaling | None = Field(
        default=None,
        description="The share of the joints' acceleration limits that a motion may use; the "
        "default is 0.3.",
    )
    max_jerk: Annotated[JointJerk, Field(gt=0)] | None = Field(
        default=None,
        description="The largest jerk of every joint; by default the jerk is not limited.",
    )
    padding: NonNegativeLength | None = Field(
        default=None,
        description="The distance kept between every object and the robot with what it holds, and "
        "between two arms [m]; the default is 2 mm.",
    )
    seed: Annotated[Count, Field(ge=0, le=2**31 - 1)] | None = Field(
        default=None,
        description="The seed of the planners in place of the scenario's `seed`; of the samples of "
        "`randomize` too, which have seeds of their own otherwise.",
    )
    parameters: dict[Name, Number] | None = Field(
        default=None,
        description="Parameters of the planner; those of `ompl` have OMPL's names: `range`, "
        "`goal_bias`, `max_nearest_neighbors`, `samples_per_batch` ...",
    )


BandAngle = Annotated[Angle, Field(ge=0.001)]
BandValue = Annotated[JointValue, Field(ge=0.0005)]
BandLength = Annotated[Length, Field(ge=0.0005)]


class OrientationConstraint(SpecModel):
    """Keep a link, or an attached object, turned as given within a tolerance about each axis.

    Where any turn about one axis is allowed, and the other two tolerances are equal, they limit the
    tilt of that axis: with `[0.1, 0.1, 3.15]` the z axis stays within 0.1 rad of that of `pose`.
    """

    link: Name | None = Field(
        default=None,
        description="The link or the attached object that is constrained; the default is the TCP.",
    )
    pose: Pose = Field(description="The pose whose rotation the link keeps.")
    tolerance: tuple[BandAngle, BandAngle, BandAngle] = Field(
        description="The tolerances about x, y, z of `pose`, at least 0.001; 3.15 and more allow "
        "any turn [rad]."
    )


class PositionConstraint(SpecModel):
    """Keep the origin of a link, or of an attached object, inside a box."""

    link: Name | None = Field(
        default=None,
        description="The link or the attached object that is constrained; the default is the TCP.",
    )
    center: Position = Field(description="The centre of the box.")
    size: tuple[BandLength, BandLength, BandLength] = Field(
        description="The full size along the axes of the centre's frame, at least 0.5 mm [m]."
    )


class JointConstraint(SpecModel):
    """Keep a joint near a position."""

    position: JointValue = Field(description="The position near which the joint stays.")
    tolerance_above: BandValue = Field(
        description="The largest excess over the position, at least 0.0005."
    )
    tolerance_below: BandValue = Field(
        description="The largest deficit below the position, at least 0.0005."
    )


class PathConstraintsSpec(SpecModel):
    """The moveit_msgs/Constraints that hold along the path; at least one is given."""

    orientation: OrientationConstraint | None = Field(
        default=None, description="The orientation constraint of a link or an attached object."
    )
    position: PositionConstraint | None = Field(
        default=None, description="The position constraint of a link or an attached object."
    )
    joints: dict[Name, JointConstraint] | None = Field(
        default=None, description="The joint constraints by joint name."
    )

    @model_validator(mode="after")
    def _some(self) -> PathConstraintsSpec:
        if self.orientation is None and self.position is None and not self.joints:
            raise ValueError("path constraints are at least one of orientation, position, joints")
        return self
