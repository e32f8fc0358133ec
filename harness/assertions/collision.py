"""Which contacts are collisions: those that nothing excuses.

A contact of two bodies is no collision where
- the pair is allowed for the run, or by the `allow_collisions` step it happens in, unless
  `count_allowed` says that it counts;
- a link that cannot move stands on an object that cannot;
- the fingers of the gripper meet, closing on nothing;
- fingers or palm grip an object: see `_gripping`;
- two objects touch, none of them in the hand (a box that stands on a table);
- an object in the hand still touches what it touched when it was gripped, until it leaves that, or
  is being put down: the contact, with something under it, outlasts the hold.
Gaps under `BRIDGE` seconds end neither a contact between objects nor a hold.
"""

from __future__ import annotations

import numpy as np

from harness.assertions.contacts import (
    attached,
    bodies,
    debounced,
    finger_links,
    force_between,
    held_by_fingers,
)
from harness.assertions.support import is_below
from harness.assertions.temporal import episodes
from harness.core.types import BoolArray
from harness.recording.run import Run

BRIDGE = 0.1
"""[s]"""
GRIPPING_VERBS = ("gripper", "grasp", "release")
RESTING_VERBS = (*GRIPPING_VERBS, "wait", "settle")

Pair = tuple[str, str]


def colliding(run: Run, pair: Pair, count_allowed: bool = False) -> BoolArray:
    """Samples at which the contact of two bodies is a collision, shape (N,)."""
    touching = run.signals.contact_forces[pair] > 0
    if not count_allowed:
        touching &= ~_allowed(run, pair)
    links = frozenset(run.robot.link_names)
    moving = [name for name in pair if name in links]
    if len(moving) == 2:
        gripper = run.robot.gripper
        fingers_meet = gripper is not None and set(pair) <= finger_links(gripper)
        return np.zeros_like(touching) if fingers_meet else touching
    if not moving:
        return touching & (_hits_from_hand(run, *pair) | _hits_from_hand(run, *pair[::-1]))
    (link,) = moving
    (thing,) = set(pair) - {link}
    static = {record.name for record in run.objects if record.is_static}
    if link in run.robot.static_links and thing in static:
        return np.zeros_like(touching)
    return touching & ~_gripping(run, link, thing)


def _allowed(run: Run, pair: Pair) -> BoolArray:
    mask = np.zeros(len(run.signals.times), dtype=bool)
    mask |= any(_names(run, allowed, pair) for allowed in run.allowed_contacts)
    for step in run.steps:
        if any(_names(run, allowed, pair) for allowed in step.result.get("allowed_collisions", ())):
            mask[step.start_index : step.end_index] = True
    return mask


def _names(run: Run, allowed: Pair, pair: Pair) -> bool:
    words = {"robot", "gripper", "any"}
    first, second = (bodies(run, word) if word in words else frozenset({word}) for word in allowed)
    a, b = pair
    return (a in first and b in second) or (b in first and a in second)


def _steps_of(run: Run, verbs: tuple[str, ...], during: BoolArray | None = None) -> BoolArray:
    """Samples of the steps with these verbs; only of steps in which something is true."""
    mask = np.zeros(len(run.signals.times), dtype=bool)
    for step in run.steps:
        if step.verb not in verbs:
            continue
        around = slice(max(step.start_index - 1, 0), step.end_index + 1)
        if during is None or during[around].any():
            mask[step.start_index : step.end_index] = True
    return mask


def _gripping(run: Run, link: str, name: str) -> BoolArray:
    """Samples at which a gripper link touches an object because it grips it, shape (N,).

    A grip begins with a contact in a `gripper`, `grasp` or `release` in which the object is between
    all finger sides at some time. It lasts while the contact does and the object is attached, or
    all finger sides touch it, or the arm rests. A finger that knocks against an object on its way
    is a collision, whatever the planning scene says of the object, and so is one that drags it
    along after letting go, or that opens against a wall.
    """
    gripper = run.robot.gripper
    hand = frozenset[str]() if gripper is None else finger_links(gripper) | {gripper.palm_link}
    if link not in hand:
        return np.zeros(len(run.signals.times), dtype=bool)
    held = held_by_fingers(run, name)
    begins = _steps_of(run, GRIPPING_VERBS, held)
    lasts = attached(run, name) | held | _steps_of(run, RESTING_VERBS)
    contact = debounced(run, force_between(run, hand, {name})) > 0
    mask = np.zeros(len(contact), dtype=bool)
    for start, stop in episodes(contact & lasts):
        seeds = np.flatnonzero(begins[start:stop])
        if len(seeds):
            mask[start + int(seeds[0]) : stop] = True
    return mask


def _hits_from_hand(run: Run, held: str, other: str) -> BoolArray:
    """Samples at which an object in the hand touches another without excuse, shape (N,)."""
    guilty = np.zeros(len(run.signals.times), dtype=bool)
    if run.robot.gripper is None:
        return guilty
    holds = _bridged(run, episodes(held_by_fingers(run, held)))
    contacts = _bridged(run, episodes(force_between(run, {held}, {other}) > 0))
    carries = is_below(run, other, held) if holds and contacts else guilty
    for hold_start, hold_stop in holds:
        for start, stop in contacts:
            if start >= hold_stop or stop <= hold_start or start <= hold_start:
                continue
            put_down = stop > hold_stop and bool(carries[hold_stop - 1])
            if not put_down:
                guilty[start : min(stop, hold_stop)] = True
    return guilty


def _bridged(run: Run, spans: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """The same spans with gaps shorter than `BRIDGE` closed."""
    times = run.signals.times
    joined: list[tuple[int, int]] = []
    for start, stop in spans:
        if joined and times[start] - times[joined[-1][1] - 1] < BRIDGE:
            joined[-1] = (joined[-1][0], stop)
        else:
            joined.append((start, stop))
    return joined
