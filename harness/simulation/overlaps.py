"""Bodies that are inside each other: the physics pushes them apart as fast as it can."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import mujoco

from harness.ports import Touch
from harness.simulation.model import PhysicsModel

SMALLEST_OVERLAP = 1e-4
"""Depth above which two bodies overlap; less is how things rest on each other [m]."""


def overlaps(physics: PhysicsModel, data: mujoco.MjData) -> tuple[Touch, ...]:
    """Pairs of an object and another body that overlap in the present state, deepest first.

    Args:
        physics: The model.
        data: Its state, with contacts up to date.
    """
    names, robot = physics.body_names, physics.robot_bodies
    deepest: dict[tuple[str, str], float] = {}
    bodies = physics.model.geom_bodyid[data.contact.geom].tolist()
    for (first, second), distance in zip(bodies, data.contact.dist.tolist(), strict=True):
        if distance > -SMALLEST_OVERLAP or (first in robot and second in robot):
            continue
        pair = sorted((first, second), key=lambda body: (body not in robot, names[body]))
        key = names[pair[0]], names[pair[1]]
        deepest[key] = min(distance, deepest.get(key, 0.0))
    found = [Touch(*pair, distance) for pair, distance in deepest.items()]
    return tuple(sorted(found, key=lambda touch: (touch.distance, touch.first, touch.second)))
