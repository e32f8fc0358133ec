"""Points of the surfaces of shapes, to compare extents with."""

import numpy as np

from harness.core.geometry import Box, Capsule, Cylinder, Sphere


def surface_of(geometry, rng):
    """Points of a shape's surface in its own frame, among them those that matter for its height."""
    round_about = rng.uniform(0, 2 * np.pi, 4000)
    circle = np.stack([np.cos(round_about), np.sin(round_about), 0 * round_about], axis=1)
    up = np.array([0.0, 0.0, 1.0])
    match geometry:
        case Box(size=size):
            return (np.indices((2, 2, 2)).reshape(3, -1).T - 0.5) * size
        case Sphere(radius=radius):
            return radius * unit_vectors(rng, 40000)
        case Cylinder(radius=radius, length=length):
            return np.concatenate([radius * circle + side * length / 2 * up for side in (-1, 1)])
        case Capsule(radius=radius, length=length):
            ball = radius * unit_vectors(rng, 40000)
            return np.concatenate([ball + side * length / 2 * up for side in (-1, 1)])


def unit_vectors(rng, count):
    vectors = rng.normal(size=(count, 3))
    return vectors / np.linalg.norm(vectors, axis=1)[:, None]


GEOMETRIES = (Box((0.1, 0.06, 0.2)), Sphere(0.05), Cylinder(0.05, 0.3), Capsule(0.04, 0.3))
