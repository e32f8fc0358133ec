"""How grippers without fingers take hold of objects, as plug-ins."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.core.registry import Plugin, registry
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.robot.end_effector import Gripper


class Grip(Plugin, ABC):
    """Where a gripper without fingers holds an object."""

    plugin_kind: ClassVar[str] = "grip"

    @abstractmethod
    def check(self, obj: WorldObject | None, at: At, mode: str, *, by_all_cups: bool) -> None:
        """Report an object (None: unknown) that cannot be held, and a `mode` that there is not."""

    @abstractmethod
    def grasps(self, obj: WorldObject, pose: SE3, cell: Cell) -> list[SE3]:
        """T_world_tcp of every grasp of an object at T_world_object, on a face that looks up first.

        Raises:
            StepFailed: GOAL_STATE_INVALID, when no face has room; INVALID_OBJECT_NAME, when no
                face of the object is known.
        """

    @abstractmethod
    def grasps_at(self, point: FloatArray) -> list[SE3]:
        """T_world_tcp of the grasps from above at a point, shape (3,) [m]."""


def grip_of(gripper: Gripper | None) -> Grip | None:
    """The plug-in of a gripper with suction cups; None for one with fingers."""
    if gripper is None or not gripper.cups:
        return None
    return registry(Grip.plugin_kind).find("suction")()
