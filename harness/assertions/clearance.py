"""clearance: recorded distances between the robot, what it holds, and objects."""

from __future__ import annotations

import numpy as np

from harness.assertions.contacts import attached, in_hand
from harness.assertions.registry import Evidence, MarginSignal, signal
from harness.assertions.text import amount
from harness.assertions.window import NotObservable, NotReached, Window, object_record
from harness.core.types import FloatArray
from harness.recording.run import Measure, Run
from harness.spec.checks import Clearance

Key = tuple[str, str]


@signal.handles(Clearance)
def clearance(check: Clearance, window: Window) -> MarginSignal:
    """The smallest distance less what is asked for [m], wherever both bodies are there.

    `any` is every object but what the robot holds at that sample. Distances are recorded up to a
    cutoff; one at the cutoff is at least as much.

    Raises:
        NotReached: The two were never there together.
        NotObservable: The distance was not recorded, or its cutoff is below what is asked for.
    """
    run = window.run
    rows = {
        key: window.cut(values) for key, values in recorded_distances(run, *check.between).items()
    }
    keys = list(rows)
    stack = np.stack([np.nan_to_num(rows[key], nan=np.inf) for key in keys])
    nearest = stack.argmin(axis=0)
    distance = stack.min(axis=0)
    there = np.isfinite(distance)
    if not there.any():
        raise NotReached(f"{check.between[0]} and {check.between[1]} were never there together")
    cutoff = run.signals.clearance_cutoff
    if check.at_least > cutoff and float(distance.min()) >= cutoff:
        raise NotObservable(
            f"distances were recorded up to {amount(cutoff, 'm')} only;"
            f" {amount(check.at_least, 'm')} are asked for"
        )

    def evidence(index: int) -> Evidence:
        key, value = keys[int(nearest[index])], float(distance[index])
        who = _nearest_link(window, key, index) or key[0]
        about = "at least " if value >= cutoff else ""
        text = (
            f"{about}{amount(value, 'm')} between {who} and {key[1]},"
            f" {amount(check.at_least, 'm')} asked for"
        )
        time = window.time(index)
        detail = f"{who} and {key[1]}"
        measure = Measure("clearance", value, check.at_least, ">=", "m", time, detail)
        return Evidence(text, (measure,))

    values = np.where(there, distance - check.at_least, np.nan)
    return MarginSignal(values, "m", evidence, applies=there)


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
    names = {word}
    for record in run.attachments:
        if word in (record.object, record.represents):
            names |= {record.object, record.represents}
    return sorted(names)


def _nearest_link(window: Window, key: Key, index: int) -> str:
    links = window.run.signals.clearance_links.get(key)
    number = -1 if links is None else int(links[window.start + index])
    return window.run.robot.link_names[number] if number >= 0 else ""
