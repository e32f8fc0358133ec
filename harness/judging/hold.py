"""When the gripper holds an object: its sides press it against each other, and carry its weight."""

from __future__ import annotations

import numpy as np

from harness.core.amounts import amount
from harness.core.antipodal import (
    combined_press,
    distance_pressed,
    force_between_sides,
    is_antipodal,
    is_opposite,
    least_thickness,
)
from harness.core.pose_arrays import (
    compose,
    conjugate,
    quat_product,
    relative,
    rotate,
    rotation_angle,
)
from harness.core.types import BoolArray, FloatArray, IntArray
from harness.judging.body_motion import lowest_points, middle_of
from harness.judging.contacts import (
    DEBOUNCE,
    TOUCH_FORCE,
    pull_on,
    side_forces,
    welded,
)
from harness.judging.facts import fact
from harness.judging.hands import each_hand, gripper_of, hand_links
from harness.judging.poses import object_poses, tcp_poses
from harness.judging.temporal import (
    TIME_RESOLUTION,
    bridged,
    episodes,
    first_within,
    trailing_max,
)
from harness.judging.window import NotObservable, object_record
from harness.recording.faults import faults_of
from harness.recording.run import Run

HOLD_TIME = 0.1
"""How long fingers must have touched an object without a break to hold it [s].

A blow between stiff bodies lasts a few milliseconds, and what flies past at 0.5 m/s is 5 cm further
after this time.
"""
CARRIED_SHARE = 0.5
"""Share of an object's weight that the hand carries at least, on average over `HOLD_TIME`.

At rest it is 1; below one half the object falls with more than half of gravity's acceleration.
"""
STEADY = 0.005  # [m], a held object's motion in the hand within `HOLD_TIME`: `grasped`'s default
STEADY_TURN = 0.1  # how far it may turn [rad]
CLOSING_SHARE = 0.01  # of its range, by which a joint that presses is commanded past its place
DRIVE_SHARE = 0.5
"""Share of the drive's force that reaches an object which the fingers press, and the reverse.

Contacts nearer to the joints of turning fingers, or farther, have another lever than the pads.
"""


@fact
def held_by_fingers(run: Run, name: str, min_force: float = TOUCH_FORCE) -> BoolArray:
    """Samples at which every finger side touches an object that is between them, shape (N,).

    Of several grippers any may hold it, unless an arm is selected.
    """
    if run.robot.needs_arm:
        held = [held_by_fingers(hand, name, min_force) for hand in each_hand(run)]
        return np.any([np.zeros(len(run.signals.times), dtype=bool), *held], axis=0)
    forces = list(side_forces(run, name).values())
    if not forces:
        raise NotObservable("the gripper has no finger sides")
    held = np.min(forces, axis=0) >= max(min_force, TOUCH_FORCE)
    if held.any():
        held &= between_fingers(run, name)
    return held & ~cradled(run, name) if held.any() else held


@fact
def between_fingers(run: Run, name: str) -> BoolArray:
    """Samples at which an object that all sides touch is between them, shape (N,).

    A slab that leans against the tips touches both fingers, and so does what lies on them like on a
    shelf, or what closed tips rest on: `is_antipodal` says what between means. Where no direction
    was recorded (an older run) every touch counts.
    """
    if gripper_of(run).cups:  # a cup holds by its own vacuum, between nothing
        return np.ones(len(run.signals.times), dtype=bool)
    sides = _side_presses(run, name)
    thickness = least_thickness(object_record(run, name).shapes)
    pairs = [
        is_antipodal(first, second, thickness)
        for index, first in enumerate(sides)
        for second in sides[index + 1 :]
    ]
    return np.any(pairs, axis=0) if pairs else np.ones(len(run.signals.times), dtype=bool)


def why_not_between(run: Run, name: str, sample: int) -> str:
    """Why an object that two sides touch is not between them; empty where it is."""
    sides = [press[[sample]] for press in _side_presses(run, name)]
    if cradled(run, name)[sample]:
        return "it lies on them and they do not press it"
    if len(sides) > 2 or between_fingers(run, name)[sample]:
        return ""
    if not is_opposite(*sides)[0]:
        return "they press it from the same side"
    apart = amount(float(distance_pressed(*sides)[0]), "m")
    thickness = amount(least_thickness(object_record(run, name).shapes), "m")
    return f"they press it at places {apart} apart, and it is {thickness} thick"


@fact
def _side_presses(run: Run, name: str) -> list[FloatArray]:
    """Contact point and force of each side over the last `DEBOUNCE` seconds, (N, 6) each.

    Empty where a side has no record.
    """
    sides = gripper_of(run).sides
    presses = run.signals.presses
    found: list[FloatArray] = []
    for side in sorted(sides):
        keys = [key for key in presses if key[0] in sides[side] and key[1] == name]
        if not keys:
            return []
        side_press = combined_press([presses[key] for key in keys])
        weight = np.linalg.norm(side_press[:, 3:], axis=1, keepdims=True)
        recent = recent_mean(
            run, np.hstack([weight * side_press[:, :3], side_press[:, 3:], weight]), DEBOUNCE
        )
        place = np.divide(
            recent[:, :3], recent[:, 6:], out=np.zeros((len(recent), 3)), where=recent[:, 6:] > 0
        )
        found.append(np.hstack([place, recent[:, 3:6]]))
    return found


def recent_mean(run: Run, rows: FloatArray, span: float) -> FloatArray:
    """Mean over the samples of the last `span` seconds, itself included, shape (N, k)."""
    times = run.signals.times
    first = first_within(times, span)
    summed = np.concatenate([np.zeros((1, rows.shape[1])), np.cumsum(rows, axis=0)])
    counts = np.arange(1, len(times) + 1) - first
    return (summed[1:] - summed[first]) / counts[:, None]


def averaged_force(run: Run, force: FloatArray, span: float) -> FloatArray:
    """Mean of a force over the last `span` seconds, one sample at least [N], shape (N,).

    It is exactly 0 where the force was 0 all that time.
    """
    shorter = max(span - 2 * TIME_RESOLUTION, 0.0)
    was_there = trailing_max(force, run.signals.times, shorter) > 0
    return np.where(was_there, recent_mean(run, force[:, None], shorter)[:, 0], 0.0)


def weight_of(run: Run, name: str) -> float:
    """Weight of an object [N]; 0 where its mass is not known."""
    mass = object_record(run, name).mass
    return float(np.nan_to_num(mass)) * float(np.linalg.norm(run.gravity))


def _upward(run: Run, name: str, which: str) -> FloatArray:
    """Upward part of the hand's recorded forces on an object, mean of `HOLD_TIME` [N], (N,)."""
    gripper = gripper_of(run)
    hand = hand_links(gripper)
    total = np.zeros((len(run.signals.times), 3))
    for key, rows in getattr(run.signals, which).items():
        if key[0] in hand and key[1] == name:
            total = total + (np.nan_to_num(rows[:, 3:]) if which == "presses" else rows)
    if which == "presses":
        total = total + pull_on(run, name)
    gravity = np.array(run.gravity)
    up = -gravity / max(float(np.linalg.norm(gravity)), 1e-12)
    return recent_mean(run, (total @ up)[:, None], HOLD_TIME)[:, 0]


def carried_weight(run: Run, name: str) -> FloatArray | None:
    """Force with which fingers and palm carry an object, friction included [N], shape (N,).

    None where friction was not recorded, as in an older run. It is unknown (inf) while the object
    is welded to the hand: then the weld carries it.
    """
    if not any(key[1] == name for key in run.signals.frictions):
        return None
    carried = _upward(run, name, "presses") + _upward(run, name, "frictions")
    return np.where(welded(run, name), np.inf, carried)


@fact
def cradled(run: Run, name: str) -> BoolArray:
    """Samples at which an object lies on fingers that do not press it, shape (N,).

    The normal forces alone carry half of its weight or more, as those of a trough do, and the force
    of the gripper's drive does not reach it. Fingers that grip press with that force, and carry by
    friction.
    """
    weight = weight_of(run, name)
    mask = np.zeros(len(run.signals.times), dtype=bool)
    if weight == 0 or gripper_of(run).cups:
        return mask
    lying = _upward(run, name, "presses") >= CARRIED_SHARE * weight
    return lying & ~_is_squeezed(run, name) if lying.any() else mask


def _is_squeezed(run: Run, name: str) -> BoolArray:
    """Samples at which the gripper's drive presses an object, shape (N,).

    The gripper is commanded past where it stands, and the sides press the object against each other
    with the force of its drive: the fingers of a jammed gripper, or those that grip something else,
    press with what the weight gives. The pads are in balance with the drive where its work equals
    theirs, F = effort / (d gap / d position).
    """
    hand = gripper_of(run)
    column = run.robot.joint_index[hand.joint]
    signals = run.signals
    short = np.abs(signals.joint_commands[:, column] - signals.joint_positions[:, column])
    closes = short > CLOSING_SHARE * abs(hand.open_position - hand.closed_position)
    rows = hand.widths[np.argsort(hand.widths[:, 0])]
    sides = _side_presses(run, name)
    if len(rows) < 2 or len(sides) < 2:
        return closes
    travel = np.abs(np.interp(signals.joint_positions[:, column], *_slopes(rows)))
    efforts = recent_mean(run, np.abs(signals.joint_efforts[:, [column]]), DEBOUNCE)[:, 0]
    pairs = [
        force_between_sides(first, second)
        for index, first in enumerate(sides)
        for second in sides[index + 1 :]
    ]
    work = np.max(pairs, axis=0) * travel
    reaches = (work * DRIVE_SHARE <= efforts) & (efforts * DRIVE_SHARE <= work)
    return closes & reaches & ~_jammed(run)


def _jammed(run: Run) -> BoolArray:
    """Samples after a fault that blocked a joint of the gripper, shape (N,)."""
    joints = run.robot.group_joints(gripper_of(run).group) or (gripper_of(run).joint,)
    stalls = [
        step.start_time
        for step in run.steps
        for fault in faults_of(step)
        if fault.fault == "joint_stall" and fault.target in joints
    ]
    return run.signals.times >= min(stalls, default=np.inf)


def _slopes(rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Positions, and how fast the gap between the pads changes there [m/rad or m/m]."""
    return rows[:, 0], np.gradient(rows[:, 1], rows[:, 0])


def held_for(run: Run, held: BoolArray) -> FloatArray:
    """How long something has been true without a break at each sample [s], shape (N,)."""
    times = run.signals.times
    since = np.zeros(len(times))
    for start, stop in episodes(held):
        since[start:stop] = times[start:stop] - times[start]
    return since


@fact
def moves_in_hand(run: Run, name: str) -> tuple[FloatArray, FloatArray]:
    """How far an object moved [m] and turned [rad] in the hand within `HOLD_TIME`, (N,) each."""
    return moved_since(run, name, first_within(run.signals.times, HOLD_TIME))


def moved_since(run: Run, name: str, before: IntArray) -> tuple[FloatArray, FloatArray]:
    """How far an object moved [m] and turned [rad] in the hand since earlier samples, (N,) each.

    It moves as its point that was between the fingers; its origin may be far from them. Its middle
    counts where the fingers did not press it, or no direction was recorded.

    Args:
        before: The earlier sample of each sample, shape (N,).
    """
    now, points = _poses_in_hand(run, name)
    then, point = now[before], points[before]
    way = now[:, :3] + rotate(now[:, 3:], point) - then[:, :3] - rotate(then[:, 3:], point)
    turned = rotation_angle(quat_product(conjugate(then[:, 3:]), now[:, 3:]))
    return np.linalg.norm(way, axis=1), turned


@fact
def _poses_in_hand(run: Run, name: str) -> tuple[FloatArray, FloatArray]:
    """T_tcp_object, shape (N, 7), and the object's point between the fingers, its axes, (N, 3)."""
    poses = object_poses(run, name)
    middle = middle_of(object_record(run, name))
    points = np.broadcast_to(middle, (len(poses), 3))
    if sides := _side_presses(run, name):
        pressed = np.all([side[:, 3:].any(axis=1) for side in sides], axis=0)
        offset = np.mean([side[:, :3] for side in sides], axis=0) - poses[:, :3]
        points = np.where(pressed[:, None], rotate(conjugate(poses[:, 3:]), offset), middle)
    return relative(tcp_poses(run), poses), points


def raised_by_hand(run: Run, name: str, held: BoolArray) -> FloatArray:
    """Height that the motion of the hand gives an object since it holds it [m], shape (N,).

    It is that of the object's lowest point if it stood in the hand as it did when the hold began.
    Gaps shorter than `BRIDGE` do not end a hold.
    """
    poses, tcp = object_poses(run, name), tcp_poses(run)
    record = object_record(run, name)
    raised = np.zeros(len(poses))
    for start, stop in bridged(run.signals.times, episodes(held)):
        in_hand = relative(tcp[start], poses[start])
        heights = lowest_points(record, compose(tcp[start:stop], in_hand))
        raised[start:stop] = heights - heights[0]
    return raised


def weld_note(run: Run, name: str, sample: int) -> str:
    """The note in a verdict about an object that a grasp with `mode: weld` fixes at a sample."""
    return "; welded to the hand by `mode: weld`" if welded(run, name)[sample] else ""


def gripped(run: Run, name: str) -> BoolArray:
    """Samples at which the hand holds an object in the physics, by fingers or weld, shape (N,)."""
    mask = welded(run, name)
    return mask | held_by_fingers(run, name) if each_hand(run) else mask
