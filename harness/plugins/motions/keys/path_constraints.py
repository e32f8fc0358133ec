"""The key `path_constraints` of a step."""

from __future__ import annotations

from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field, model_validator

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.core.spatial import SE3
from harness.language.base import Angle, JointValue, Length, Name, SpecModel
from harness.language.poses import Pose, Position
from harness.ports.goals import JointBand, OrientationBand, PathConstraints, PositionBox
from harness.steps.move_to import ConstraintsKey

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


class PathConstraintsSpec(ConstraintsKey):
    """The moveit_msgs/Constraints that hold along the path; at least one is given."""

    key: ClassVar[str] = "path_constraints"

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

    def check(self, group: str | None, at: At) -> None:
        """Report names that the robot or the scene does not have."""
        scope, band, box = at.scope, self.orientation, self.position
        if band is not None:
            scope.check_link_or_held(band.link, at.key("path_constraints", "orientation", "link"))
            at.check_pose(band.pose, "path_constraints", "orientation", "pose")
        if box is not None:
            scope.check_link_or_held(box.link, at.key("path_constraints", "position", "link"))
            frame = at.key("path_constraints", "position", "center", "frame")
            scope.check_frame(box.center.frame, frame)
        group = scope.check_group(group, at.key("group"))
        for name in self.joints or {}:
            scope.check_joint(name, at.key("path_constraints", "joints", name), group)

    def resolved(self, cell: Cell) -> PathConstraints:
        """The constraints in the world, for the present state of the cell."""
        band, box, tcp = self.orientation, self.position, cell.description.tcp_link
        orientation = position = None
        if band is not None:
            rotation = cell.world_pose(band.pose).rotation
            orientation = OrientationBand(band.link or tcp, rotation, band.tolerance)
        if box is not None:
            frame = cell.frame(box.center.frame)
            middle = SE3(frame.rotation, frame.apply(np.array(box.center.xyz)))
            position = PositionBox(box.link or tcp, middle, box.size)
        joints = tuple(
            JointBand(
                name, joint.position - joint.tolerance_below, joint.position + joint.tolerance_above
            )
            for name, joint in (self.joints or {}).items()
        )
        return PathConstraints(orientation, position, joints)
