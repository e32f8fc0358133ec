"""What a motion step may be asked to reach."""

from __future__ import annotations

from pydantic import Field, model_validator

from harness.spec.base import Angle, JointValue, Name, SpecModel
from harness.spec.poses import Pose, PoseTolerance, Position

GOAL_KEYS = ("named_target", "joints", "pose", "position")


class GoalFields(SpecModel):
    """Exactly one of `named_target`, `joints`, `pose`, `position`, and how near is there."""

    short = "named_target"

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
    tolerance: PoseTolerance | None = Field(default=None, description="Of pose and position goals.")

    @model_validator(mode="after")
    def _one_goal(self) -> GoalFields:
        given = [key for key in GOAL_KEYS if getattr(self, key) is not None]
        if len(given) != 1:
            found = " and ".join(given) if given else "none"
            raise ValueError(f"exactly one goal of {', '.join(GOAL_KEYS)}; found {found}")
        if self.pitch is not None and self.position is None:
            raise ValueError("`pitch` goes with `position`; a pose has its own rotation")
        for key in ("link", "tolerance"):
            if getattr(self, key) is not None and given[0] in ("named_target", "joints"):
                raise ValueError(f"`{key}` goes with a pose or a position goal")
        return self
