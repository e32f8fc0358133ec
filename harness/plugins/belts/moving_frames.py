"""Carries out motions whose goals are in the frame of an object that a belt or turntable moves."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack

from harness.cell.cell import Cell
from harness.cell.scene_state import StepNotes
from harness.cell.step import Step
from harness.cell.watched_goals import Predicted, may_move, places_in
from harness.core.errors import PlanningFailed, StepFailed
from harness.core.trajectory import JointTrajectory
from harness.plugins.belts.ride import Ride, expecting, ride_of
from harness.recording.explanation import Explanation

SLACK = 0.1  # of a motion's duration, by which the arrival is later than it would have to be
PLANS = 6  # that are made until one is no longer than the time to its arrival
LATER = 0.5  # [s], by which a goal is tried later that cannot be reached or has no motion to it
LONGEST = 30.0  # [s]: farther ahead, slip and rolling make a prediction worthless


def execute_motion(spec: Step, cell: Cell) -> dict[str, Predicted]:
    """Carry out a step; a motion to where an object is carried ends when the object is there.

    Returns:
        Where the objects that are carried will be after a duration [s], by their names.

    Raises:
        StepFailed: The step cannot be carried out, or the arm cannot be there in time.
    """
    frames = sorted({place.frame for place in places_in(spec) if may_move(place.frame, cell)})
    rides = {name: ride for name in frames if (ride := _ride(name, cell)) is not None}
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
    return {name: ride.pose for name, ride in rides.items()}


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


def _ride(name: str, cell: Cell) -> Ride | None:
    """How an object is carried now; None where it is not."""
    try:
        ride = ride_of(name, cell)
    except StepFailed:
        return None
    return None if ride.motion.is_still else ride


def _planned(spec: Step, rides: Mapping[str, Ride], arrival: float, cell: Cell) -> JointTrajectory:
    """The motion of a step to where the objects will be after some time [s]."""
    with ExitStack() as stack:
        for name, ride in rides.items():
            stack.enter_context(expecting(name, ride.pose(arrival), cell))
        cell.notes, cell.waiting = StepNotes(), []
        try:
            spec.execute(cell)
            return cell.waiting[0]
        finally:
            cell.waiting = None
