"""Who touched whom: forces between sets of bodies, debounced.

A contact between stiff bodies flickers from sample to sample. Two bodies count as touching while
there was any force above `TOUCH_FORCE` in the last `DEBOUNCE` seconds.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from harness.assertions.temporal import trailing_max
from harness.assertions.window import NotObservable
from harness.core.types import BoolArray, FloatArray
from harness.recording.run import GripperRecord, Run

TOUCH_FORCE = 1e-3
"""A tenth of the weight of one gram; less is no support and no grip [N]."""
DEBOUNCE = 0.010
"""Longest gap inside one contact [s]: ten physics steps of 1 ms."""


def gripper_of(run: Run) -> GripperRecord:
    """The gripper.

    Raises:
        NotObservable: The robot has none.
    """
    if run.robot.gripper is None:
        raise NotObservable("the robot has no gripper")
    return run.robot.gripper


def finger_links(gripper: GripperRecord) -> frozenset[str]:
    """Links of all finger sides."""
    return frozenset(link for links in gripper.sides.values() for link in links)


def force_between(run: Run, firsts: Collection[str], seconds: Collection[str]) -> FloatArray:
    """Sum of the normal forces between two sets of bodies at each sample [N], shape (N,)."""
    total = np.zeros(len(run.signals.times))
    forces = run.signals.contact_forces
    for a, b in sorted(forces):
        if (a in firsts and b in seconds) or (b in firsts and a in seconds):
            total = total + forces[a, b]
    return total


def debounced(run: Run, force: FloatArray) -> FloatArray:
    """Largest force of the last `DEBOUNCE` seconds [N], shape (N,)."""
    return trailing_max(force, run.signals.times, DEBOUNCE)


def bodies_touching(
    run: Run,
    name: str,
    *,
    among: Collection[str] | None = None,
    but: Collection[str] = (),
) -> dict[str, FloatArray]:
    """Debounced force of every body that ever touched an object, sorted by name [N].

    Args:
        run: What happened.
        name: The object.
        among: Only these bodies; default any.
        but: Not these bodies.
    """
    touching = {b if a == name else a for a, b in run.signals.contact_forces if name in (a, b)}
    others = sorted(
        body for body in touching if (among is None or body in among) and body not in but
    )
    return {other: debounced(run, force_between(run, {name}, {other})) for other in others}


def side_forces(run: Run, name: str) -> dict[str, FloatArray]:
    """Debounced force of each finger side on an object, by side name [N], shape (N,) each."""
    sides = gripper_of(run).sides
    return {
        side: debounced(run, force_between(run, frozenset(sides[side]), {name}))
        for side in sorted(sides)
    }


def held_by_fingers(run: Run, name: str, min_force: float = TOUCH_FORCE) -> BoolArray:
    """Samples at which every finger side touches an object, shape (N,)."""
    forces = list(side_forces(run, name).values())
    if not forces:
        raise NotObservable("the gripper has no finger sides")
    return np.min(forces, axis=0) >= max(min_force, TOUCH_FORCE)


def attached(run: Run, name: str) -> BoolArray:
    """Samples at which the planning scene holds an object, or its stand-in, shape (N,)."""
    times = run.signals.times
    mask = np.zeros(len(times), dtype=bool)
    for record in run.attachments:
        if name in (record.object, record.represents):
            mask |= (times >= record.start_time) & (times < record.end_time)
    return mask


def weld_note(run: Run, name: str) -> str:
    """What a verdict says of an object that a grasp with `mode: weld` fixed in the physics too."""
    welded = any(
        step.result.get("mode") == "weld" and step.result.get("attached") == name
        for step in run.steps
    )
    return "; welded to the hand by `mode: weld`" if welded else ""


def in_hand(run: Run, name: str) -> BoolArray:
    """Samples at which an object is attached, or between all finger sides, shape (N,)."""
    mask = attached(run, name)
    return mask if run.robot.gripper is None else mask | held_by_fingers(run, name)
