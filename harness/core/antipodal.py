"""Whether two finger sides press an object against each other: by direction and by place."""

from __future__ import annotations

import math

import numpy as np

from harness.core.geometry import Box, Capsule, Cylinder, Geometry, Hull, Mesh, Shape, Sphere
from harness.core.types import BoolArray, FloatArray

GIVE = 0.003  # [m], by which pads and object may press into each other, and points be off
LEAST_SHARE = math.cos(math.pi / 4)  # of a thickness, between places at the edge of the cones


def is_antipodal(first: FloatArray, second: FloatArray, thickness: float) -> BoolArray:
    """Samples at which two sides press from opposite sides of an object, shape (N,).

    Two forces hold an object between them only if both lie in the cones of friction around the
    normals (Coulomb). With coefficients of at most 1 a cone is 45 degrees to either side, so the
    normals are more than 90 degrees apart. Along the line in which they press, the places are as
    far from each other as the object is thick: closed fingertips on a larger box are not. A ball
    that is gripped above its middle, at the edge of the cones, gives cos 45 degrees of that.

    Args:
        first: Contact point (world) [m] and normal force on the object [N] of a side, (N, 6).
        second: The same of the other side.
    """
    is_thick = distance_pressed(first, second) + GIVE >= LEAST_SHARE * thickness
    return is_opposite(first, second) & is_thick


def is_opposite(first: FloatArray, second: FloatArray) -> BoolArray:
    """Samples at which two normal forces are more than 90 degrees apart, shape (N,)."""
    return np.sum(first[:, 3:] * second[:, 3:], axis=1) < 0


def distance_pressed(first: FloatArray, second: FloatArray) -> FloatArray:
    """Distance of two contact points along the line in which they press [m], shape (N,).

    It does not matter whether they press from outside, or from inside a ring.
    """
    along = first[:, 3:] - second[:, 3:]
    length = np.linalg.norm(along, axis=1)
    apart = np.abs(np.sum((second[:, :3] - first[:, :3]) * along, axis=1))
    return np.divide(apart, length, out=np.zeros(len(length)), where=length > 0)


def force_between_sides(first: FloatArray, second: FloatArray) -> FloatArray:
    """Force with which two sides press against each other, mean of both [N], shape (N,).

    It is the part along the line in which they press.
    """
    return 0.5 * np.linalg.norm(first[:, 3:] - second[:, 3:], axis=1)


def combined_press(presses: list[FloatArray]) -> FloatArray:
    """Contact point and normal force of several links together, (N, 6); zero without force."""
    filled = [np.nan_to_num(press) for press in presses]
    weights = [np.linalg.norm(press[:, 3:], axis=1, keepdims=True) for press in filled]
    total = np.sum(weights, axis=0)
    places = np.sum([w * p[:, :3] for w, p in zip(weights, filled, strict=True)], axis=0)
    place = np.divide(places, total, out=np.zeros_like(places), where=total > 0)
    return np.hstack([place, np.sum([press[:, 3:] for press in filled], axis=0)])


def least_thickness(shapes: tuple[Shape, ...]) -> float:
    """Thickness of the thinnest shape [m]; 0 where that is not known, as of triangles."""
    return min((_thickness(shape.geometry) for shape in shapes), default=0.0)


def _thickness(geometry: Geometry) -> float:
    match geometry:
        case Box(size=size):
            return min(size)
        case Cylinder(radius=radius, length=length):
            return min(2 * radius, length)
        case Sphere(radius=radius) | Capsule(radius=radius):
            return 2 * radius
        case Mesh(collision="hull" | "parts", hull=Hull(thickness=thickness)):
            return thickness
        case _:
            return 0.0
