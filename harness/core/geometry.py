"""Shapes of links and objects, for the planner, the physics and the report."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray

Rgba = tuple[float, float, float, float]

CollisionMode = Literal["hull", "parts", "exact"]  # hull, convex parts, or a planner's triangles


@dataclass(frozen=True)
class Box:
    """A box centred on its frame; `size` is the full size along x, y, z [m]."""

    size: tuple[float, float, float]


@dataclass(frozen=True)
class Cylinder:
    """A cylinder about the local z axis, centred [m]."""

    radius: float
    length: float


@dataclass(frozen=True)
class Sphere:
    """A sphere [m]."""

    radius: float


@dataclass(frozen=True)
class Capsule:
    """A cylinder of `length` about the local z axis with a half sphere on each end [m]."""

    radius: float
    length: float


@dataclass(frozen=True)
class Plane:
    """The half space below local z = 0."""


@dataclass(frozen=True)
class Hull:
    """The convex hull of a mesh, or of one of its convex parts, in the mesh's frame.

    Attributes:
        corners: The corners, in any order [m].
        volume: The volume that it encloses [m^3].
        centroid: The centre of the volume [m].
        thickness: The least distance of a face from the corner farthest from it [m].
    """

    corners: tuple[tuple[float, float, float], ...]
    volume: float
    centroid: tuple[float, float, float]
    thickness: float


@dataclass(frozen=True)
class Mesh:
    """A triangle mesh file (STL, OBJ, DAE, PLY, GLB), its convex hull, or one of its convex parts.

    Planner and physics both collide with the hull or the part. With the collision mode `exact`, the
    planner collides with the triangles, which are a surface, and the physics with the parts.

    Attributes:
        scale: The factors from its coordinates to metres.
        collision: How it collides; None before that is decided, and for what is only seen.
        part: The number of the convex part; None for the whole mesh.
        hull: Its convex hull; None for links, for what is only seen, and in older runs.
    """

    path: Path
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    collision: CollisionMode | None = None
    part: int | None = None
    hull: Hull | None = field(default=None, compare=False, repr=False)


Geometry = Box | Cylinder | Sphere | Capsule | Plane | Mesh


@dataclass(frozen=True)
class Friction:
    """Coulomb coefficients of a surface. A contact uses the smaller of its two, as Gazebo's ODE.

    Attributes:
        sliding: The sliding friction coefficient, dimensionless.
        torsional: Friction about the contact normal [m].
        rolling: The rolling friction coefficient [m].
    """

    sliding: float = 1.0
    torsional: float = 0.005
    rolling: float = 0.0001


@dataclass(frozen=True, eq=False)
class Shape:
    """A geometry placed on a body.

    Attributes:
        pose: The pose T_body_shape of the shape.
        rgba: Colour, each channel 0 to 1.
        name: Name from the file, unique on the body; else empty.
        friction: Friction of this shape's surface; None for the body's friction.
    """

    geometry: Geometry
    pose: SE3 = field(default_factory=SE3.identity)
    rgba: Rgba = (0.6, 0.6, 0.6, 1.0)
    name: str = ""
    friction: Friction | None = None


def reach(geometry: Geometry, directions: FloatArray) -> FloatArray | None:
    """How far a shape reaches from its origin along directions [m], shape (N,).

    Args:
        geometry: The shape; of planes and of meshes without a hull the result is None.
        directions: Unit vectors in the shape's frame, shape (N, 3).
    """
    along = np.abs(directions)
    match geometry:
        case Box(size=size):
            return along @ (0.5 * np.array(size))
        case Cylinder(radius=radius, length=length):
            across = np.sqrt(np.maximum(0.0, 1 - along[:, 2] ** 2))
            return 0.5 * length * along[:, 2] + radius * across
        case Sphere(radius=radius):
            return np.full(len(along), radius)
        case Capsule(radius=radius, length=length):
            return 0.5 * length * along[:, 2] + radius
        case Mesh(hull=Hull(corners=corners)):
            farthest = np.full(len(directions), -np.inf)
            for corner in corners:  # one after the other: N times hundreds would be much memory
                np.maximum(farthest, directions @ np.array(corner), out=farthest)
            return farthest
        case Plane() | Mesh():
            return None


def bounds_of(shapes: Iterable[Shape]) -> tuple[FloatArray, FloatArray] | None:
    """Lower and upper corner of the box along a body's axes that holds shapes [m], (3,) each.

    None without shapes, and where one reaches an unknown distance, as a plane does.
    """
    lows: list[FloatArray] = []
    highs: list[FloatArray] = []
    for shape in shapes:
        below = reach(shape.geometry, -shape.pose.rotation)
        above = reach(shape.geometry, shape.pose.rotation)
        if below is None or above is None:
            return None
        lows.append(shape.pose.translation - below)
        highs.append(shape.pose.translation + above)
    return (np.min(lows, axis=0), np.max(highs, axis=0)) if lows else None


def center_of(shape: Shape) -> FloatArray:
    """The centre of a shape's volume in the body's frame [m], shape (3,)."""
    match shape.geometry:
        case Mesh(hull=Hull(centroid=centroid)):
            return shape.pose.apply(np.array(centroid))
        case _:
            return shape.pose.translation


def bounding_radius(shape: Shape) -> float:
    """Radius of the bounding sphere about the body's origin [m]; inf where `reach` is None."""
    offset = float(np.linalg.norm(shape.pose.translation))
    match shape.geometry:
        case Box(size=size):
            return offset + 0.5 * float(np.linalg.norm(size))
        case Cylinder(radius=radius, length=length):
            return offset + float(np.hypot(radius, 0.5 * length))
        case Sphere(radius=radius):
            return offset + radius
        case Capsule(radius=radius, length=length):
            return offset + radius + 0.5 * length
        case Mesh(hull=Hull(corners=corners)):
            return float(np.linalg.norm(shape.pose.apply(np.array(corners)), axis=1).max())
        case Plane() | Mesh():
            return float("inf")


def undivided(shapes: Iterable[Shape]) -> tuple[Shape, ...]:
    """The shapes, with the mesh in place of its convex parts; for pictures and files."""
    whole: list[Shape] = []
    for shape in shapes:
        if isinstance(shape.geometry, Mesh) and shape.geometry.part is not None:
            if shape.geometry.part == 0:
                whole.append(replace(shape, geometry=replace(shape.geometry, part=None, hull=None)))
        else:
            whole.append(shape)
    return tuple(whole)
