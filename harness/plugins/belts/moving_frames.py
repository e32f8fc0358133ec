"""Carries out motions whose goals are in the frame of an object that a belt or turntable moves."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
from typing import cast

import numpy as np
from pydantic import BaseModel

from harness.cell.cell import Cell
from harness.cell.scene_state import StepNotes
from harness.cell.step import Step
from harness.core.errors import PlanningFailed, StepFailed
from harness.core.spatial import SE3
from harness.core.trajectory import JointTrajectory
from harness.language.poses import Direction
from harness.plugins.belts.ride import Ride, ride_of
from harness.ports.simulation import RecordingSimulator
from harness.recording.explanation import Explanation
from harness.recording.signals import Signals

SLACK = 0.1  # of a motion's duration, by which the arrival is later than it would have to be
PLANS = 6  # that are made until one is no longer than the time to its arrival
LATER = 0.5  # [s], by which a goal is tried later that cannot be reached or has no motion to it
LONGEST = 30.0  # [s]: farther ahead, slip and rolling make a prediction worthless
MISSED = (0.005, 0.05)  # [m], [rad] of the goal from where the arm is, and less is no miss


def execute_motion(spec: Step, cell: Cell) -> None:
    """Carry out a step; a motion to where an object is carried ends when the object is there.

    Raises:
        StepFailed: The step cannot be carried out, or the arm cannot be there in time.
    """
    frames = [each for each in sorted({*_frames(spec)} & {*cell.presence}) if _is_free(each, cell)]
    rides = {name: ride for name in frames if (ride := _ride(name, cell)) is not None}
    stands = {name: cell.measured_pose(name) for name in frames if name not in rides}
    begin, first = cell.simulator.time, cell.simulator.sample_count - 1
    if not rides:
        spec.execute(cell)
    elif cell.waiting is not None:
        message = (
            f"a motion to {' and '.join(map(repr, rides))}, which moves, has a time of its own"
        )
        raise StepFailed("INVALID_MOTION_PLAN", f"{message}: it cannot run at once with others")
    else:
        arrival, motion = _meeting(spec, rides, cell)
        cell.simulator.hold(arrival - motion.duration)
        cell.simulator.track(motion)
    for name in frames:
        predicted = rides[name].pose if name in rides else lambda _, pose=stands[name]: pose
        _refuse_miss(name, predicted, begin, first, cell)


def _refuse_miss(
    name: str, predicted: Callable[[float], SE3], begin: float, first: int, cell: Cell
) -> None:
    """Fail where an object, in whose frame a goal was, went elsewhere by itself meanwhile.

    Args:
        name: The name of the object in whose frame a goal is.
        predicted: T_world_object that the motion was planned for, at a time after its begin [s].
        begin: When the motion was planned [s].
        first: The sample at that time.
        cell: The cell after the motion.

    Raises:
        StepFailed: MOTION_PLAN_INVALIDATED_BY_ENVIRONMENT_CHANGE; says by how much and when.
    """
    tcp = cell.kinematics.link_pose(cell.planning_start(), cell.description.tcp_link)

    def miss(pose: SE3, time: float) -> tuple[float, float]:
        return tcp.distance_to(pose @ predicted(time - begin).inverse() @ tcp)

    simulator, end = cell.simulator, cell.simulator.time
    is_met = np.less(miss(cell.measured_pose(name), end), MISSED).all()
    if is_met or not isinstance(simulator, RecordingSimulator):
        return
    signals = simulator.finish(first)
    last = _first_push(name, signals, cell)
    pose, time = SE3.from_vector(signals.object_poses[name][last]), float(signals.times[last])
    away, turn = miss(pose, time)
    if away > MISSED[0] or turn > MISSED[1]:
        raise StepFailed(
            "MOTION_PLAN_INVALIDATED_BY_ENVIRONMENT_CHANGE",
            f"'{name}', in whose frame the goal is, moved by itself: at t={time:.3f} s the goal was"
            f" {1e3 * away:.1f} mm and {math.degrees(turn):.1f} deg from where the arm"
            f" {'arrived' if last == -1 else 'went, and was pushed'}",
            Explanation(advice="let it come to rest before: `settle`, or `wait: {until: ...}`"),
        )


def _first_push(name: str, signals: Signals, cell: Cell) -> int:
    """The sample at which something that the arm may have pushed touches an object; -1: none."""
    free = {each for each, presence in cell.presence.items() if not presence.obj.is_static}
    pushed, near = set[str](), set(cell.robot.link_names)
    while near - pushed:
        pushed |= near
        pairs = [pair for pair in signals.contact_forces if pushed & {*pair}]
        near = {each for pair in pairs for each in pair} & free - {name}
    forces = [f for pair, f in signals.contact_forces.items() if name in pair and pushed & {*pair}]
    touched = np.any([*forces, np.zeros(len(signals.times))], axis=0)
    return int(touched.argmax()) if touched.any() else -1


def _meeting(spec: Step, rides: Mapping[str, Ride], cell: Cell) -> tuple[float, JointTrajectory]:
    """The earliest time found at which the arm can be where the objects are then, and its motion.

    Raises:
        StepFailed: There is none; of a goal that cannot be reached the failure is that of the
            first attempt.
    """
    arrival, plans, refused = 0.0, 0, None
    while arrival < LONGEST:
        for name, ride in rides.items():
            if not ride.is_on(arrival):
                raise _missed(refused, f"'{name}' leaves '{ride.belt}' in {arrival:.2f} s")
        try:
            motion = _planned(spec, rides, arrival, cell)
        except PlanningFailed as failure:
            refused, arrival = refused or failure, arrival + LATER
            continue
        if motion.duration <= arrival:
            return arrival, motion
        arrival, plans = round(motion.duration * (1 + SLACK) + 0.01, 2), plans + 1
        if plans == PLANS:
            break
    names = " and ".join(f"'{name}' at {ride.speed:.3g} m/s" for name, ride in rides.items())
    raise _missed(refused, f"{names} is not met")


def _missed(refused: PlanningFailed | None, why: str) -> PlanningFailed:
    """The failure of a goal that moves, with that of its first attempt."""
    if refused is not None:
        return PlanningFailed(refused.code, f"{refused.message}; later, {why}", *refused.details)
    advice = (
        "begin the motion earlier, stop the belt with `conveyor`, or give the goal in the frame of"
        " the belt, which stands"
    )
    return PlanningFailed(
        "INVALID_MOTION_PLAN", f"{why}, before the arm can be there", Explanation(advice=advice)
    )


def _is_free(name: str, cell: Cell) -> bool:
    """Whether an object may move by itself in the physics: it is there, not static and not held."""
    presence = cell.presence[name]
    is_physical = presence.is_there and presence.obj.in_simulation and not presence.obj.is_static
    return is_physical and name in cell.scene.object_names() and name not in cell.scene.attached()


def _ride(name: str, cell: Cell) -> Ride | None:
    """How an object is carried now; None where it is not."""
    try:
        ride = ride_of(name, cell)
    except StepFailed:
        return None
    return None if ride.motion.is_still else ride


def _frames(value: object) -> Iterator[str]:
    """Every `frame` of a place inside a step; of a direction only the axes count."""
    if isinstance(value, BaseModel) and not isinstance(value, Direction):
        frame = getattr(value, "frame", None)
        if isinstance(frame, str):
            yield frame
        for key in type(value).model_fields:
            yield from _frames(getattr(value, key))
    elif isinstance(value, Mapping | tuple):
        content = cast("Mapping[str, object] | tuple[object, ...]", value)
        for each in content.values() if isinstance(content, Mapping) else content:
            yield from _frames(each)


def _planned(spec: Step, rides: Mapping[str, Ride], arrival: float, cell: Cell) -> JointTrajectory:
    """The motion of a step to where the objects will be after some time [s]."""
    with ExitStack() as stack:
        for name, ride in rides.items():
            stack.enter_context(cell.expecting(name, ride.pose(arrival)))
        cell.notes, cell.waiting = StepNotes(), []
        try:
            spec.execute(cell)
            return cell.waiting[0]
        finally:
            cell.waiting = None
