"""move_relative: Task Constructor's straight move by a distance."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field, model_validator

from harness.cell.cell import Cell
from harness.cell.goals import group_of
from harness.cell.scope import At
from harness.cell.step import Step
from harness.core.amounts import amount
from harness.core.types import FloatArray
from harness.language.base import Angle, Length, Name, PositiveLength
from harness.language.poses import Direction
from harness.ports.motion_planning import MotionPlan, MotionRequest, PlanningOptions
from harness.ports.motions import RelativeMotion


def check_lengths(exact: float | None, least: float | None, most: float | None) -> None:
    """Refuse a length that is stated twice.

    Raises:
        ValueError: It is exact and bounded as well, or its bounds contradict each other.
    """
    if exact is not None and (least or most):
        raise ValueError("a move takes `distance`, or `min_distance` and `max_distance`")
    if least and most and least > most:
        raise ValueError("`min_distance` must not be more than `max_distance`")


class MoveRelative(Step):
    """Move the link by a distance, or turn it by an angle: Task Constructor's MoveRelative."""

    verb: ClassVar[str] = "move_relative"
    moves_arm: ClassVar[bool] = True
    one_of = ("direction", "rotation")
    goes_with: ClassVar[Mapping[str, tuple[str, ...]]] = {"angle": ("rotation",)}

    direction: Direction | None = Field(
        default=None, description="The link moves straight in this direction."
    )
    rotation: Direction | None = Field(
        default=None, description="The link turns about this axis through its origin."
    )
    distance: Annotated[Length, Field(gt=0)] | None = Field(
        default=None, description="The move has exactly this length [m]."
    )
    min_distance: PositiveLength | None = Field(
        default=None, description="The move has at least this length, or the step fails [m]."
    )
    max_distance: PositiveLength | None = Field(
        default=None, description="The move has at most this length [m]."
    )
    angle: Annotated[Angle, Field(gt=0)] | None = Field(
        default=None, description="With `rotation`, the link turns by this angle [rad]."
    )
    link: Name | None = Field(
        default=None, description="The link that moves; the default is the TCP."
    )

    @model_validator(mode="after")
    def _one_amount(self) -> MoveRelative:
        if self.rotation is not None:
            if self.angle is None:
                raise ValueError("a `rotation` needs an `angle`")
            if any((self.distance, self.min_distance, self.max_distance)):
                raise ValueError("a `rotation` takes an `angle` and no distance")
            return self
        if self.distance is None and self.max_distance is None:
            raise ValueError("a `direction` needs a `distance` or a `max_distance`")
        check_lengths(self.distance, self.min_distance, self.max_distance)
        return self

    def summary(self) -> str:
        distance = self.distance or self.max_distance
        return amount(distance, "m") if distance else amount(self.angle or 0.0, "rad")

    def check(self, at: At) -> None:
        at.scope.check_group(self.group, at.key("group"))
        at.scope.check_link(self.link, at.key("link"))
        for key in ("direction", "rotation"):
            direction = getattr(self, key)
            if direction is not None:
                at.scope.check_frame(direction.frame, at.key(key, "frame"))

    def execute(self, cell: Cell) -> None:
        cell.sync_scene()
        cell.refuse_joint_hold(cell.robot.group_joints(group_of(cell, self.group)))
        cell.carry_out(self.plan(cell.planning_start(), cell.current.options, cell))

    def plan(self, start: FloatArray, options: PlanningOptions, cell: Cell) -> MotionPlan:
        """Plan the motion from joint positions in description order.

        Raises:
            PlanningFailed: The arm cannot make it.
        """
        twist = np.zeros(6)
        if self.direction is not None:
            twist[:3] = cell.world_direction(self.direction)
            most = self.distance or self.max_distance or 0.0
            least = self.distance or self.min_distance or 0.0
        elif self.rotation is not None and self.angle is not None:
            twist[3:] = cell.world_direction(self.rotation)
            least = most = self.angle
        else:
            raise ValueError("the model has a direction or a rotation")
        return cell.planner.plan(
            MotionRequest(
                group_of(cell, self.group),
                start,
                RelativeMotion(self.link or cell.description.tcp_link, twist, (least, most)),
                options,
            )
        )
