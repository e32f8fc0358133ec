"""clearance: the distance between two bodies, against a limit or against the plan."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from pydantic import Field

from harness.cell.scope import At
from harness.core.amounts import amount, amounts
from harness.core.types import BoolArray, FloatArray, IntArray
from harness.judging.collision import colliding
from harness.judging.contacts import attached, bodies, shapeless
from harness.judging.distances import (
    MEASURED_WORDS,
    Key,
    in_grip,
    is_of_robot,
    recorded_distances,
)
from harness.judging.expectation import Predicate
from harness.judging.hands import of_arm
from harness.judging.margins import Evidence, MarginSignal, measured
from harness.judging.observations import CLEARANCE_ROOM, Observations
from harness.judging.poses import present
from harness.judging.support import carried_by_hand
from harness.judging.window import NotObservable, NotReached, Window, lasting
from harness.language.base import Deviation, Name, NonNegativeLength
from harness.language.expectation import Quantity
from harness.recording.run import Run
from harness.recording.verdict import VerdictWarning

DISTANCE = Quantity("clearance", "m", "at least `at_least`", "clearance")
LOSS = Quantity("clearance below plan", "m", "at most `max_below_plan`", "clearance")


class Clearance(Predicate):
    """The distance between two bodies is at least a limit, or little less than planned.

    `robot` is the robot's links. What its fingers hold, or carry on what they hold, is named on its
    own, whether or not a step has attached it; where it comes nearer to an object than the links
    may, a verdict that passes has a warning, unless it is taken from the object or put on it.
    The name of one of several arms is that arm's links and gripper: `[left, right]` is the distance
    between two arms, `[left, any]` that of one to the objects and the other arms, and what one hand
    holds has a distance to the other arm.

    Links whose contact the SRDF excludes count as distances of the robot to itself where they are
    nearer than with every joint at zero, and apart there: what is near by design says nothing.

    Distances are measured every 5 ms, at every sample around the smallest, and wherever two bodies
    could come nearer by more than 2 mm in between, by the bound of their motion; where they could
    between two samples, at interpolated positions too. A recorded distance is therefore at most
    2 mm larger than the smallest until the next sample.
    """

    short = "at_least"
    some_of = ("at_least", "max_below_plan")
    subject = "between"
    judged = "always"
    sentence = (
        "clearance between {between} is[ at least {at_least}][ at most {max_below_plan} below plan]"
    )
    quantities = (DISTANCE, LOSS)

    between: tuple[Name, Name] = Field(
        default=("robot", "any"),
        description="The two bodies: each `robot`, one of several arms, an object, the name of a "
        "held object, or `any`.",
    )
    at_least: NonNegativeLength | None = Field(
        default=None, description="The smallest distance that is allowed [m]."
    )
    max_below_plan: Deviation | None = Field(
        default=None,
        description="The largest amount by which the distance may be below the one with the arm at"
        " its commands [m].",
    )

    def check(self, at: At) -> None:
        arms = at.scope.description.of_arm
        known = (*MEASURED_WORDS, *arms, *at.scope.objects)
        for index, name in enumerate(self.between):
            if name not in known:
                what = "object or arm" if arms else "object"
                at.scope.problems.unknown(at.key("between", index), what, name, known)
        first, second = self.between
        of_itself = first == second or "robot" in self.between
        if arms.keys() & set(self.between) and of_itself and {first, second} <= {"robot", *arms}:
            at.scope.problems.add(
                at.key("between"),
                f"'{first}' and '{second}' have links in common",
                "name two different arms",
                needs=("robot",),
            )

    def observations(self) -> Observations:
        cutoff = (self.at_least or 0.0) + CLEARANCE_ROOM
        is_planned = self.max_below_plan is not None
        return Observations(clearance_cutoff=cutoff, planned_clearances=is_planned)

    def signal(self, window: Window) -> MarginSignal:
        """What is left of the distance, and of its loss against the plan [m], where both are there.

        `any` is every object but what the robot holds at that sample. Where one of the distances
        is not known, the margin is unknown unless another one is too small. Distances are recorded
        up to a cutoff; one at the cutoff is at least as much. The loss is how much less a distance
        is than it would be with the arm at its commands and what is attached where the planner
        carries it.

        Raises:
            NotReached: The two were never there together.
            NotObservable: The distance was not recorded, or its cutoff is below what is required.
        """
        rows = recorded_distances(window.run, *self.between)
        distance = _smallest(window, rows)
        unknown = np.any([window.cut(unknown_distances(window.run, key)) for key in rows], axis=0)
        there = np.isfinite(distance.values) | unknown
        for name in {record.name for record in window.run.objects} & set(self.between):
            there &= lasting(window.cut(present(window.run, name)))
        if not there.any():
            raise NotReached(f"{self.between[0]} and {self.between[1]} were never there together")
        judged: list[_Judged] = []
        if self.at_least is not None:
            _refuse_beyond_cutoff(window.run, self.at_least, distance)
            least = _least(self.at_least, window, distance)
            judged.append(_Judged(distance.values - self.at_least, least))
        if self.max_below_plan is not None:
            loss = self._largest_loss(window)
            below = _below(self.max_below_plan, window, loss)
            judged.append(_Judged(self.max_below_plan - loss.values, below))
        margins = np.stack([each.margins for each in judged])

        def evidence(index: int) -> Evidence:
            return judged[int(margins[:, index].argmin())].evidence(index)

        smallest = margins.min(axis=0)
        values = np.where(there & ~(unknown & (smallest >= 0)), smallest, np.nan)
        of_robot = {"robot", *window.run.robot.of_arm} & set(self.between)
        links = frozenset[str]().union(*(bodies(window.run, word) for word in of_robot))
        warnings = (*shapeless(window.run, links), *self._held_nearer(window))
        return MarginSignal(values, "m", evidence, applies=there, warnings=warnings)

    def _held_nearer(self, window: Window) -> tuple[VerdictWarning, ...]:
        """A warning of what the hand carries nearer to an object than its links may come.

        Not of what it takes from the object or puts on it.
        """
        words = [word for word in self.between if is_of_robot(window.run, word)]
        others = set(self.between) - set(words)
        arm = next((word for word in words if word != "robot"), "")
        run = of_arm(window.run, arm)
        is_one = words and others and "any" not in others
        if not (is_one and self.at_least) or "contact_forces" in run.unrecorded:
            return ()
        (other,) = others
        found: list[VerdictWarning] = []
        for name in carried_by_hand(run):
            pairs = [pair for pair in run.signals.contact_forces if set(pair) == {name, other}]
            if pairs and not colliding(run, pairs[0]).any():
                continue
            if (name, other) not in run.signals.clearances:
                continue
            nearest = float(np.fmin.reduce(window.cut(run.signals.clearances[name, other])))
            if nearest < self.at_least:
                comes = f"which the hand carries, comes within {amount(nearest, 'm')} of {other}"
                found.append(VerdictWarning("held object is nearer", f"{name}, {comes}: name it"))
        return tuple(found)

    def _largest_loss(self, window: Window) -> _Worst:
        """Planned less actual distance, the largest of all pairs [m]; unknown where either is.

        What the hand holds and the planner does not carry has no plan.
        """
        run = window.run
        actual = recorded_distances(run, *self.between)
        planned = run.signals.planned_clearances
        missing = [key for key in actual if key not in planned]
        if missing:
            raise NotObservable(
                f"planned distances of {' and '.join(missing[0])} were not recorded"
            )
        stack = np.stack([window.cut(planned[key] - values) for key, values in actual.items()])
        names = {name for name, _ in actual if not is_of_robot(run, name)}
        unplanned = {name: ~attached(run, name) for name in names}  # the plan does not carry it
        absent = np.stack(
            [
                window.cut(np.isnan(values) | unplanned.get(name, False))
                for (name, _), values in actual.items()
            ]
        )
        ranked = np.where(absent, -np.inf, np.nan_to_num(stack, nan=np.inf))
        return _Worst(ranked.max(axis=0), ranked.argmax(axis=0), list(actual))


@dataclass(frozen=True, eq=False)
class _Judged:
    """Margins [m], shape (n,), and what a sample shows of them."""

    margins: FloatArray
    evidence: Callable[[int], Evidence]


@dataclass(frozen=True, eq=False)
class _Worst:
    """The worst of several pairs at each sample, shape (n,), and which one it is."""

    values: FloatArray
    which: IntArray
    keys: list[Key]


def _smallest(window: Window, rows: dict[Key, FloatArray]) -> _Worst:
    stack = np.stack([np.nan_to_num(window.cut(values), nan=np.inf) for values in rows.values()])
    return _Worst(stack.min(axis=0), stack.argmin(axis=0), list(rows))


def _refuse_beyond_cutoff(run: Run, at_least: float, distance: _Worst) -> None:
    cutoff = run.signals.clearance_cutoff
    if at_least > cutoff and float(distance.values.min()) >= cutoff:
        recorded, required = amounts(cutoff, at_least, "m")
        raise NotObservable(
            f"distances were recorded up to {recorded} only; {required} are required"
        )


def _least(limit: float, window: Window, distance: _Worst) -> Callable[[int], Evidence]:
    def evidence(index: int) -> Evidence:
        key, value = distance.keys[int(distance.which[index])], float(distance.values[index])
        who = _nearest_link(window, key, index) or key[0]
        is_capped = value >= window.run.signals.clearance_cutoff
        about = "at least " if is_capped else ""
        pair = f"{who} and {_itself(key)}"
        actual, required = amounts(value, limit, "m")
        text = f"{about}{actual} between {pair}, {required} required"
        measure = measured(DISTANCE, value, limit, ">=", window.time(index), pair)
        return Evidence(text, (replace(measure, ceiling=value if is_capped else math.inf),))

    return evidence


def _below(limit: float, window: Window, loss: _Worst) -> Callable[[int], Evidence]:
    def evidence(index: int) -> Evidence:
        key, value = loss.keys[int(loss.which[index])], float(loss.values[index])
        sample = window.start + index
        actual = float(window.run.signals.clearances[key][sample])
        planned = float(window.run.signals.planned_clearances[key][sample])
        pair = f"{key[0]} and {_itself(key)}"
        lost, allowed = amounts(value, limit, "m")
        text = (
            f"{amount(actual, 'm')} between {pair}, planned {amount(planned, 'm')}:"
            f" {lost} less, {allowed} allowed"
        )
        measure = measured(LOSS, value, limit, "<=", window.time(index), pair)
        return Evidence(text, (measure,))

    return evidence


def _itself(key: Key) -> str:
    return "itself" if key[0] == key[1] else key[1]


def _nearest_link(window: Window, key: Key, index: int) -> str:
    links = window.run.signals.clearance_links.get(key)
    number = -1 if links is None else int(links[window.start + index])
    return window.run.robot.link_names[number] if number >= 0 else ""


def unknown_distances(run: Run, key: Key) -> BoolArray:
    """Samples at which two bodies have a distance and it is not known, shape (N,).

    The distance exists where both are in the scene, the planning scene holds the first one (unless
    it is the robot), and the hand does not grip the second.
    """
    first, second = key
    exists: BoolArray = np.isnan(run.signals.clearances[key])
    if not is_of_robot(run, first):
        exists &= present(run, first) & attached(run, first)
    if not is_of_robot(run, second):
        exists &= present(run, second)
        if "attachments" not in run.unrecorded:
            of_arm = run.robot.of_arm.get(first)
            exists &= ~in_grip(run if of_arm is None else replace(run, robot=of_arm), second)
    return exists
