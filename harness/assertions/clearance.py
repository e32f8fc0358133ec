"""clearance: recorded distances between the robot, what it holds, and objects."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from harness.assertions.contacts import attached, in_hand
from harness.assertions.registry import Evidence, MarginSignal, signal
from harness.assertions.text import amount, amounts
from harness.assertions.window import NotObservable, NotReached, Window, object_record
from harness.core.types import FloatArray, IntArray
from harness.recording.run import Measure, Run
from harness.spec.checks import Clearance

Key = tuple[str, str]


@signal.handles(Clearance)
def clearance(check: Clearance, window: Window) -> MarginSignal:
    """What is left of the distance, and of its loss against the plan [m], where both are there.

    `any` is every object but what the robot holds at that sample. Distances are recorded up to a
    cutoff; one at the cutoff is at least as much. The loss is how much less a distance is than it
    would be with the arm at its commands and what is attached where the planner carries it.

    Raises:
        NotReached: The two were never there together.
        NotObservable: The distance was not recorded, or its cutoff is below what is asked for.
    """
    distance = _smallest(window, recorded_distances(window.run, *check.between))
    there = np.isfinite(distance.values)
    if not there.any():
        raise NotReached(f"{check.between[0]} and {check.between[1]} were never there together")
    judged: list[_Judged] = []
    if check.at_least is not None:
        _refuse_beyond_cutoff(window.run, check.at_least, distance)
        judged.append(_Judged(distance.values - check.at_least, _least(check, window, distance)))
    if check.max_below_plan is not None:
        loss = _largest_loss(window, check)
        judged.append(_Judged(check.max_below_plan - loss.values, _below(check, window, loss)))
    rows = np.stack([each.margins for each in judged])

    def evidence(index: int) -> Evidence:
        return judged[int(rows[:, index].argmin())].evidence(index)

    values = np.where(there, rows.min(axis=0), np.nan)
    return MarginSignal(values, "m", evidence, applies=there)


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


def _smallest(window: Window, rows: Mapping[Key, FloatArray]) -> _Worst:
    stack = np.stack([np.nan_to_num(window.cut(values), nan=np.inf) for values in rows.values()])
    return _Worst(stack.min(axis=0), stack.argmin(axis=0), list(rows))


def _largest_loss(window: Window, check: Clearance) -> _Worst:
    """Planned less actual distance, the largest of all pairs [m]; unknown where one of both is."""
    run = window.run
    actual = recorded_distances(run, *check.between)
    planned = run.signals.planned_clearances
    missing = [key for key in actual if key not in planned]
    if missing:
        raise NotObservable(f"planned distances of {' and '.join(missing[0])} were not recorded")
    stack = np.stack([window.cut(planned[key] - values) for key, values in actual.items()])
    absent = np.stack([window.cut(np.isnan(values)) for values in actual.values()])
    ranked = np.where(absent, -np.inf, np.nan_to_num(stack, nan=np.inf))
    return _Worst(ranked.max(axis=0), ranked.argmax(axis=0), list(actual))


def _refuse_beyond_cutoff(run: Run, at_least: float, distance: _Worst) -> None:
    cutoff = run.signals.clearance_cutoff
    if at_least > cutoff and float(distance.values.min()) >= cutoff:
        recorded, required = amounts(cutoff, at_least, "m")
        raise NotObservable(
            f"distances were recorded up to {recorded} only; {required} are required"
        )


def _least(check: Clearance, window: Window, distance: _Worst) -> Callable[[int], Evidence]:
    limit = check.at_least or 0.0

    def evidence(index: int) -> Evidence:
        key, value = distance.keys[int(distance.which[index])], float(distance.values[index])
        who = _nearest_link(window, key, index) or key[0]
        is_capped = value >= window.run.signals.clearance_cutoff
        about = "at least " if is_capped else ""
        pair = f"{who} and {_itself(key)}"
        actual, required = amounts(value, limit, "m")
        text = f"{about}{actual} between {pair}, {required} required"
        ceiling = value if is_capped else math.inf
        time = window.time(index)
        measure = Measure("clearance", value, limit, ">=", "m", time, pair, ceiling=ceiling)
        return Evidence(text, (measure,))

    return evidence


def _below(check: Clearance, window: Window, loss: _Worst) -> Callable[[int], Evidence]:
    limit = check.max_below_plan or 0.0

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
        measure = Measure("clearance below plan", value, limit, "<=", "m", window.time(index), pair)
        return Evidence(text, (measure,))

    return evidence


def _itself(key: Key) -> str:
    return "itself" if key[0] == key[1] else key[1]


def recorded_distances(run: Run, first: str, second: str) -> dict[Key, FloatArray]:
    """Recorded distances that two words of `between` mean, sorted by key."""
    if first == "any" or (second == "robot" and first != "robot"):
        first, second = second, first
    clearances = run.signals.clearances
    if second == "any":
        names = _names_of(run, first)
        rows = {
            key: np.where(in_hand(run, key[1]), np.nan, clearances[key])
            for key in sorted(clearances)
            if key[0] in names and key[1] not in ("robot", key[0])
        }
        if not rows and first == "robot" and run.objects:
            raise NotObservable("no distances between the robot and objects were recorded")
        if not rows:
            raise NotReached(f"there was nothing beside {first}")
        return rows
    rows = {
        key: clearances[key]
        for a in _names_of(run, first)
        for b in _names_of(run, second)
        for key in ((a, b), (b, a))
        if key in clearances
    }
    if rows:
        return rows
    for name in (first, second):
        if name != "robot" and not object_record(run, name).present:
            raise NotReached(f"{name} was never in the scene")
    if "robot" not in (first, second) and not any(
        attached(run, name).any() for name in (first, second)
    ):
        raise NotReached(f"the robot held neither {first} nor {second}")
    raise NotObservable(f"the distance between {first} and {second} was not recorded")


def _names_of(run: Run, word: str) -> list[str]:
    """A name, and those that stand for it, or that it stands for, while attached."""
    if "attachments" in run.unrecorded:
        return [word]
    names = {word}
    for record in run.attachments:
        if word in (record.object, record.represents):
            names |= {record.object, record.represents}
    return sorted(names)


def _nearest_link(window: Window, key: Key, index: int) -> str:
    links = window.run.signals.clearance_links.get(key)
    number = -1 if links is None else int(links[window.start + index])
    return window.run.robot.link_names[number] if number >= 0 else ""
