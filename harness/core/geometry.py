"""Shapes of links and objects, as the planner, the physics and the report see them."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from harness.core.spatial import SE3

Rgba = tuple[float, float, float, float]


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
class Mesh:
    """A triangle mesh file (STL, OBJ, DAE); `scale` multiplies its coordinates to metres.

    What touches is its convex hull, for planner and physics alike; when `exact`, the planner takes
    its triangles as they are: a surface.
    """

    path: Path
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    exact: bool = False


Geometry = Box | Cylinder | Sphere | Capsule | Plane | Mesh


@dataclass(frozen=True)
class Friction:
    """Coulomb coefficients of a surface; a contact takes the smaller of its two, as Gazebo's ODE.

    Attributes:
        sliding: Dimensionless.
        torsional: About the contact normal [m].
        rolling: Against rolling [m].
    """

    sliding: float = 1.0
    torsional: float = 0.005
    rolling: float = 0.0001


@dataclass(frozen=True, eq=False)
class Shape:
    """A geometry placed on a body.

    Attributes:
        geometry: What it is.
        pose: T_body_shape.
        rgba: Colour, each 0..1.
        name: Unique on its body where a file names it; else empty.
        friction: Of this shape's surface; None for that of its body.
    """

    geometry: Geometry
    pose: SE3 = field(default_factory=SE3.identity)
    rgba: Rgba = (0.6, 0.6, 0.6, 1.0)
    name: str = ""
    friction: Friction | None = None


def bounding_radius(shape: Shape) -> float:
    """Radius of a sphere about the body's origin that holds the shape [m]; inf for planes."""
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
        case Plane() | Mesh():
            return float("inf")
