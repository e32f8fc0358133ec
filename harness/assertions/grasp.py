"""grasped, released, slip: what the hand has, from contacts and from how the object moves."""

from __future__ import annotations

import numpy as np

from harness.assertions.contacts import (
    GIVE,
    TOUCH_FORCE,
    attached,
    between_fingers,
    bodies_touching,
    finger_gap,
    gripper_of,
    held_by_fingers,
    least_width,
    side_forces,
    weld_note,
)
from harness.assertions.poses import link_poses, object_poses, present
from harness.assertions.registry import MarginSignal, Part, all_of, signal
from harness.assertions.temporal import episodes
from harness.assertions.text import amount
from harness.assertions.window import NotObservable, NotReached, Window, object_record
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
from harness.recording.run import AttachmentRecord, Measure, Run, is_nested
from harness.spec.checks import Grasped, Released, Slip


@signal.handles(Grasped)
def grasped(check: Grasped, window: Window) -> MarginSignal:
    """Force on each side, and drift in the hand since all sides have been touching without a break.

    Drift is the change of T_tcp_object since the first sample of the current grasp; every turn
    counts, also about the axis of a round object.
    """
    run, name = window.run, check.object
    min_force = max(check.min_force, TOUCH_FORCE)
    in_hand = held_by_fingers(run, name, min_force)
    in_tcp = relative(run.signals.tcp_pose, object_poses(run, name))
    since = np.zeros(len(in_tcp), dtype=int)
    for start, stop in episodes(in_hand):
        since[start:stop] = start
    distance = window.cut(np.linalg.norm(in_tcp[:, :3] - in_tcp[since, :3], axis=1))
    turn = window.cut(rotation_angle(quat_product(conjugate(in_tcp[since, 3:]), in_tcp[:, 3:])))
    relevant = window.cut(in_hand)
    sides = {side: window.cut(force) for side, force in side_forces(run, name).items()}
    parts = [
        Part(f"{side} finger force", force, min_force, ">=", "N") for side, force in sides.items()
    ]
    slip = [
        Part("slip in the hand", distance, check.max_slip, "<=", "m", None, relevant),
        Part("turn in the hand", turn, check.max_rotation, "<=", "rad", None, relevant),
    ]
    between = window.cut(between_fingers(run, name)).astype(float)
    touched = np.min([part.margins() for part in parts], axis=0) >= 0
    parts += [Part("between the fingers", between, 1.0, "==", "1", None, touched), *slip]

    def text(index: int, _: Measure) -> str:
        forces = ", ".join(
            f"{side} finger {amount(float(force[index]), 'N')}" for side, force in sides.items()
        )
        if relevant[index]:
            moved = amount(float(slip[0].values[index]), "m")
            turned = amount(float(slip[1].values[index]), "rad")
            drift = f"{name} moved {moved} and turned {turned} in the hand"
            return f"{forces}; {drift}{weld_note(run, name)}"
        apart = _too_wide(run, name, window.start + index)
        return f"{forces}; {name} is not between the fingers{apart}{_planners_belief(run, name)}"

    return all_of(window, parts, text, present=window.cut(present(run, name)), shown=len(parts))


def _too_wide(run: Run, name: str, sample: int) -> str:
    """Whether the fingers are too close for it to be between them."""
    if not gripper_of(run).widths:
        return ""
    gap, width = float(finger_gap(run)[sample]), least_width(run, name)
    return f", they are {amount(gap, 'm')} apart" if gap + GIVE < width else ""


def _planners_belief(run: Run, name: str) -> str:
    """What the planning scene said of an object that the physics does not hold."""
    if not object_record(run, name).in_simulation:
        stands_for = [
            record.represents
            for record in run.attachments
            if record.object == name and record.represents != name
        ]
        hint = f": it stands for {stands_for[0]}" if stands_for else ""
        return f", it is not in the physics{hint}"
    if attached(run, name).any():
        return ", though the planning scene has it attached"
    return ""


@signal.handles(Released)
def released(check: Released, window: Window) -> MarginSignal:
    """No contact with any link of the robot, and not attached in the planning scene."""
    run, name = window.run, check.object
    force, hold = robot_contact(run, name)
    force, hold = window.cut(force), window.cut(hold)
    parts = [
        Part("contact with the robot", force, TOUCH_FORCE, "<=", "N"),
        Part("attached in the planning scene", hold, 0.0, "==", "1"),
    ]

    def text(index: int, _: Measure) -> str:
        belief = "attached in the planning scene" if hold[index] else "not attached"
        return f"the robot touches {name} with {amount(float(force[index]), 'N')}; {belief}"

    return all_of(window, parts, text, present=window.cut(present(run, name)))


def robot_contact(run: Run, name: str) -> tuple[FloatArray, FloatArray]:
    """Debounced force of all links on an object [N], and 1 where it is attached, (N,) each."""
    links = set(run.robot.link_names)
    force = np.zeros(len(run.signals.times))
    for touching in bodies_touching(run, name, among=links).values():
        force = force + touching
    return force, attached(run, name).astype(float)


@signal.handles(Slip)
def slip(check: Slip, window: Window) -> MarginSignal:
    """How far an object has drifted from where the planner carries it along.

    Judges the samples at which the planning scene has the object attached, from the first one at
    which all finger sides touch it until the gripper is opened to release it. What planner and
    physics differ by at the first (a planning object that `represents` another may be a little next
    to it) is the zero. Turns about the axis of a round object do not count.
    """
    run = window.run
    name, drift, turn, held = drift_in_hand(run, check.object)
    parts = [
        Part("slip against the planner", window.cut(drift), check.max_distance, "<=", "m"),
        Part("turn against the planner", window.cut(turn), check.max_rotation, "<=", "rad"),
    ]

    def text(index: int, _: Measure) -> str:
        moved, turned = (float(part.values[index]) for part in parts)
        return (
            f"{name} is {amount(moved, 'm')} and {amount(turned, 'rad')} from where the planner"
            " carries it"
        )

    return all_of(window, parts, text, applies=window.cut(held))


def released_at(run: Run, record: AttachmentRecord) -> float:
    """When the gripper began to release an attached object: inf where it did not [s].

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
        if step.verb in ("release", "detach_object")
        and step.start_time <= record.end_time <= step.end_time
    ]
    if not ends:
        return record.end_time
    place = ends[0]
    if leaves[place].verb == "detach_object":
        while place > 0 and leaves[place - 1].verb == "gripper":
            place -= 1
    return leaves[place].start_time


def drift_in_hand(run: Run, name: str) -> tuple[str, FloatArray, FloatArray, BoolArray]:
    """Drift [m], turn [rad] and where they mean something, of the physical object behind a name."""
    records = [record for record in run.attachments if name in (record.object, record.represents)]
    if not records:
        object_record(run, name)
        raise NotReached(f"{name} was never attached")
    count, times = len(run.signals.times), run.signals.times
    drift, turn = np.full(count, np.nan), np.full(count, np.nan)
    speaks = np.zeros(count, dtype=bool)
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
        held = during & (np.arange(count) >= first) & (times < released_at(run, record))
        held[first] = True
        speaks |= held
        drift[held] = np.linalg.norm(error[held, :3] - zero[:3], axis=1)
        if equal_turns(object_record(run, record.represents).shapes, np.eye(3)) == ANY:
            axis = np.array([0.0, 0.0, 1.0])
            turned = angle_between(rotate(error[:, 3:], axis), rotate(zero[3:], axis))
        else:
            turned = rotation_angle(quat_product(conjugate(zero[3:]), error[:, 3:]))
        turn[held] = turned[held]
    if not speaks.any():
        raise NotReached(f"the fingers never held {physical} while it was attached")
    return physical, drift, turn, speaks
