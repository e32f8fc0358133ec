"""One module per verb; importing this package registers them all."""

from harness.engine.executors import (
    allow_collisions,
    attach_object,
    circ,
    grasp,
    gripper,
    inject,
    lin,
    move_relative,
    move_to,
    objects,
    pick,
    place,
    ptp,
    release,
    waiting,
)

__all__ = [
    "allow_collisions",
    "attach_object",
    "circ",
    "grasp",
    "gripper",
    "inject",
    "lin",
    "move_relative",
    "move_to",
    "objects",
    "pick",
    "place",
    "ptp",
    "release",
    "waiting",
]
