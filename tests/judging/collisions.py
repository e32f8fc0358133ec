"""Runs with one more contact, for tests of collisions."""

import numpy as np

from harness.core.geometry import Box
from harness.judging.expectations.collision import Collision
from harness.judging.expectations.never import Never
from tests.judging.synthetic_run import (
    BOX,
    TABLE,
    changed,
    force,
    lift_run,
    make_run,
    thing,
    verdict,
)

NEVER = Never(predicate=Collision())

WALL = thing("wall", Box((0.02, 1, 1)), static=True, pose=(1, 0, 0.5, 1, 0, 0, 0))


def collides(run, spec=NEVER, step_id=""):
    return {"passed": False, "failed": True}[verdict(run, spec, step_id).status]


def touching(a, b, *spans, run=None, value=1.0, **changes):
    """A run with one more contact."""
    base = run or make_run(objects=(TABLE, BOX, WALL), **changes)
    n = len(base.signals.times)
    forces = {**base.signals.contact_forces, (a, b): force(n, *spans, value=value)}
    return changed(base, contact_forces=forces)


def held_down(newton, *, span=(100, 200), run=None, **changes):
    """The box, held at the height of the table, with a force between the two."""
    base = run or lift_run(leave=200, **changes)
    forces = {**base.signals.contact_forces, ("Table", "box"): force(200, (0, 200), value=1.0)}
    forces["Table", "box"][slice(*span)] = newton
    return changed(base, contact_forces=forces)


GRIP = np.tile([0.0, 20.0], (200, 1))
"""Efforts; the gap changes by 2 m a metre: 10 N on each side."""


def carried(*spans, **changes):
    """A box that is held from 0.5 to 1.5 s and touches a shelf below it at some spans."""
    shelf = thing("shelf", Box((0.5, 0.5, 0.02)), static=True)
    run = lift_run(grip=(50, 150), objects=(TABLE, BOX, shelf), **changes)
    forces = {**run.signals.contact_forces, ("box", "shelf"): force(200, *spans, value=1.0)}
    poses = {**run.signals.object_poses, "shelf": shelf_poses(-0.02)}
    return changed(run, contact_forces=forces, object_poses=poses)


def shelf_poses(z):
    poses = np.zeros((200, 7))
    poses[:, 2], poses[:, 3] = z, 1.0
    return poses
