"""Seven families of things around an arm, drawn by a seeded generator; lengths for a UR5e."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from harness.core.geometry import Box, Cylinder, Shape
from harness.core.spatial import SE3

DOWN = (np.pi, 0.0, 0.0)
AHEAD = (0.0, np.pi / 2, 0.0)


@dataclass(frozen=True)
class Layout:
    """Boards, bars and things around an arm, and poses of the flange to go between."""

    shapes: list[Shape]
    goals: list[SE3]


def at(xyz, rpy=(0.0, 0.0, 0.0)) -> SE3:
    return SE3.from_xyz_rpy(np.asarray(xyz, float), rpy)


def box(size, xyz, rpy=(0.0, 0.0, 0.0)) -> Shape:
    return Shape(Box(tuple(float(side) for side in size)), at(xyz, rpy))


def can(radius, length, xyz) -> Shape:
    return Shape(Cylinder(float(radius), float(length)), at(xyz))


def shelf(gaps: tuple[float, ...], width: float, depth: float):
    """A shelf in front of the arm; from one of its boards to another."""

    def layout(rng: np.random.Generator, s: float) -> Layout:
        x = s * rng.uniform(0.62, 0.72)
        y, turn = s * rng.uniform(-0.15, 0.15), rng.uniform(-0.2, 0.2)
        place = at((x, y, s * rng.uniform(0.05, 0.2)), (0, 0, turn))
        shapes, goals, height, board = [], [], 0.0, 0.02 * s
        opens = [max(s * gap, 0.2) for gap in gaps]  # the gripper is as large on both arms
        total = sum(opens) + board * (len(opens) + 1)
        shapes += [
            box((s * depth, board, total), (s * depth / 2, side * s * width / 2, total / 2))
            for side in (-1, 1)
        ]
        shapes.append(box((board, s * width, total), (s * depth, 0, total / 2)))
        for gap in (*opens, None):
            shapes.append(box((s * depth, s * width, board), (s * depth / 2, 0, height)))
            if gap is not None:
                across = s * rng.uniform(-0.25, 0.25) * width
                roll = at((0, 0, 0), (0, 0, rng.choice([0.0, np.pi / 2])))
                front = at((-0.05 * s - 0.02, across, height + gap / 2))
                goals.append(place @ front @ at((0, 0, 0), AHEAD) @ roll)
                other = -np.sign(across or 1.0) * s * 0.3 * width
                tall = gap * rng.uniform(0.4, 0.8)
                shapes.append(can(0.04 * s, tall, (s * depth * 0.6, other, height + tall / 2)))
                height += gap + board
        return Layout([Shape(p.geometry, place @ p.pose) for p in shapes], goals)

    return layout


def open_box(rng: np.random.Generator, s: float) -> Layout:
    """A box that is open at the top, with things in it; down into it from one side."""
    x, y, turn = s * rng.uniform(0.5, 0.6), s * rng.uniform(-0.2, 0.2), rng.uniform(-0.5, 0.5)
    length, width, height, wall = (s * v for v in (0.4, 0.3, 0.28, 0.015))
    place = at((x, y, 0.02), (0, 0, turn))
    shapes = [box((length, width, wall), (0, 0, 0))]
    for side in (-1, 1):
        shapes.append(box((wall, width, height), (side * length / 2, 0, height / 2)))
        shapes.append(box((length, wall, height), (0, side * width / 2, height / 2)))
    shapes.append(can(0.03 * s, 0.1 * s, (0.12 * s, 0.06 * s, 0.06 * s)))
    goal = place @ at((s * rng.uniform(-0.08, 0.0), 0, 0.24 * s + 0.1), DOWN)
    at_the_side = at((x * 0.3, y + s * 0.55, 0.3 * s + 0.1), DOWN)
    return Layout([Shape(p.geometry, place @ p.pose) for p in shapes], [goal, at_the_side])


def cage(rng: np.random.Generator, s: float) -> Layout:
    """Bars around a thing; in between two of them, out, and in on another side."""
    x, y, turn = s * rng.uniform(0.62, 0.7), s * rng.uniform(-0.1, 0.1), rng.uniform(-0.3, 0.3)
    side, height, bar = 0.38 * s, 0.5 * s, 0.02 * s
    place = at((x, y, 0.03), (0, 0, turn))
    shapes = []
    for level in (0.0, 0.5, 1.0):
        for end in (-1, 1):
            shapes.append(box((side, bar, bar), (0, end * side / 2, level * height)))
            shapes.append(box((bar, side, bar), (end * side / 2, 0, level * height)))
    for u in (-1, 1):
        for v in (-1, 1):
            shapes.append(box((bar, bar, height), (u * side / 2, v * side / 2, height / 2)))
    shapes.append(can(0.04 * s, 0.16 * s, (0, 0, 0.08 * s)))
    inside = place @ at((-side / 2 - 0.02 * s, 0.03 * s, 0.72 * height)) @ at((0, 0, 0), AHEAD)
    above = place @ at((0.03 * s, 0, 0.45 * s + 0.13), DOWN)
    aside = [
        place
        @ at((-0.02 * s, end * (side / 2 + 0.02 * s), 0.72 * height), (0, 0, -end * np.pi / 2))
        @ at((0, 0, 0), AHEAD)
        for end in (-1, 1)
    ]
    return Layout([Shape(p.geometry, place @ p.pose) for p in shapes], [inside, above, *aside])


def clutter(rng: np.random.Generator, s: float, count: int, height: float) -> list[Shape]:
    """Cans and boxes on a table."""
    found = []
    for number in range(count):
        angle, far = rng.uniform(-1.2, 1.2), s * rng.uniform(0.4, 0.75)
        tall = s * rng.uniform(0.12, 0.32)
        xyz = (far * np.cos(angle), far * np.sin(angle), height + tall / 2)
        wide = s * rng.uniform(0.06, 0.11)
        turn = (0.0, 0.0, float(rng.uniform(0, 3)))
        found.append(can(wide / 2, tall, xyz) if number % 2 else box((wide, wide, tall), xyz, turn))
    return found


def table_pick(rng: np.random.Generator, s: float) -> Layout:
    """A table full of things; from between them to between others."""
    shapes = [box((1.2 * s, 1.6 * s, 0.04), (0.75 * s, 0, -0.03)), *clutter(rng, s, 14, 0.0)]
    goals = []
    for sign in (-1, 1):
        angle, far = sign * rng.uniform(0.3, 1.0), s * rng.uniform(0.42, 0.62)
        xyz = (far * np.cos(angle), far * np.sin(angle), 0.06 * s + 0.17)
        goals.append(at(xyz, (np.pi, 0, float(rng.uniform(-1.5, 1.5)))))
    return Layout(shapes, goals)


def under_table(rng: np.random.Generator, s: float) -> Layout:
    """A table top next to the arm, on legs; from above it to below it."""
    x, y = s * rng.uniform(0.62, 0.7) + 0.2 * (1 - s), s * rng.uniform(-0.1, 0.1)
    high = max(s * rng.uniform(0.4, 0.5), 0.3)
    shapes = [box((0.5 * s, 0.9 * s, 0.03 * s), (x, y, high))]
    for u in (-1, 1):
        for v in (-1, 1):
            shapes.append(
                box((0.04 * s, 0.04 * s, high), (x + u * 0.22 * s, y + v * 0.42 * s, high / 2))
            )
    shapes += [can(0.04 * s, 0.15 * s, (x + 0.1 * s, y + v * 0.2 * s, 0.075 * s)) for v in (-1, 1)]
    shapes += [can(0.04 * s, 0.15 * s, (x, y + 0.2 * s, high + 0.09 * s))]
    below = at((x - 0.28 * s, y, high * 0.5)) @ at((0, 0, 0), AHEAD)
    above = at((x - 0.28 * s, y - 0.15 * s, high + 0.13)) @ at((0, 0, 0), AHEAD)
    return Layout(shapes, [below, above])


FAMILIES: dict[str, Callable[[np.random.Generator, float], Layout]] = {
    "shelf small": shelf((0.28, 0.28), 0.7, 0.3),
    "shelf tall": shelf((0.34, 0.34), 0.9, 0.35),
    "shelf thin": shelf((0.24, 0.24, 0.24), 0.5, 0.25),
    "box": open_box,
    "cage": cage,
    "table pick": table_pick,
    "under table": under_table,
}
