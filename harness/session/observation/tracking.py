"""Plan against physics, from the record: what the planner believed, and what happened."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from harness.core.amounts import amount
from harness.core.pose_arrays import compose
from harness.core.types import FloatArray, Pair
from harness.judging.drift import drift_in_hand
from harness.judging.hold import held_by_fingers
from harness.judging.joints import hand_joints
from harness.judging.window import NotObservable, NotReached
from harness.ports.kinematics import Kinematics
from harness.recording.motion import Motion
from harness.recording.run import AttachmentRecord, Finding, Run
from harness.recording.signals import Signals
from harness.recording.step_record import StepRecord

LOST = 0.003  # an object that drifted further in the hand is not where the planner carries it [m]
GRIP_GAP = 0.05  # [s] from the last touch of fingers to the end of a hold, at most
DIFFERENT = 1e-3  # planned and actual clearance that differ by more are reported step by step [m]

Distances = Callable[[Motion, Collection[Pair]], Mapping[Pair, FloatArray]]


def plan_against_physics(
    run: Run, signals: Signals, planned: Signals, distances: Distances
) -> tuple[Finding, ...]:
    """What differed between belief and physics, and by how much, in every run.

    Args:
        planned: The signals of the run `as_commanded`.
        distances: Measures the clearances of some pairs at every sample it is given.
    """
    held = [found for record in run.attachments if (found := held_finding(run, record)) is not None]
    near = _clearances(run.steps, signals, planned, distances)
    return (*held, *near)


def as_commanded(run: Run, kinematics: Kinematics) -> Signals:
    """The recording as if arm and attached objects had followed the commands exactly.

    Fingers stay where they were: one that presses lags its command.
    """
    signals, joints = run.signals, run.robot.movable_joints
    hand = hand_joints(run.robot)
    follows = np.array([joint.name not in hand for joint in joints])
    is_commanded = np.isfinite(signals.joint_commands) & follows
    positions = np.where(is_commanded, signals.joint_commands, signals.joint_positions)
    poses = dict(signals.object_poses)
    for record in run.attachments:
        held = (signals.times >= record.start_time) & (signals.times <= record.end_time)
        if record.object in poses and held.any():
            carrier = kinematics.link_poses(positions[held], [record.link])[:, 0]
            poses[record.object] = poses[record.object].copy()
            poses[record.object][held] = compose(carrier, np.array(record.pose_in_link))
    return replace(signals, joint_positions=positions, object_poses=poses)


def held_finding(run: Run, record: AttachmentRecord) -> Finding | None:
    """Where an attached object is believed to be, against where it is."""
    name = record.represents
    times = run.signals.times
    during = (times >= record.start_time) & (times < min(record.end_time, times[-1]))
    try:
        _, drift, turn, is_held = drift_in_hand(run, record.object)
        gripped = np.flatnonzero(held_by_fingers(run, name) & during)
    except (NotReached, NotObservable):
        return _belief_alone(run, record)
    if not len(gripped):
        return _belief_alone(run, record)
    rows = np.flatnonzero(during & is_held)
    if not len(rows):
        return None
    worst = int(rows[np.nanargmax(drift[rows])])
    moved, turned = float(drift[worst]), float(np.nanmax(turn[rows]))
    values = {"object": name, "drift": moved, "turn": turned, "held": True}
    last = float(times[gripped[-1]]) if len(gripped) else record.start_time
    if moved > LOST and float(times[rows[-1]]) - last > GRIP_GAP:
        message = f"the planner believed that it held {name}; the physics lost it at {last:.2f} s"
        return Finding("held", message, last, values={**values, "held": False, "lost_at": last})
    distance = f"{amount(moved, 'm')}, {amount(turned, 'rad')}"
    message = f"{name} moved {distance} in the hand against where the planner carried it"
    return Finding("held", message, float(times[worst]), values=values)


def never_held(run: Run) -> tuple[str, ...]:
    """What the user should know of physical objects that were attached and never held."""
    found = (held_finding(run, record) for record in run.attachments)
    return tuple(each.message for each in found if each and each.values.get("believed"))


def _belief_alone(run: Run, record: AttachmentRecord) -> Finding | None:
    """An attachment of something in the physics that no finger holds."""
    name, until = record.represents, min(record.end_time, run.duration)
    if not _is_physical(run, name) or until <= record.start_time:
        return None
    return Finding(
        "held",
        f"the planner believed that it held {name} from {record.start_time:.2f} s to {until:.2f} s;"
        " the fingers did not meanwhile, and an attachment carries nothing in the physics: close"
        " the gripper on it first, as `grasp` does",
        record.start_time,
        values={"object": name, "believed": True, "held": False},
    )


def _is_physical(run: Run, name: str) -> bool:
    return any(record.name == name and record.in_simulation for record in run.objects)


def _clearances(
    steps: Sequence[StepRecord], signals: Signals, planned: Signals, distances: Distances
) -> tuple[Finding, ...]:
    """Clearance where the arm came nearest in each motion, against that of the set points there."""
    near = {pair: values for pair, values in signals.clearances.items() if pair[0] == "robot"}
    moves = [(step, row) for step in steps if (row := _nearest(step, near)) is not None]
    if not moves:
        return ()
    rows = np.array([row for _, (row, _) in moves], dtype=np.int64)
    pairs = {pair for _, (_, pair) in moves}
    expectations = distances(Motion.of(planned).at(rows), pairs)
    found: list[Finding] = []
    compared: list[tuple[float, Finding]] = []
    for place, (step, (row, pair)) in enumerate(moves):
        actual = float(near[pair][row])
        expected = float(expectations.get(pair, np.full(len(rows), np.nan))[place])
        if not np.isfinite(expected):
            continue
        finding = Finding(
            "clearance",
            f"{_both(pair)} came as near as {amount(actual, 'm')}; the set"
            f" points there leave {amount(expected, 'm')}",
            float(signals.times[row]),
            step.id,
            {"pair": list(pair), "actual": actual, "planned": expected},
        )
        compared.append((actual, finding))
        if abs(actual - expected) > DIFFERENT:
            found.append(finding)
    if compared:
        nearest = min(compared, key=lambda item: item[0])[1]
        found = [nearest, *(other for other in found if other is not nearest)]
    return tuple(found)


def _both(pair: Pair) -> str:
    return "links of the robot" if pair == ("robot", "robot") else f"{pair[0]} and {pair[1]}"


def _nearest(step: StepRecord, near: Mapping[Pair, FloatArray]) -> tuple[int, Pair] | None:
    """Sample and pair of the smallest clearance in a step that moved the arm."""
    window = slice(step.start_index, step.end_index)
    best: tuple[float, int, Pair] | None = None
    for pair, values in near.items():
        part = values[window]
        if step.trajectory is None or not np.isfinite(part).any():
            continue
        row = int(np.nanargmin(part))
        if best is None or float(part[row]) < best[0]:
            best = float(part[row]), step.start_index + row, pair
    return None if best is None else (best[1], best[2])
