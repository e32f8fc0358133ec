"""collision: contacts that nothing excuses, by the rules of `harness.judging.collision`."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

import numpy as np
from pydantic import Field

from harness.cell.possible_contacts import check_contact
from harness.cell.scope import At
from harness.core.amounts import amount
from harness.core.types import BoolArray, FloatArray
from harness.judging.collision import Pair, colliding, held_by, why_not_excused
from harness.judging.contacts import (
    DEBOUNCE,
    bodies,
    could_touch,
    pairs_of,
    sample_time,
    unseen_contacts,
)
from harness.judging.excused_force import SPAN
from harness.judging.expectation import SPECIAL_BODIES, Predicate
from harness.judging.margins import Evidence, MarginSignal, measured
from harness.judging.observations import Observations
from harness.judging.temporal import episodes, trailing_max, without_gaps
from harness.judging.window import NotObservable, Window, lasting
from harness.language.base import Flag, Name
from harness.language.expectation import Quantity
from harness.recording.run import Run
from harness.recording.verdict import Measure

LEAST_DISTANCE = 1e-6  # a recorded distance of zero without contact is still none [m]

FORCE = Quantity(
    "contact force", "N", "more than 0 in a pair that nothing excuses; the largest", "contact"
)
LEFT = Quantity(
    "clearance",
    "m",
    "where nothing collided: what was left, if it was recorded; where bodies overlap at the start,"
    " or links that the SRDF excludes: their depth, below 0",
    "clearance",
)


class Collision(Predicate):
    """Two bodies touch that may not: no pair allows it, no grasp, no object on its support.

    The robot and what its hand holds are judged, each with anything. Objects that the hand does not
    hold may touch each other: with two objects of which it never holds one, the expectation is not
    observable, and `in_contact` is the one to use.

    The hand may touch what it grips. What it holds (welded or between the fingers) may touch what
    it stood on until it leaves that, and what it is put down on. Such a contact is a collision in
    two cases:

    - Its force, on average over 50 ms, exceeds 1 N (a tenth of a millimetre of position error) plus
      twice what explains it. The weight of the object and of what rests on it explains it, and,
      where a link of the hand presses or a step moves the gripper, the grip that its motor exerts.
      While the object leaves what it stood on, the grip is added once for at most 0.1 s in all: the
      fingers press an object onto its support until it is free. An average is an impulse: a blow
      of a millisecond may peak higher.

    - The object is dragged along the other body by 2 cm or more; along one contact the distances of
      several holds add up.

    Planner and physics leave out the contact of links that the SRDF excludes. Those that are apart
    with every joint at zero, and overlap by more than 1 mm during the run (convex hulls are not
    exact), are a finding of the run, and a collision where `count_allowed` says so.

    A collision lasts through gaps of at most 10 ms, as a contact does. It is judged while two of
    the bodies are in the physics: with an object that only the planner knows it is not observable,
    before an object is there it is not reached.
    """

    short = "between"
    judged = "eventually"
    sentence = "collision[ between {between}]"
    quantities = (FORCE, LEFT)
    synonyms = ("collide", "collides", "colliding", "collisions")
    is_opposed: ClassVar[bool] = True

    between: tuple[Name, Name] | None = Field(
        default=None,
        description="The two bodies: each a link, an object, `robot`, `gripper` or `any`; by"
        " default the robot and anything, and what it holds and anything.",
    )
    count_allowed: Flag = Field(
        default=False,
        description="Whether pairs that the SRDF or `allow_collisions` permits count too; links"
        " whose contact the SRDF excludes from the physics, by how deep they overlap.",
    )

    def check(self, at: At) -> None:
        for index, name in enumerate(self.between or ()):
            at.scope.check_body(name, at.key("between", index), special=SPECIAL_BODIES)
        if self.between is not None:
            loc = at.key("between")
            check_contact(at.scope, *self.between, loc, overlaps_count=self.count_allowed)

    def observations(self) -> Observations:
        return Observations(clearance_cutoff=0.0)

    def signal(self, window: Window) -> MarginSignal:
        """Positive while the bodies collide.

        Value and margin are the largest force of all collisions in the window [N], the same at each
        of their samples, so that the first contact decides. Where there is none the margin is the
        distance that was left [m] if it was recorded, else 1. Where bodies overlap when the run
        begins it is their depth [m].

        Raises:
            NotObservable: Only the planner knows one of the bodies, or the run knows none.
        """
        run = window.run
        links = bodies(run, "robot")
        first, second = (
            (links, bodies(run, "any"))
            if self.between is None
            else (bodies(run, word) for word in self.between)
        )
        if not (first | second) & links and not any(held_by(run, name) for name in first | second):
            raise NotObservable(
                "the hand holds neither of the two during the run; `in_contact` judges whether"
                " objects that it does not hold touch"
            )
        possible = pairs_of(first, second)
        together = lasting(window.cut(could_touch(run, possible)))
        return replace(
            self._contacts(window),
            applies=together,
            pairs=len(possible),
            warnings=unseen_contacts(run, possible),
        )

    def _contacts(self, window: Window) -> MarginSignal:
        """The margins of `signal`, whether or not the bodies are in the physics."""
        run = window.run
        pairs = self._pairs(run)
        allowed_too = self.count_allowed
        unknown = np.zeros(len(window.times), dtype=bool)
        for pair in pairs:
            unknown |= np.isnan(window.cut(run.signals.contact_forces[pair]))
        if unknown.any():
            values = np.where(unknown, np.nan, -1.0)
            return MarginSignal(values, "1", lambda _: Evidence("contacts are not known"))
        forces: dict[Pair, FloatArray] = {}
        for pair in pairs:
            guilty = colliding(run, pair, allowed_too)
            if not guilty.any():
                continue
            force = _force(run, guilty, run.signals.contact_forces[pair])
            unbroken = window.cut(without_gaps(force, run.signals.times, DEBOUNCE))
            if (unbroken > 0).any():
                forces[pair] = unbroken
        overlaps = _overlaps_at_start(window, forces)
        if overlaps:
            return _overlapped(forces, overlaps)
        if forces:
            return _collided(window, forces)
        inside = self._inside_each_other(window) if allowed_too else {}
        if inside:
            return _links_overlapped(window, inside)
        distance, name = self._distance(window, pairs)
        if distance is None:
            values = np.full(len(window.times), -1.0)
            return MarginSignal(values, "1", lambda _: Evidence("no collision", is_moment=False))
        spoken = np.nan_to_num(distance, nan=np.inf)

        def evidence(index: int) -> Evidence:
            value = float(distance[index])
            measure = measured(LEFT, value, 0.0, ">=", window.time(index), name)
            text = f"no collision; {amount(value, 'm')} were left between {name}"
            if value < 0:
                text = f"no contact, though {name} are {amount(-value, 'm')} inside each other"
            return Evidence(text, (measure,))

        return MarginSignal(-np.maximum(spoken, LEAST_DISTANCE), "m", evidence)

    def _pairs(self, run: Run) -> list[Pair]:
        """Pairs that ever touched and that the expectation covers."""
        every = sorted(run.signals.contact_forces)
        if self.between is None:
            return every
        first, second = (bodies(run, word) for word in self.between)
        return [
            (a, b) for a, b in every if (a in first and b in second) or (b in first and a in second)
        ]

    def _inside_each_other(self, window: Window) -> dict[Pair, FloatArray]:
        """Depths of links that the expectation names and that the physics lets overlap [m]."""
        run = window.run
        words = self.between or ("robot", "any")
        first, second = (bodies(run, word) for word in words)
        depths = {
            (a, b): window.cut(depth)
            for (a, b), depth in sorted(run.signals.link_overlaps.items())
            if (a in first and b in second) or (b in first and a in second)
        }
        return {pair: depth for pair, depth in depths.items() if not (depth <= 0).all()}

    def _distance(self, window: Window, pairs: list[Pair]) -> tuple[FloatArray | None, str]:
        """The smallest recorded distance that the expectation covers and nothing excuses.

        Only distances to what is in the physics count: nothing can collide with a belief.
        """
        run = window.run
        links = bodies(run, "robot")
        real = {"robot", *(record.name for record in run.objects if record.in_simulation)}
        if self.between is None:
            first, second = links, bodies(run, "any")
        else:
            first, second = (bodies(run, word) for word in self.between)
        excused = {frozenset("robot" if name in links else name for name in pair) for pair in pairs}
        best: FloatArray | None = None
        lowest, name = np.inf, ""
        if "clearances" in run.unrecorded:
            return None, ""
        distances = run.signals.clearances
        for a, b in sorted(distances):
            sets = [links if word == "robot" else frozenset({word}) for word in (a, b)]
            is_pair = any(x <= first and y <= second for x, y in (sets, sets[::-1]))
            if not is_pair or not {a, b} <= real or frozenset((a, b)) in excused:
                continue
            cut = window.cut(distances[a, b])
            if np.isnan(cut).all():
                continue
            if float(np.nanmin(cut)) < lowest:
                lowest, name = float(np.nanmin(cut)), f"{a} and {'itself' if a == b else b}"
            best = cut if best is None else np.fmin(best, cut)
        return best, name


def _force(run: Run, guilty: BoolArray, forces: FloatArray) -> FloatArray:
    """The force while two bodies collide, else 0 [N], shape (N,).

    An average over the time before can make a contact a collision: its first sample has the largest
    force of this time.
    """
    found = np.where(guilty, forces, 0.0)
    starts = [start for start, _ in episodes(guilty)]
    found[starts] = trailing_max(forces, run.signals.times, SPAN)[starts]
    return found


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
        measured(LEFT, -depth, 0.0, ">=", 0.0, name)
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


def _links_overlapped(window: Window, depths: dict[Pair, FloatArray]) -> MarginSignal:
    """Positive where links are inside each other: the largest depth of the window [m]."""
    deepest = np.max(list(depths.values()), axis=0)
    pair = max(depths, key=lambda each: float(np.nan_to_num(depths[each]).max()))
    depth = float(depths[pair].max())
    names = f"{pair[0]} and {pair[1]}"
    started = window.time(int(np.argmax(depths[pair] > 0)))
    measure = measured(LEFT, -depth, 0.0, ">=", started, names)

    def evidence(_: int) -> Evidence:
        text = f"{names} are up to {amount(depth, 'm')} inside each other from t={started:.3f} s"
        return Evidence(f"{text}; the SRDF excludes their contact", (measure,), is_moment=False)

    values = np.where(deepest > 0, depth, -LEAST_DISTANCE)
    return MarginSignal(np.where(np.isnan(deepest), np.nan, values), "m", evidence)


def _collided(window: Window, forces: dict[Pair, FloatArray]) -> MarginSignal:
    total = np.max(list(forces.values()), axis=0)
    peak = float(total.max())
    values = np.where(total > 0, peak, -1.0)

    def evidence(index: int) -> Evidence:
        measures: list[Measure] = []
        texts: list[str] = []
        first = {pair: int(np.argmax(force > 0)) for pair, force in forces.items()}
        for pair in sorted(forces, key=lambda pair: (first[pair], pair)):
            spans = episodes(forces[pair] > 0)
            started = window.time(spans[0][0])
            largest = float(forces[pair].max())
            lasted = sum(stop - start for start, stop in spans) * sample_time(window.run)
            in_all = " in all" if len(spans) > 1 else ""
            names = f"{pair[0]} and {pair[1]}"
            why = why_not_excused(window.run, pair)
            measures.append(measured(FORCE, largest, 0.0, "<=", started, names))
            texts.append(
                f"{names} collide from t={started:.3f} s for {amount(lasted, 's')}{in_all},"
                f" with up to {amount(largest, 'N')}{f' ({why})' if why else ''}"
            )
        if total[index] <= 0:
            return Evidence("no collision at this moment", tuple(measures))
        more = f"; and {len(texts) - 2} more pairs" if len(texts) > 2 else ""
        return Evidence("; ".join(texts[:2]) + more, tuple(measures[:4]), is_moment=False)

    return MarginSignal(values, "N", evidence)
