"""How far a held object has drifted from where the planner carries it."""

from __future__ import annotations

import numpy as np

from harness.core.pose_arrays import (
    angle_between,
    compose,
    conjugate,
    quat_product,
    relative,
    rotate,
    rotation_angle,
)
from harness.core.symmetry import ANY, equal_turns
from harness.core.types import BoolArray, FloatArray
from harness.judging.body_motion import middles
from harness.judging.hold import held_by_fingers
from harness.judging.poses import link_poses, object_poses
from harness.judging.window import NotObservable, NotReached, object_record
from harness.language.step import step_class
from harness.recording.run import AttachmentRecord, Run
from harness.recording.step_record import is_nested


def released_at(run: Run, record: AttachmentRecord) -> float:
    """Time at which the gripper began to release an attached object [s]; inf where it did not.

    `release` opens the gripper and then detaches the object; `gripper` and `detach_object` one
    after the other do the same. In between the object leaves the hand as it should.
    """
    leaves = [
        step
        for step in run.steps
        if not any(is_nested(other.path, step.path) for other in run.steps)
    ]
    ends = [
        place
        for place, step in enumerate(leaves)
        if step_class(step.verb).detaches_object
        and step.start_time <= record.end_time <= step.end_time
    ]
    if not ends:
        return record.end_time
    begin = leaves[ends[0]]
    if not step_class(begin.verb).moves_gripper:
        for before in reversed(leaves[: ends[0]]):
            if not step_class(before.verb).moves_gripper or before.start_time < record.start_time:
                break
            begin = before
    return begin.start_time


def drift_in_hand(run: Run, name: str) -> tuple[str, FloatArray, FloatArray, BoolArray]:
    """Name, drift [m] and turn [rad] of a physical object, and where the two are defined."""
    records = [record for record in run.attachments if name in (record.object, record.represents)]
    if not records:
        object_record(run, name)
        raise NotReached(f"{name} was never attached")
    count, times = len(run.signals.times), run.signals.times
    drift, turn = np.full(count, np.nan), np.full(count, np.nan)
    is_held = np.zeros(count, dtype=bool)
    physical = records[-1].represents
    for record in records:
        if not object_record(run, record.represents).in_simulation:
            raise NotObservable(f"{record.represents} is not in the physics")
        actual = object_poses(run, record.represents)
        carried = compose(link_poses(run, record.link), np.array(record.pose_in_link))
        error = relative(carried, actual)
        during = (times >= record.start_time) & (times < record.end_time)
        gripped = np.flatnonzero(during & held_by_fingers(run, record.represents))
        if len(gripped) == 0:
            continue
        zero = error[gripped[0]]
        first = int(gripped[0])
        held = (np.arange(count) >= first) & (times < released_at(run, record))
        is_held |= held
        body = object_record(run, record.represents)
        places = middles(body, error)
        drift[held] = np.linalg.norm(places[held] - places[first], axis=1)
        if equal_turns(body.shapes, np.eye(3)) == ANY:
            axis = np.array([0.0, 0.0, 1.0])
            turned = angle_between(rotate(error[:, 3:], axis), rotate(zero[3:], axis))
        else:
            turned = rotation_angle(quat_product(conjugate(zero[3:]), error[:, 3:]))
        turn[held] = turned[held]
    if not is_held.any():
        raise NotReached(f"the fingers never held {physical} while it was attached")
    return physical, drift, turn, is_held
