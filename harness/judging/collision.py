"""Which contacts are collisions: those that nothing excuses.

A contact of two bodies is no collision where
- the pair is allowed for the run, or by the `allow_collisions` step it happens in, unless
  `count_allowed` says that it counts;
- a link that cannot move stands on an object that cannot;
- the fingers of the gripper meet, closing on nothing;
- fingers or palm grip an object: see `_gripping`;
- two objects touch, none of them in the hand (a box that stands on a table);
- an object in the hand, held by the fingers or welded to it, or carried by such an object, still
  touches what it touched when it was gripped, until it leaves that, or is being put down: the
  contact, with something under it, outlasts the hold;
- what the hand carries in this way touches another such object.
The last two excuses of a hand and what it holds end where they press harder than `excused_force`
explains, or where the object is dragged along. Gaps under `BRIDGE` seconds end neither a contact
between objects nor a hold.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from harness.core.amounts import amount, amounts
from harness.core.types import BoolArray, FloatArray
from harness.judging.contacts import (
    TOUCH_FORCE,
    attached,
    bodies,
    debounced,
    force_between,
    side_forces,
)
from harness.judging.excused_force import (
    DRAG,
    dragged,
    hand_limit,
    held_limit,
    leaving_limit,
    mean_force,
)
from harness.judging.hands import each_hand, finger_links, gripper_of, hand_links
from harness.judging.hold import gripped, held_by_fingers
from harness.judging.support import carried_by_hand, is_below
from harness.judging.temporal import bridged, episodes
from harness.language.step import StepFields, step_class
from harness.recording.run import Run
from harness.recording.step_results import AllowedCollisions

Pair = tuple[str, str]


def colliding(run: Run, pair: Pair, count_allowed: bool = False) -> BoolArray:
    """Samples at which the contact of two bodies is a collision, shape (N,)."""
    touching = run.signals.contact_forces[pair] > 0
    if not count_allowed:
        touching &= ~_allowed(run, pair)
    links = frozenset(run.robot.link_names)
    moving = [name for name in pair if name in links]
    if len(moving) == 2:
        fingers = [finger_links(gripper_of(hand)) for hand in each_hand(run)]
        fingers_meet = any(set(pair) <= links for links in fingers)
        return np.zeros_like(touching) if fingers_meet else touching
    if not moving:
        return touching & (_hits_from_hand(run, *pair) | _hits_from_hand(run, *pair[::-1]))
    (link,) = moving
    (thing,) = set(pair) - {link}
    static = {record.name for record in run.objects if record.is_static}
    if link in run.robot.static_links and thing in static:
        return np.zeros_like(touching)
    hand = _hand_with(run, link)
    if hand is None:
        return touching
    gripping = _gripping(hand, link, thing)
    if gripping.any():
        gripping &= mean_force(run, link, thing) <= hand_limit(hand, thing)
    return touching & ~gripping


def why_not_excused(run: Run, pair: Pair) -> str:
    """How a contact of the hand, or of what it holds, goes beyond its excuse; empty if it does not.

    Contacts that nothing excuses have no such reason.
    """
    links = frozenset(run.robot.link_names)
    things = [name for name in pair if name not in links]
    if not each_hand(run):
        return ""
    force = mean_force(run, *pair)
    beyond = np.zeros(len(force))
    limits = np.zeros(len(force))
    for link, thing in permutations(pair):
        hand = _hand_with(run, link)
        if hand is not None and thing not in links:
            limits = hand_limit(hand, thing)
            beyond = np.where(_gripping(hand, link, thing), force - limits, 0.0)
    for held, other in permutations(things, 2):
        for contact in _contacts_in_hand(run, held, other):
            if contact.dragged is None:
                continue
            if contact.dragged.max() >= DRAG:
                return f"dragged along it by {amount(float(contact.dragged.max()), 'm')}"
            limits[contact.samples] = _limit_of(run, held, contact, force)
            beyond[contact.samples] = (force - limits)[contact.samples]
    worst = int(np.argmax(beyond))
    if beyond[worst] <= 0:
        return ""
    pressed, explained = amounts(float(force[worst]), float(limits[worst]), "N")
    return f"{pressed} over 50 ms, where weight and grip explain {explained}"


def _allowed(run: Run, pair: Pair) -> BoolArray:
    mask = np.zeros(len(run.signals.times), dtype=bool)
    mask |= any(_names(run, allowed, pair) for allowed in run.allowed_contacts)
    for step in run.steps:
        allowed = step.result.find(AllowedCollisions)
        if allowed and any(_names(run, each, pair) for each in allowed.allowed_collisions):
            mask[step.start_index : step.end_index] = True
    return mask


def _names(run: Run, allowed: Pair, pair: Pair) -> bool:
    words = {"robot", "gripper", "any"}
    first, second = (bodies(run, word) if word in words else frozenset({word}) for word in allowed)
    a, b = pair
    return (a in first and b in second) or (b in first and a in second)


def _samples_of(
    run: Run, is_chosen: Callable[[type[StepFields]], bool], during: BoolArray | None = None
) -> BoolArray:
    """Samples of the steps whose class is chosen; only of steps in which something is true."""
    mask = np.zeros(len(run.signals.times), dtype=bool)
    for step in run.steps:
        if not is_chosen(step_class(step.verb)):
            continue
        around = slice(max(step.start_index - 1, 0), step.end_index + 1)
        if during is None or during[around].any():
            mask[step.start_index : step.end_index] = True
    return mask


def _hand_with(run: Run, link: str) -> Run | None:
    hands = each_hand(run)
    return next((hand for hand in hands if link in hand_links(gripper_of(hand))), None)


def _gripping(run: Run, link: str, name: str) -> BoolArray:
    """Samples at which a gripper link touches an object because it grips it, shape (N,).

    A grip begins with a contact in a step that moves the gripper, in which the object is between
    all finger sides at some time. It lasts while the contact does and the object is attached, or
    all finger sides touch it, or the arm rests. A finger that knocks against an object on its way
    is a collision, whatever the planning scene says of the object, and so is one that drags it
    along after letting go, or that opens against a wall. The arm of the gripper is selected.
    """
    hand = hand_links(gripper_of(run))
    if link not in hand:
        return np.zeros(len(run.signals.times), dtype=bool)
    held = held_by_fingers(run, name)
    begins = _samples_of(run, lambda step: step.moves_gripper, held)
    touched = np.min(list(side_forces(run, name).values()), axis=0) >= TOUCH_FORCE
    lasts = attached(run, name) | touched | _samples_of(run, lambda step: step.keeps_arm_still)
    contact = debounced(run, force_between(run, hand, {name})) > 0
    mask = np.zeros(len(contact), dtype=bool)
    for start, stop in episodes(contact & lasts):
        seeds = np.flatnonzero(begins[start:stop])
        if len(seeds):
            mask[start + int(seeds[0]) : stop] = True
    return mask


def held_by(run: Run, name: str) -> bool:
    """Whether the hand ever holds an object, or what it holds carries it."""
    return name in carried_by_hand(run)


def _holds(run: Run, name: str, other: str) -> list[tuple[int, int]]:
    """When the hand holds an object, or carries it and not the other; short gaps included."""
    by_hand = carried_by_hand(run)
    mask = gripped(run, name)
    if name in by_hand:
        mask |= by_hand[name] & ~by_hand.get(other, np.zeros_like(mask))
    return bridged(run.signals.times, episodes(mask))


def _limit_of(run: Run, held: str, contact: _Contact, force: FloatArray) -> FloatArray:
    """Largest mean force of a contact of an object in the hand that is excused [N].

    Args:
        contact: The contact, of n samples.
        force: The mean force of the contact in the whole run [N], shape (N,).

    Returns:
        The limit at the samples of the contact, shape (n,).
    """
    span = contact.samples
    limit = held_limit(run, held, _samples_of(run, lambda step: step.moves_gripper))[span]
    return leaving_limit(run, held, span, force[span], limit) if contact.leaves else limit


def _hits_from_hand(run: Run, held: str, other: str) -> BoolArray:
    """Samples at which an object in the hand touches another without excuse, shape (N,)."""
    guilty = np.zeros(len(run.signals.times), dtype=bool)
    contacts = _contacts_in_hand(run, held, other)
    force = mean_force(run, held, other) if contacts else guilty.astype(float)
    for contact in contacts:
        span = contact.samples
        if contact.dragged is None:
            guilty[span] = True
        else:
            presses = force[span] > _limit_of(run, held, contact, force)
            guilty[span] |= presses | (contact.dragged >= DRAG)
    return guilty


@dataclass(frozen=True, eq=False)
class _Contact:
    """A contact of an object in the hand with another, during one hold.

    Attributes:
        dragged: How far the object is dragged along the other since it touches [m], shape (n,);
            None where nothing excuses the contact.
        leaves: Whether the object has touched the other since before it was gripped.
    """

    samples: slice
    dragged: FloatArray | None
    leaves: bool


def _contacts_in_hand(run: Run, held: str, other: str) -> list[_Contact]:
    """Contacts of an object in the hand with another.

    They are excused where the object leaves what it touched before, or is put down on it. Along one
    contact the distances of several holds add up: letting go on the way makes no new one.
    """
    if not each_hand(run):
        return []
    holds = _holds(run, held, other)
    contacts = bridged(run.signals.times, episodes(force_between(run, {held}, {other}) > 0))
    found: list[_Contact] = []
    for start, stop in contacts:
        before = 0.0
        for hold_start, hold_stop in holds:
            if start >= hold_stop or stop <= hold_start:
                continue
            first, last = max(start, hold_start), min(stop, hold_stop)
            moved = before + dragged(run, held, other, first, last)
            before = float(moved[-1])
            put_down = stop > hold_stop and bool(is_below(run, other, held)[hold_stop - 1])
            leaves = start <= hold_start
            is_excused = leaves or put_down
            found.append(_Contact(slice(first, last), moved if is_excused else None, leaves))
    return found
