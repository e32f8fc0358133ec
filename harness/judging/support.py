"""Which body carries an object from below, and what the whole stack stands on.

By the recorded forces; where they have no direction, by shapes and poses.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from harness.core.geometry import center_of
from harness.core.pose_arrays import rotate
from harness.core.types import BoolArray, FloatArray
from harness.judging.body_motion import lowest_points
from harness.judging.contacts import (
    DEBOUNCE,
    TOUCH_FORCE,
    bodies_touching,
    force_between,
    touched,
)
from harness.judging.facts import fact
from harness.judging.hands import every_hand_link
from harness.judging.hold import gripped, weight_of
from harness.judging.poses import object_poses
from harness.judging.temporal import without_gaps
from harness.judging.window import NotObservable, object_record
from harness.recording.run import Run

SINKING = 0.005  # how far a soft contact may let an object sink, and still be above [m]
SUPPORT_SHARE = 0.5  # share of its weight with which something rests on what carries it
ROUNDING = 0.01  # missing part of that share: a solver's forces of equal supports differ


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
        poses[:, 2] + rotate(poses[:, 3:], center_of(shape))[:, 2] for shape in record.shapes
    ] or [poses[:, 2]]
    return np.min(centres, axis=0) <= lowest + SINKING


@fact
def riders(run: Run, carrier: str) -> dict[str, BoolArray]:
    """Samples at which free objects ride on another, by their names, shape (N,) each.

    Riders are a group that touches nothing but itself, the carrier and the hand, in which something
    pushes each of them up, at last the carrier: a stack, what hangs on it, or loads that lean on
    each other.
    """
    free = {each.name for each in run.objects if not each.is_static and each.in_simulation}
    hand = every_hand_link(run)
    group, touching = _connected(run, carrier, free), dict[str, dict[str, BoolArray]]()
    for name in group:
        forces = bodies_touching(run, name, but=hand)
        touching[name] = {body: ~(force <= TOUCH_FORCE) for body, force in forces.items()}
    count = len(run.signals.times)
    alone = {name: np.ones(count, dtype=bool) for name in group}
    alone[carrier] = np.ones(count, dtype=bool)
    for _ in group:  # what touches something outside is outside, and so on
        for name in group:
            for body, touches in touching[name].items():
                alone[name] &= ~touches | alone.get(body, False)
    found = {name: np.zeros(count, dtype=bool) for name in group}
    found[carrier] = alone[carrier]
    below = {
        (body, name): ~(force <= TOUCH_FORCE)
        for name in group
        for body, force in supports(run, name).items()
        if body in found
    }
    for _ in group:  # from the carrier upwards
        for (body, name), carries in below.items():
            found[name] |= found[body] & carries & alone[name]
    del found[carrier]
    return found


def _connected(run: Run, start: str, names: Collection[str]) -> list[str]:
    """The bodies that contacts connect with another one at some time, sorted."""
    reached, added = {start}, {start}
    while added:
        near = {body for pair in run.signals.contact_forces if added & set(pair) for body in pair}
        added = (near & set(names)) - reached
        reached |= added
    return sorted(reached - {start})


def required_support(run: Run, name: str) -> float:
    """Force from below with which an object rests on something [N]: half of its weight."""
    return max((1 - ROUNDING) * SUPPORT_SHARE * weight_of(run, name), TOUCH_FORCE)


@fact
def standing(run: Run, name: str) -> dict[str, FloatArray]:
    """The supports of an object, without those that the robot carries [N], shape (N,) each.

    What the robot holds, what lies on its moving links, and the whole stack on that is no support.
    """
    free = {each.name for each in run.objects if not each.is_static}
    stack = _connected(run, name, free)
    moving = set(run.robot.link_names) - set(run.robot.static_links)
    touching = {body for other in stack for body in touched(run, other, moving)}
    always = np.ones(len(run.signals.times), dtype=bool)
    ground = dict.fromkeys(touching - free, always)
    grounded = carried(run, ground, {body: ~gripped(run, body) for body in stack})
    return {
        body: np.where(grounded.get(body, always) | np.isnan(force), force, 0.0)
        for body, force in supports(run, name).items()
    }


@fact
def carried_by_hand(run: Run) -> dict[str, BoolArray]:
    """Samples at which the hand holds objects, or what it holds carries them, (N,) each.

    Of the objects that it holds or carries at some sample.
    """
    free = {each.name for each in run.objects if not each.is_static and each.in_simulation}
    held = {name: mask for name in sorted(free) if (mask := gripped(run, name)).any()}
    always = np.ones(len(run.signals.times), dtype=bool)
    others = {other: always for name in held for other in (name, *_connected(run, name, free))}
    found = carried(run, held, dict(sorted(others.items())))
    return {name: mask for name, mask in found.items() if mask.any()}


def carried(
    run: Run, carriers: Mapping[str, BoolArray], others: Mapping[str, BoolArray]
) -> dict[str, BoolArray]:
    """Samples at which carriers bear objects, directly or through each other, shape (N,) each.

    An object is borne by what takes half of its weight and of what presses it down.

    Args:
        carriers: Bodies, and the samples at which they bear what lies on them.
        others: Objects, and the samples at which something may bear them.

    Returns:
        The samples of the carriers and of the others, by their names.
    """
    never = np.zeros(len(run.signals.times), dtype=bool)
    forces = {name: supports(run, name, run.robot.static_links) for name in others}
    found = {**dict.fromkeys(others, never), **carriers}
    for _ in others:
        before = dict(found)
        for name, on_it in forces.items():
            shares = [np.where(found.get(body, never), force, 0) for body, force in on_it.items()]
            load = np.sum([0 * never, *(each[name] for each in forces.values() if name in each)], 0)
            required = required_support(run, name) + (1 - ROUNDING) * SUPPORT_SHARE * load
            borne = np.sum([0 * never, *shares], 0) >= required
            found[name] = carriers.get(name, never) | (borne & others[name])
        if all(np.array_equal(found[name], before[name]) for name in others):
            break
    return found


def supports(run: Run, name: str, links: Collection[str] = ()) -> dict[str, FloatArray]:
    """Upward force [N] of each body that carries the object from below, shape (N,) each.

    Gaps of up to `DEBOUNCE` between two contacts are closed: no support lasts longer than its last
    contact. Where no direction was recorded, the whole force of a body that is below counts. Of the
    robot's links only `links` do.
    """
    carrying: dict[str, FloatArray] = {}
    for body in touched(run, name, set(run.robot.link_names) - set(links)):
        force, upward = force_between(run, {body}, {name}), _upward(run, body, name)
        if upward is None:
            upward = np.where(is_below(run, body, name), force, 0.0)
        # no part of a force is more than it is, and unknown where it is
        carrying[body] = without_gaps(np.minimum(upward, force), run.signals.times, DEBOUNCE)
    return carrying


def _upward(run: Run, body: str, name: str) -> FloatArray | None:
    """Upward force of a body on an object [N]; None where it was not recorded."""
    recorded, presses = run.signals.support_forces, run.signals.presses
    if (body, name) in recorded:
        return np.maximum(recorded[body, name], 0.0)
    if (name, body) in recorded:
        return np.maximum(-recorded[name, body], 0.0)
    if (body, name) in presses:
        return np.maximum(np.nan_to_num(presses[body, name][:, 5]), 0.0)
    return None
