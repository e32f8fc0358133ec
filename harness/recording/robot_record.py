"""The robot as a run needs it: joints with limits, links, meshes, the gripper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from harness.core.geometry import Rgba, Shape
from harness.core.types import FloatArray, Floats, IntArray


@dataclass(frozen=True)
class JointRecord:
    """Limits of a movable joint, as verdicts and plots need them (SI; inf where there is none)."""

    name: str
    kind: str
    lower: float
    upper: float
    velocity: float
    acceleration: float
    effort: float
    is_mimic: bool = False

    @property
    def position_unit(self) -> Literal["m", "rad"]:
        """The unit of its position: `rad` or `m`."""
        return "m" if self.kind == "prismatic" else "rad"


@dataclass(frozen=True)
class GripperRecord:
    """Which links make up the finger sides, and the joint that closes them.

    Attributes:
        sides: Links of each finger side, by side name.
        widths: Rows (joint position, gap between the pads [m]).
        palm_link: The link that carries the fingers; empty if unknown.
    """

    group: str
    joint: str
    sides: Mapping[str, tuple[str, ...]]
    open_position: float
    closed_position: float
    widths: tuple[tuple[float, float], ...] = ()
    palm_link: str = ""


@dataclass(frozen=True)
class LinkPlacement:
    """How a link hangs on its parent link.

    Attributes:
        pose: T_parent_link with its joint at zero (xyz, quat wxyz).
        joint: The joint that moves it; empty when it is fixed.
        slides: Whether that joint slides along the axis; else it turns about it.
        axis: Unit vector in the link's frame.
    """

    link: str
    parent: str
    pose: Floats
    joint: str = ""
    slides: bool = False
    axis: Floats = (0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class MeshRecord:
    """Triangles of one colour of a mesh file that links or objects look like.

    Attributes:
        path: The path of the file, as `Shape.geometry` names it; it need not be there any more.
        scale: The scale of `Shape.geometry`; the vertices are scaled already.
        vertices: The vertices, shape (V, 3) [m].
        faces: Indices of vertices, shape (F, 3).
        rgba: None where the file gives no colour: the shape's.
    """

    path: Path
    scale: tuple[float, float, float]
    vertices: FloatArray
    faces: IntArray
    rgba: Rgba | None = None


@dataclass(frozen=True)
class RobotRecord:
    """The robot as the run needs it.

    Attributes:
        joints: Movable joints in description order: the columns of the joint signals.
        groups: Joint names of each planning group.
        named_states: Group -> state -> joint -> position.
        static_links: Links that cannot move; they are no clearance finding against static objects.
        link_visuals: Shapes for pictures, by link.
        static_link_poses: T_world_link of `static_links` (xyz, quat wxyz).
        placements: Every link but the root, parents first.
        shapeless_links: Links that a joint moves and that nothing can touch.
    """

    name: str
    joints: tuple[JointRecord, ...]
    groups: Mapping[str, tuple[str, ...]]
    named_states: Mapping[str, Mapping[str, Mapping[str, float]]]
    arm_group: str
    tcp_link: str
    base_link: str
    link_names: tuple[str, ...]
    static_links: tuple[str, ...]
    gripper: GripperRecord | None = None
    link_visuals: Mapping[str, tuple[Shape, ...]] = field(
        default_factory=dict[str, tuple[Shape, ...]]
    )
    urdf: str = ""
    srdf: str = ""
    static_link_poses: Mapping[str, tuple[float, ...]] = field(
        default_factory=dict[str, tuple[float, ...]]
    )
    placements: tuple[LinkPlacement, ...] = ()
    shapeless_links: tuple[str, ...] = ()

    @property
    def arm_joints(self) -> tuple[str, ...]:
        """Joints of the arm; every movable joint where the robot is a gripper alone."""
        return self.groups.get(self.arm_group) or tuple(joint.name for joint in self.joints)
