"""Volume and inertia of solids of one density, and which tensors can be a body's inertia."""

from __future__ import annotations

import math

import numpy as np

from harness.core.geometry import Box, Capsule, Cylinder, Geometry, Mesh, Sphere
from harness.core.types import FloatArray

TRIANGLE_SLACK = 1e-3
"""Share of the largest principal moment by which a tensor may violate the triangle inequality:
rounding to four digits causes that much."""


def is_inertia_of_a_body(tensor: FloatArray) -> bool:
    """Whether the principal moments are positive and none exceeds the sum of the others.

    A tensor that violates the inequality by at most `TRIANGLE_SLACK` is accepted; the physics
    raises its two smaller moments.
    """
    least, middle, most = np.linalg.eigvalsh(tensor)
    return bool(least > 0 and most - least - middle <= TRIANGLE_SLACK * most)


def point_inertia(mass: float, offset: FloatArray) -> FloatArray:
    """Inertia of a point mass at an offset (3,) [m]: the term of the parallel axis theorem."""
    return mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))


def volume_of(geometry: Geometry) -> float | None:
    """Volume [m^3], of a mesh that of its hull; None for planes and meshes without one."""
    if isinstance(geometry, Mesh):
        return None if geometry.hull is None else geometry.hull.volume
    solid = solid_of(geometry)
    return None if solid is None else solid[0]


def solid_of(geometry: Geometry) -> tuple[float, FloatArray] | None:
    """Volume [m^3] and inertia at density 1 about the centre [m^5]; None for planes and meshes."""
    match geometry:
        case Box(size=(x, y, z)):
            volume = x * y * z
            return volume, volume / 12 * np.diag([y * y + z * z, x * x + z * z, x * x + y * y])
        case Cylinder(radius=r, length=h):
            volume = math.pi * r * r * h
            side = (3 * r * r + h * h) / 12
            return volume, volume * np.diag([side, side, r * r / 2])
        case Sphere(radius=r):
            volume = 4 / 3 * math.pi * r**3
            return volume, volume * 0.4 * r * r * np.eye(3)
        case Capsule(radius=r, length=h):
            cylinder, ball = math.pi * r * r * h, 4 / 3 * math.pi * r**3
            axial = cylinder * r * r / 2 + ball * 0.4 * r * r
            side = cylinder * (3 * r * r + h * h) / 12
            side += ball * (0.4 * r * r + h * h / 4 + 3 * h * r / 8)
            return cylinder + ball, np.diag([side, side, axial])
        case _:
            return None
