"""The goals of motion steps: named states, joint positions, poses, lines and arcs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar

from pydantic import Discriminator, Field, Tag

from harness.core.amounts import JointUnits
from harness.language.base import (
    Angle,
    AngularVelocity,
    Deviation,
    JointValue,
    LinearAcceleration,
    LinearVelocity,
    Name,
    NonNegativeAngle,
    SpecModel,
    kind_of,
)
from harness.language.poses import Pose, Position

Tolerances = tuple[NonNegativeAngle, NonNegativeAngle, NonNegativeAngle]

GOAL_KEYS = ("named_target", "joints", "pose", "position")


class GoalTolerance(SpecModel):
    """How close to the goal a motion may end: MoveIt's goal tolerances; wide ones make a region.

    With less than 5 mm and 0.05 rad only the middle of the goal is sought. With more, the middle is
    taken where it can be reached, else the nearest of poses inside; with 0.2 rad and more about an
    axis every pose inside is as good as the middle.
    """

    position: Deviation = Field(
        default=1e-3, description="The motion may end within this radius of the target [m]."
    )
    orientation: Annotated[
        Annotated[NonNegativeAngle, Tag("one")] | Annotated[Tolerances, Tag("many")],
        Discriminator(kind_of),
    ] = Field(
        default=1e-2,
        description="The motion may end turned by this much about each axis of the goal; three "
        "values are about its x, y and z axes [rad].",
    )


class GoalFields(SpecModel):
    """Exactly one goal of `named_target`, `joints`, `pose`, `position`, with its tolerance."""

    short = "named_target"
    one_of = GOAL_KEYS
    goes_with: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "pitch": ("position",),
        **dict.fromkeys(("link", "tolerance"), ("pose", "position")),
    }

    named_target: Name | None = Field(
        default=None, description="The goal is this SRDF group state."
    )
    joints: dict[Name, JointValue] | None = Field(
        default=None,
        description="The goal is these joint positions, by name; other joints stay.",
        min_length=1,
    )
    pose: Pose | None = Field(default=None, description="The goal is this pose of `link`.")
    position: Position | None = Field(
        default=None, description="The goal is this position of `link`, with any orientation."
    )
    pitch: Angle | None = Field(
        default=None,
        description="With `position`, the x axis of the link points below the horizontal by this "
        "angle.",
    )
    link: Name | None = Field(
        default=None,
        description="The link that pose and position goals are about, or for a pose an attached "
        "object; the default is the TCP.",
    )
    tolerance: GoalTolerance | None = Field(
        default=None, description="How close to a pose or position goal the motion must end."
    )

    def summary_in(self, units: JointUnits) -> str:
        """The goal in a few words, its joint positions in the units of the robot."""
        if self.named_target is not None:
            return self.named_target
        if self.joints is not None:
            return f"joints {units.text(self.joints)}"
        place = self.pose or self.position
        return "" if place is None else place.place()


class CartesianLimitsSpec(SpecModel):
    """Pilz's Cartesian limits; given here they hold as they are, whatever the scaling factors.

    What is not given is 1 m/s, 2.25 m/s**2 and 1.57 rad/s times the scaling factors.
    """

    max_trans_vel: Annotated[LinearVelocity, Field(gt=0)] | None = Field(
        default=None, description="The link moves at most at this speed [m/s]."
    )
    max_trans_acc: Annotated[LinearAcceleration, Field(gt=0)] | None = Field(
        default=None,
        description="The link accelerates at most by this, also towards the centre of an arc "
        "[m/s**2].",
    )
    max_rot_vel: Annotated[AngularVelocity, Field(gt=0)] | None = Field(
        default=None, description="The link turns at most at this speed [rad/s]."
    )


class LineFields(GoalFields):
    """A straight line of the link to a goal."""

    cartesian_limits: CartesianLimitsSpec | None = Field(
        default=None, description="Limits of the link's speed and acceleration along the path."
    )
