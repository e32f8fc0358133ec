"""Links and joints of a robot, and what follows from them alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from harness.core.geometry import Shape
from harness.core.kinematics import LinkJoint, LinkPoses
from harness.core.spatial import SE3
from harness.core.types import FloatArray

WORLD = "world"
"""Name of the root link of every composed robot, in which poses are in world coordinates."""

BODY_MASS = 0.01
"""Least mass of a link that is a body where it is not drawn [kg]; frames have grams."""


@dataclass(frozen=True, eq=False)
class Inertial:
    """Mass properties of a link.

    Attributes:
        mass: The mass in kilograms [kg].
        center_of_mass: Centre of mass in the link frame [m], shape (3,).
        inertia: Inertia about the centre of mass, in link axes [kg m^2], shape (3, 3).
        stated_moments: The principal moments in the file, ascending, where no body has these
            [kg m^2], shape (3,); `inertia` is corrected then.
    """

    mass: float
    center_of_mass: FloatArray
    inertia: FloatArray
    stated_moments: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class Link:
    """A rigid body of the robot; `inertial` is None for a pure frame."""

    name: str
    inertial: Inertial | None
    visuals: tuple[Shape, ...] = ()
    collisions: tuple[Shape, ...] = ()


@dataclass(frozen=True)
class Mimic:
    """`value = multiplier * joint + offset`, as in URDF."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, eq=False)
class Joint(LinkJoint):
    """A joint and its limits; rad, rad/s, N m for turning joints, m, m/s, N for prismatic ones.

    Attributes:
        upper: Upper position limit; inf when continuous.
        is_velocity_assumed: Whether no file has the velocity limit.
        acceleration: Acceleration limit (robot.yaml, as MoveIt's joint_limits.yaml).
        effort: Effort limit from a data sheet.
        mimic: The relation to the joint that this joint mimics; None for a driven joint.
    """

    lower: float = -np.inf
    upper: float = np.inf
    velocity: float = np.inf
    acceleration: float = 5.0
    effort: float = np.inf
    effort_source: str = ""
    damping: float = 0.0
    friction: float = 0.0
    mimic: Mimic | None = None
    is_velocity_assumed: bool = False

    @property
    def is_mimic(self) -> bool:
        """Whether it follows another joint."""
        return self.mimic is not None

    @property
    def position_unit(self) -> Literal["m", "rad"]:
        """The unit of its position: `rad` or `m`."""
        return "m" if self.kind == "prismatic" else "rad"


def fixed_joint(name: str, parent: str, child: str, pose: SE3) -> Joint:
    """A fixed joint at T_parent_joint."""
    return Joint(name, "fixed", parent, child, pose, np.array([1.0, 0.0, 0.0]))


@dataclass(frozen=True, eq=False)
class Mechanism:
    """Links and joints, whose root is the link `world`.

    Joint vectors "in description order" have one entry per movable joint, mimic joints included,
    in the order of `joint_names`.

    Attributes:
        links: `world` first, then parents before children.
        joints: The joints, in the order of their child links.
    """

    links: tuple[Link, ...]
    joints: tuple[Joint, ...]

    @cached_property
    def movable_joints(self) -> tuple[Joint, ...]:
        """Joints that have a position, mimic joints included."""
        return tuple(joint for joint in self.joints if joint.is_movable)

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """Names of `movable_joints`: description order."""
        return tuple(joint.name for joint in self.movable_joints)

    @cached_property
    def joint_index(self) -> Mapping[str, int]:
        """Index of each movable joint in description order."""
        return {name: index for index, name in enumerate(self.joint_names)}

    @cached_property
    def link_names(self) -> tuple[str, ...]:
        """Names of `links`, `world` included."""
        return tuple(link.name for link in self.links)

    @cached_property
    def joint_by_name(self) -> Mapping[str, Joint]:
        """All joints, fixed ones included."""
        return {joint.name: joint for joint in self.joints}

    @cached_property
    def static_links(self) -> frozenset[str]:
        """Links that no movable joint separates from the world: they never move."""
        static = {"world"}
        for joint in self.joints:
            if joint.kind == "fixed" and joint.parent in static:
                static.add(joint.child)
        return frozenset(static)

    @cached_property
    def link_visuals(self) -> Mapping[str, tuple[Shape, ...]]:
        """Shapes for pictures, by link, of the links that have some."""
        return {link.name: link.visuals for link in self.links if link.visuals}

    @cached_property
    def shapeless_links(self) -> tuple[str, ...]:
        """Links that a joint moves and that nothing can touch.

        Neither they nor what is fixed to them has collision shapes, though they are drawn or have a
        mass of `BODY_MASS`: no frames.
        """
        moved_by: dict[str, str] = {}  # link -> the link that the last movable joint moves
        for joint in self.joints:
            first = joint.child if joint.is_movable else moved_by.get(joint.parent, "")
            moved_by[joint.child] = first
        links = [link for link in self.links if moved_by.get(link.name)]
        solid = {moved_by[link.name] for link in links if link.collisions}
        bodies = {
            moved_by[link.name]
            for link in links
            if link.visuals or (link.inertial is not None and link.inertial.mass >= BODY_MASS)
        }
        return tuple(name for name in self.link_names if name in bodies - solid)

    def with_mimics(self, joint_positions: FloatArray) -> FloatArray:
        """The same positions with every mimic joint set from the joint it follows."""
        positions = np.array(joint_positions, dtype=float)
        for index, joint in enumerate(self.movable_joints):
            if joint.mimic is not None:
                followed = positions[self.joint_index[joint.mimic.joint]]
                positions[index] = joint.mimic.multiplier * followed + joint.mimic.offset
        return positions

    def link_poses(self, joint_positions: FloatArray) -> dict[str, SE3]:
        """T_world_link of every link at joint positions in description order, shape (n,)."""
        return LinkPoses(self.joints, joint_positions).at(0)
