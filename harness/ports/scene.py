"""The planning scene: the planner's belief of robot and objects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.core.world import WorldObject


@dataclass(frozen=True)
class Touch:
    """Two bodies closer than allowed.

    Attributes:
        first: Name of a link or an object.
        distance: Negative for penetration [m].
        required: The smallest distance that is allowed [m].
    """

    first: str
    second: str
    distance: float
    required: float = 0.0


class PlanningScene(Protocol):
    """The planner's belief: robot, objects, attachments, allowed pairs.

    Joint vectors are in description order. Objects of the physics alone are never added here.
    """

    def add_object(self, obj: WorldObject, pose: SE3) -> None:
        """Put an object into the scene, at T_world_object."""
        ...

    def remove_object(self, name: str) -> None:
        """Take an object out of the scene."""
        ...

    def move_object(self, name: str, pose: SE3) -> None:
        """Set T_world_object of an object that is not attached."""
        ...

    def attach_object(
        self, name: str, link: str, touch_links: Sequence[str], joint_positions: FloatArray
    ) -> SE3:
        """Fix an object of the scene to a link where both stand now; returns T_link_object."""
        ...

    def detach_object(self, name: str, joint_positions: FloatArray) -> SE3:
        """Let go of an attached object; it stays in the scene at the returned T_world_object."""
        ...

    def set_allowed(self, pairs: Sequence[tuple[str, str]], *, allowed: bool) -> None:
        """Allow, or check again, collisions of pairs: links, objects, `robot` for all links."""
        ...

    def set_unpadded(self, pairs: Sequence[tuple[str, str]]) -> None:
        """Apply no padding to these pairs of a link and an object, and to no others."""
        ...

    def is_ground(self, name: str) -> bool:
        """Whether an object is solid without end below a plane."""
        ...

    def object_names(self) -> tuple[str, ...]:
        """Objects in the scene, attached ones included, in order of adding."""
        ...

    def attached(self) -> Mapping[str, str]:
        """Link of each attached object."""
        ...

    def object_pose(self, name: str, joint_positions: FloatArray) -> SE3:
        """T_world_object, attached or not."""
        ...

    def touches(self, joint_positions: FloatArray, padding: float = 0.0) -> Sequence[Touch]:
        """Pairs closer than allowed at a state, nearest first."""
        ...

    def corners(self, body: str) -> FloatArray:
        """Corners of the boxes around a body's shapes, in its frame, shape (n, 3) [m]."""
        ...

    def nearest_on_link(self, link: str, point: FloatArray) -> FloatArray:
        """The point of a link's shapes nearest to a point, itself inside, link axes, shape (3,)."""
        ...
