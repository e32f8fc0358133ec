"""Which body carries an object from below: by the recorded forces, else by shapes and poses."""

from __future__ import annotations

import numpy as np

from harness.assertions.contacts import TOUCH_FORCE, bodies_touching, debounced
from harness.assertions.poses import object_poses
from harness.assertions.window import NotObservable, object_record
from harness.core.geometry import reach
from harness.core.pose_arrays import rotate
from harness.core.types import BoolArray, FloatArray
from harness.recording.run import ObjectRecord, Run

SINKING = 0.005
"""How far a soft contact may let an object sink, and still be above [m]."""


def lowest_points(record: ObjectRecord, poses: FloatArray) -> FloatArray:
    """Height of an object's lowest point [m], shape (N,); of its origin where a shape is a mesh."""
    lowest = [poses[:, 2]] if not record.shapes else []
    for shape in record.shapes:
        centre = poses[:, 2] + rotate(poses[:, 3:], shape.pose.translation)[:, 2]
        vertical = np.stack(  # height of the shape's axes
            [rotate(poses[:, 3:], shape.pose.rotation[:, axis])[:, 2] for axis in range(3)], axis=1
        )
        below = reach(shape.geometry, vertical)
        lowest.append(centre if below is None else centre - below)
    return np.min(lowest, axis=0)


def is_below(run: Run, support: str, name: str) -> BoolArray:
    """Samples at which a shape of `support` has its centre under the object's lowest point.

    A wall that the object leans on is taller than that; a slab, a plane, a lower box are not.
    """
    lowest = lowest_points(object_record(run, name), object_poses(run, name))
    try:
        record, poses = object_record(run, support), object_poses(run, support)
    except NotObservable:
        return np.zeros(len(lowest), dtype=bool)
    centres = [
        poses[:, 2] + rotate(poses[:, 3:], shape.pose.translation)[:, 2] for shape in record.shapes
    ] or [poses[:, 2]]
    return np.min(centres, axis=0) <= lowest + SINKING


def rides_on(run: Run, rider: str, carrier: str) -> BoolArray:
    """Samples at which a free object lies on another and touches nothing else, shape (N,)."""
    free = [each.name for each in run.objects if not each.is_static and each.in_simulation]
    if rider not in free:
        return np.zeros(len(run.signals.times), dtype=bool)
    alone = np.ones(len(run.signals.times), dtype=bool)
    for force in bodies_touching(run, rider, but={carrier}).values():
        alone &= force <= TOUCH_FORCE  # not where it is unknown
    return alone & is_below(run, carrier, rider)


def supports(run: Run, name: str) -> dict[str, FloatArray]:
    """Debounced upward force [N] of each body but the robot that carries the object from below.

    Where no direction was recorded, the whole force of a body that is below counts.
    """
    links = set(run.robot.link_names)
    carrying: dict[str, FloatArray] = {}
    for body, force in bodies_touching(run, name, but=links).items():
        upward = _upward(run, body, name)
        if upward is None:
            carrying[body] = np.where(is_below(run, body, name), force, 0.0)
        else:  # no part of a force is more than it is, and unknown where it is
            carrying[body] = np.minimum(debounced(run, upward), force)
    return carrying


def _upward(run: Run, body: str, name: str) -> FloatArray | None:
    """Upward force of a body on an object [N]; None where it was not recorded."""
    recorded = run.signals.support_forces
    if (body, name) in recorded:
        return np.maximum(recorded[body, name], 0.0)
    if (name, body) in recorded:
        return np.maximum(-recorded[name, body], 0.0)
    return None
