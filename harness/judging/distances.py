"""Recorded distances between the robot, what it holds, and objects."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.core.types import BoolArray, FloatArray
from harness.judging.contacts import attached
from harness.judging.facts import fact
from harness.judging.hold import gripped
from harness.judging.support import carried_by_hand
from harness.judging.temporal import bridged, episodes
from harness.judging.window import NotObservable, NotReached, object_record
from harness.language.step import step_class
from harness.recording.run import Run

Key = tuple[str, str]

MEASURED_WORDS = ("robot", "any")  # besides objects; those of a single link are not recorded


def recorded_distances(run: Run, first: str, second: str) -> dict[Key, FloatArray]:
    """Recorded distances that two words of `between` select, sorted by key.

    `any` is every object, and with one of several arms the other arms, too.
    """
    if first == "any" or (is_of_robot(run, second) and not is_of_robot(run, first)):
        first, second = second, first
    clearances = run.signals.clearances
    if second == "any":
        names = _names_of(run, first)
        arms = run.robot.of_arm
        of_arm = arms.get(first)
        holder = run if of_arm is None else replace(run, robot=of_arm)
        carried = {} if is_of_robot(run, first) else carried_by_hand(run)
        rows = {
            key: clearances[key]
            if key[1] in arms
            else np.where(
                in_grip(holder, key[1]) | carried.get(key[1], False), np.nan, clearances[key]
            )
            for key in sorted(clearances)
            if (key[0] in names and key[1] not in ("robot", key[0]))
            or (key[1] == first and first in arms)
        }
        if not rows and first == "robot" and run.objects:
            raise NotObservable("no distances between the robot and objects were recorded")
        if not rows:
            raise NotReached(f"there was no other body than {first} to measure to")
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
    objects = [name for name in (first, second) if not is_of_robot(run, name)]
    for name in objects:
        if not object_record(run, name).present:
            raise NotReached(f"{name} was never in the scene")
    if len(objects) == 2 and not any(attached(run, name).any() for name in objects):
        raise NotReached(f"the robot held neither {first} nor {second}")
    raise NotObservable(f"the distance between {first} and {second} was not recorded")


def is_of_robot(run: Run, name: str) -> bool:
    """Whether a name of a recorded distance is the robot, or one of its arms."""
    return name == "robot" or name in run.robot.of_arm


@fact
def in_grip(run: Run, name: str) -> BoolArray:
    """Samples at which an object has no distance to the robot, because the hand grips it, (N,).

    The physics decides: what a step has attached in the planning scene alone has one. A grip lasts
    through gaps under `BRIDGE`, and until the step ends that moves the gripper to let go. Of what
    only the planner knows, and where contacts were not recorded, the planning scene decides.
    """
    if not object_record(run, name).in_simulation or "contact_forces" in run.unrecorded:
        return _attached_or_just_released(run, name)
    mask = gripped(run, name)
    for start, stop in bridged(run.signals.times, episodes(mask)):
        mask[start:stop] = True
    for step in run.steps:
        during = slice(max(step.start_index - 1, 0), step.end_index)
        if step_class(step.verb).moves_gripper and mask[during].any():
            mask[during.start + int(np.argmax(mask[during])) : during.stop] = True
    return mask


def _attached_or_just_released(run: Run, name: str) -> BoolArray:
    """Samples at which an object has no distance to the robot, shape (N,)."""
    released = [
        record.end_time for record in run.attachments if name in (record.object, record.represents)
    ]
    return attached(run, name) | np.isin(run.signals.times, released)


def _names_of(run: Run, word: str) -> list[str]:
    """A name, and those that stand for it, or that it stands for, while attached."""
    if "attachments" in run.unrecorded:
        return [word]
    names = {word}
    for record in run.attachments:
        if word in (record.object, record.represents):
            names |= {record.object, record.represents}
    return sorted(names)
