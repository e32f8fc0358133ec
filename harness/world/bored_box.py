"""A box with a hole, composed of boxes around the hole, so that nothing fills it."""

from __future__ import annotations

import math
from dataclasses import replace

from harness.core.geometry import Box, Shape
from harness.core.hole import Hole
from harness.core.spatial import SE3
from harness.language.holes import RING, HoleSpec

Rectangle = tuple[float, float, float, float]  # centre x, y and full size along x, y [m]


def bored(whole: Shape, spec: HoleSpec) -> tuple[tuple[Shape, ...], Hole]:
    """The boxes of a box with a hole from its upper face, and the hole.

    Four boxes surround a rectangle; around a circle turned boxes, whose faces touch it, cut the
    corners of its square to a regular polygon. A floor closes a hole that does not go through.
    """
    assert isinstance(whole.geometry, Box)
    width, length, height = whole.geometry.size
    depth = min(spec.depth or height, height)
    (x, y), (across, along) = spec.at, spec.widths
    middle = (height - depth) / 2

    def part(rectangle: Rectangle, turn: float = 0.0) -> Shape:
        pose = whole.pose @ SE3.from_xyz_rpy((*rectangle[:2], middle), (0, 0, turn))
        return replace(whole, geometry=Box((*rectangle[2:], depth)), pose=pose)

    left, right = x - across / 2 + width / 2, width / 2 - x - across / 2
    back, front = y - along / 2 + length / 2, length / 2 - y - along / 2
    parts = [
        part(((left - width) / 2, 0.0, left, length)),
        part(((width - right) / 2, 0.0, right, length)),
        part((x, (back - length) / 2, across, back)),
        part((x, (length - front) / 2, across, front)),
    ]
    if spec.diameter is not None:
        radius, thick = spec.diameter / 2, RING * spec.diameter / 2
        side = 2 * (radius + thick) * math.tan(math.pi / spec.sides)
        for number in range(spec.sides):
            if number % (spec.sides // 4):  # the four others are faces of the boxes around
                angle = 2 * math.pi * number / spec.sides
                out = radius + thick / 2
                place = (x + out * math.cos(angle), y + out * math.sin(angle), thick, side)
                parts.append(part(place, angle))
    if depth < height:
        floor = whole.pose @ SE3.from_xyz_rpy((0.0, 0.0, -depth / 2))
        parts.append(replace(whole, geometry=Box((width, length, height - depth)), pose=floor))
    opening = whole.pose @ SE3.from_xyz_rpy((x, y, height / 2))
    pose = tuple(map(float, opening.as_vector()))
    return tuple(parts), Hole(pose, (across, along), depth, spec.diameter is not None)
