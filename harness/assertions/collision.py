"""collision: contacts that nothing excuses.

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

from harness.assertions.contact import bodies
from harness.assertions.contacts import (
    attached,
    debounced,
    finger_links,
    force_between,
    held_by_fingers,
)
from harness.assertions.registry import Evidence, MarginSignal, signal
from harness.assertions.support import is_below
from harness.assertions.temporal import episodes
from harness.assertions.text import amount
from harness.assertions.window import Window
from harness.core.types import BoolArray, FloatArray
from harness.recording.run import Measure, Run
from harness.spec.checks import Collision

BRIDGE = 0.1
"""[s]"""
LEAST_DISTANCE = 1e-6
"""A recorded distance of zero without contact is still none [m]."""
GRIPPING_VERBS = ("gripper", "grasp", "release")
RESTING_VERBS = (*GRIPPING_VERBS, "wait", "settle")

Pair = tuple[str, str]


@signal.handles(Collision)
def collision(check: Collision, window: Window) -> MarginSignal:
    """Positive while the bodies collide.

    Value and margin are the largest force of all collisions in the window [N], the same at each of
    their samples, so that the first contact decides. Where there is none the margin is the distance
    that was left [m] if it was recorded, else 1. Where bodies overlap when the run begins it is
    their depth [m].
    """
    run = window.run
    pairs = _pairs(run, check)
    allowed_too = check.count_allowed
    guilty = {pair: window.cut(colliding(run, pair, allowed_too)) for pair in pairs}
    unknown = np.zeros(len(window.times), dtype=bool)
    for pair in pairs:
        unknown |= np.isnan(window.cut(run.signals.contact_forces[pair]))
    if unknown.any():
        values = np.where(unknown, np.nan, -1.0)
        return MarginSignal(values, "1", lambda _: Evidence("contacts are not known"))
    forces = {
        pair: np.where(guilty[pair], window.cut(run.signals.contact_forces[pair]), 0.0)
        for pair in pairs
        if guilty[pair].any()
    }
    overlaps = _overlaps_at_start(window, forces)
    if overlaps:
        return _overlapped(forces, overlaps)
    if forces:
        return _collided(window, forces)
    distance, name = _distance(window, check, pairs)
    if distance is None:
        values = np.full(len(window.times), -1.0)
        return MarginSignal(values, "1", lambda _: Evidence("no collision", is_moment=False))
    spoken = np.nan_to_num(distance, nan=np.inf)

    def evidence(index: int) -> Evidence:
        left = amount(float(distance[index]), "m")
        measure = Measure(
            "clearance", float(distance[index]), 0.0, ">=", "m", window.time(index), name
        )
        return Evidence(f"no collision; {left} were left between {name}", (measure,))

    return MarginSignal(-np.maximum(spoken, LEAST_DISTANCE), "m", evidence)


def _overlaps_at_start(window: Window, forces: dict[Pair, FloatArray]) -> dict[Pair, float]:
    """Depths [m] of the colliding pairs that overlap when the run begins, the deepest first."""
    found: dict[Pair, float] = {}
    for finding in window.run.findings if window.time(0) == 0.0 else ():
        if finding.kind == "overlap":
            first, second = finding.values["pair"]
            pair = next((each for each in forces if set(each) == {first, second}), None)
            if pair is not None and forces[pair][0] > 0:
                found[pair] = float(finding.values["depth"])
    return found


def _overlapped(forces: dict[Pair, FloatArray], depths: dict[Pair, float]) -> MarginSignal:
    """Positive as in `_collided`, by the depth [m]: the forces are those of no real contact."""
    total = np.max(list(forces.values()), axis=0)
    names = [f"{first} and {second}" for first, second in depths]
    measures = tuple(
        Measure("clearance", -depth, 0.0, ">=", "m", 0.0, name)
        for name, depth in zip(names, depths.values(), strict=True)
    )
    texts = [
        f"{name} overlap by {amount(depth, 'm')} at the start"
        for name, depth in zip(names, depths.values(), strict=True)
    ]

    def evidence(index: int) -> Evidence:
        if total[index] <= 0:
            return Evidence("no collision at this moment", measures)
        more = f"; and {len(texts) - 2} more pairs" if len(texts) > 2 else ""
        return Evidence("; ".join(texts[:2]) + more, measures[:4], is_moment=False)

    values = np.where(total > 0, max(depths.values()), -LEAST_DISTANCE)
    return MarginSignal(values, "m", evidence)


def _collided(window: Window, forces: dict[Pair, FloatArray]) -> MarginSignal:
    total = np.max(list(forces.values()), axis=0)
    peak = float(total.max())
    values = np.where(total > 0, peak, -1.0)

    def evidence(index: int) -> Evidence:
        measures: list[Measure] = []
        texts: list[str] = []
        first = {pair: int(np.argmax(force > 0)) for pair, force in forces.items()}
        for pair in sorted(forces, key=lambda pair: (first[pair], pair)):
            start, stop = episodes(forces[pair] > 0)[0]
            largest = float(forces[pair].max())
            lasted = window.time(stop - 1) - window.time(start)
            names = f"{pair[0]} and {pair[1]}"
            measures.append(
                Measure("contact force", largest, 0.0, "<=", "N", window.time(start), names)
            )
            texts.append(
                f"{names} collide from t={window.time(start):.3f} s for {amount(lasted, 's')},"
                f" with up to {amount(largest, 'N')}"
            )
        if total[index] <= 0:
            return Evidence("no collision at this moment", tuple(measures))
        more = f"; and {len(texts) - 2} more pairs" if len(texts) > 2 else ""
        return Evidence("; ".join(texts[:2]) + more, tuple(measures[:4]), is_moment=False)

    return MarginSignal(values, "N", evidence)


def _pairs(run: Run, check: Collision) -> list[Pair]:
    """Pairs that ever touched and that the expectation speaks of."""
    every = sorted(run.signals.contact_forces)
    if check.between is None:
        return every
    first, second = (bodies(run, word) for word in check.between)
    return [
        (a, b) for a, b in every if (a in first and b in second) or (b in first and a in second)
    ]


def _distance(window: Window, check: Collision, pairs: list[Pair]) -> tuple[FloatArray | None, str]:
    """The smallest recorded distance that the expectation speaks of and nothing excuses.

    Only distances to what is in the physics count: nothing can collide with a belief.
    """
    run = window.run
    links = bodies(run, "robot")
    real = {"robot", *(record.name for record in run.objects if record.in_simulation)}
    if check.between is None:
        first, second = links, bodies(run, "any")
    else:
        first, second = (bodies(run, word) for word in check.between)
    excused = {frozenset("robot" if name in links else name for name in pair) for pair in pairs}
    best: FloatArray | None = None
    lowest, name = np.inf, ""
    if "clearances" in run.unrecorded:
        return None, ""
    distances = run.signals.clearances
    for a, b in sorted(distances):
        sets = [links if word == "robot" else frozenset({word}) for word in (a, b)]
        meant = any(x <= first and y <= second for x, y in (sets, sets[::-1]))
        if not meant or not {a, b} <= real or frozenset((a, b)) in excused:
            continue
        cut = window.cut(distances[a, b])
        if np.isnan(cut).all():
            continue
        if float(np.nanmin(cut)) < lowest:
            lowest, name = float(np.nanmin(cut)), f"{a} and {'itself' if a == b else b}"
        best = cut if best is None else np.fmin(best, cut)
    return best, name


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
