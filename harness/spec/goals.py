"""What a motion step may be asked to reach."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Discriminator, Field, Tag, model_validator

from harness.spec.base import (
    Angle,
    JointValue,
    Name,
    NonNegativeAngle,
    PositiveLength,
    SpecModel,
    kind_of,
)
from harness.spec.poses import Pose, Position

Tolerances = tuple[NonNegativeAngle, NonNegativeAngle, NonNegativeAngle]

GOAL_KEYS = ("named_target", "joints", "pose", "position")


class GoalTolerance(SpecModel):
    """How near is there: MoveIt's goal tolerances; wide ones make the goal a region.

    With less than 5 mm and 0.05 rad the goal's middle is sought alone. With more, the middle is
    taken where it can be reached, else the nearest of poses inside; with 0.2 rad and more about an
    axis every pose inside is as good as the middle.
    """

    position: PositiveLength = Field(default=1e-3, description="Radius around the target [m].")
    orientation: Annotated[
        Annotated[NonNegativeAngle, Tag("one")] | Annotated[Tolerances, Tag("many")],
        Discriminator(kind_of),
    ] = Field(
        default=1e-2,
        description="Largest rotation about each axis of the goal, or about x, y, z [rad].",
    )


class GoalFields(SpecModel):
    """Exactly one of `named_target`, `joints`, `pose`, `position`, and how near is there."""

    short = "named_target"
    goal_keys: ClassVar[tuple[str, ...]] = GOAL_KEYS

    named_target: Name | None = Field(default=None, description="An SRDF group state.")
    joints: dict[Name, JointValue] | None = Field(
        default=None, description="Joint positions by name; the others stay.", min_length=1
    )
    pose: Pose | None = Field(default=None, description="Where `link` shall stand.")
    position: Position | None = Field(
        default=None, description="Where `link` shall be, turned as it may."
    )
    pitch: Angle | None = Field(
        default=None,
        description="With `position`: angle of the link's x axis below the horizontal.",
    )
    link: Name | None = Field(
        default=None, description="Of pose and position goals; default: the TCP."
    )
    tolerance: GoalTolerance | None = Field(default=None, description="Of pose and position goals.")

    @model_validator(mode="after")
    def _one_goal(self) -> GoalFields:
        given = [key for key in self.goal_keys if getattr(self, key) is not None]
        if len(given) != 1:
            found = " and ".join(given) if given else "none"
            raise ValueError(f"exactly one goal of {', '.join(self.goal_keys)}; found {found}")
        if self.pitch is not None and self.position is None:
            raise ValueError("`pitch` goes with `position`; a pose has its own rotation")
        for key in ("link", "tolerance"):
            if getattr(self, key) is not None and given[0] not in ("pose", "position"):
                raise ValueError(f"`{key}` goes with a pose or a position goal")
        return self
