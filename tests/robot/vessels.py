"""Mesh files of cups and bins, which a convex hull would fill."""

from pathlib import Path

import numpy as np


def vessel(sides=32, outer=0.04, inner=0.034, height=0.08, floor=0.006):
    """Vertices and triangles of a cup; of a square bin with four sides.

    It stands on z = 0. With four sides, `outer` and `inner` are distances of the corners.
    """
    turns = 2 * np.pi * (np.arange(sides) + 0.5) / sides
    ring = np.column_stack([np.cos(turns), np.sin(turns)])
    profile = [(outer, 0.0), (outer, height), (inner, height), (inner, floor)]
    rings = [np.column_stack([radius * ring, np.full(sides, z)]) for radius, z in profile]
    vertices = np.concatenate([*rings, [[0, 0, floor], [0, 0, 0]]])
    faces = []
    for level in range(3):
        for side in range(sides):
            a, b = level * sides + side, level * sides + (side + 1) % sides
            faces += [(a, b, b + sides), (a, b + sides, a + sides)]
    top, bottom = 4 * sides, 4 * sides + 1
    for side in range(sides):
        after = (side + 1) % sides
        faces += [(3 * sides + side, 3 * sides + after, top), (after, side, bottom)]
    return vertices, np.array(faces)


def triangles_of(vertices, faces):
    return vertices[faces]


def write_obj(path: Path, vertices, faces) -> Path:
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices]
    lines += ["f " + " ".join(str(corner + 1) for corner in face) for face in faces]
    path.write_text("\n".join(lines) + "\n")
    return path
