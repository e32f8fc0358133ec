"""Where and when the TCP meets an object on a belt, and how it moves with it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.cell.cell import Cell
from harness.cell.grasp_choice import ChosenApproach, with_arm
from harness.core.errors import PlanningFailed
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.plugins.belts.ride import LOOK_AHEAD, Ride, expecting
from harness.ports.goals import JointGoal
from harness.ports.motion_planning import MotionPlan, MotionRequest
from harness.ports.motions import FreeMotion, TimedLinkMotion
from harness.recording.explanation import Explanation
from harness.robot.description import RobotDescription
from harness.robot.end_effector import Gripper

PACES = (0.5, 0.8, 1.2, 1.8)
"""Durations of the approach that are tried, quickest first [s]."""

STEP_TIME, STEP_LENGTH = 0.2, 0.05
"""Between the moments that are tried: this long [s], or as long as the object takes so far [m]."""

SPARE = 0.1  # [s], by which the arm is at the start of the approach before the object


def closing_time(
    description: RobotDescription, gripper: Gripper, start: float, goal: float
) -> float:
    """The time that the gripper's joint takes from one position to another, in hundredths [s]."""
    speed = description.closing_speed(gripper)
    rise = speed / description.joint_by_name[gripper.joint].acceleration
    return on_hundredths(abs(goal - start) / speed + rise)


def on_hundredths(duration: float) -> float:
    """A duration lengthened to the next hundredth, the period of a trajectory's set points [s]."""
    return math.ceil(100 * duration - 1e-6) / 100


@dataclass(frozen=True, eq=False)
class Company:
    """A motion of the TCP that joins an object in motion, stays with it, and lifts it.

    The TCP waits where the object will be half an approach later; while it descends it matches the
    object's velocity, is at rest relative to it while the gripper closes, and comes to rest while
    it lifts.

    Attributes:
        ride: The object in motion, from the start of the pick on.
        begin: When the approach begins, from the start of the pick [s].
        pace: The duration of the approach [s].
        closing: The time for which the TCP stays with the object [s].
        before: T_object_tcp at the begin of the approach.
        at: T_object_tcp at the grasp.
        lift: The way of the lift in the world, shape (3,) [m].
    """

    ride: Ride
    begin: float
    pace: float
    closing: float
    before: SE3
    at: SE3
    lift: FloatArray

    @property
    def rising(self) -> float:
        """The duration of the lift, which has the accelerations of the approach [s]."""
        approach = float(np.linalg.norm(self.at.translation - self.before.translation))
        ratio = np.linalg.norm(self.lift) / max(approach, 1e-3)
        return on_hundredths(self.pace * max(1.0, float(np.sqrt(ratio))))

    @property
    def duration(self) -> float:
        """The time that the whole motion takes [s]."""
        return self.pace + self.closing + self.rising

    def tcp_pose(self, time: float) -> SE3:
        """T_world_tcp at a time from the begin of the approach [s]."""
        joining = min(time / self.pace, 1.0)
        leaving = min(max((time - self.pace - self.closing) / self.rising, 0.0), 1.0)
        ridden = self.pace * (0.5 + _travel(joining) - joining)  # ahead of the object
        ridden += min(time, self.pace + self.closing)
        ridden += self.rising * (leaving - _travel(leaving))
        way = _smooth(joining) * (self.at.translation - self.before.translation)
        in_object = SE3(self.before.rotation, self.before.translation + way)
        pose = self.ride.pose(self.begin + ridden) @ in_object
        return SE3(pose.rotation, pose.translation + _smooth(leaving) * self.lift)


def _smooth(share: float) -> float:
    """From 0 to 1, at rest and without acceleration at both ends."""
    return ((6 * share - 15) * share + 10) * share**3


def _travel(share: float) -> float:
    """The integral of `_smooth`, which is a half at 1."""
    return ((share - 3) * share + 2.5) * share**4


@dataclass(frozen=True)
class Search:
    """What an interception is searched for.

    Attributes:
        group: The name of the planning group.
        start: The whole robot before, with the hand as open as it will be.
        closing: The time for which the TCP stays with the object [s].
        lift: The way of the lift in the world, shape (3,) [m].
        choose: The approach to the object where the cell expects it.
    """

    group: str
    start: FloatArray
    closing: float
    lift: FloatArray
    choose: Callable[[], ChosenApproach]


def find_meeting(ride: Ride, search: Search, cell: Cell) -> tuple[Company, ChosenApproach]:
    """The first motion with which the arm can meet an object on its ride, and its approach.

    Raises:
        PlanningFailed: There is none before the object leaves the belt; says by how much the arm
            was late, or what prevents the last meeting that was tried.
    """
    late, failures = np.inf, list[PlanningFailed]()
    step = max(STEP_TIME, STEP_LENGTH / ride.speed) if ride.speed else LOOK_AHEAD
    begin, ends = 0.0, ride.ends
    while begin + 2 * PACES[0] + search.closing <= ends:
        try:
            company, chosen, ready = _meeting_at(begin, ride, search, cell)
        except PlanningFailed as failure:
            failures.append(failure)
            begin += step
            continue
        if ready <= begin:
            return company, chosen
        late = min(late, ready - begin)
        begin = max(ready, begin + 0.25 * step) if ride.speed else ready
    raise _missed(ride, search, late, failures)


def _meeting_at(
    begin: float, ride: Ride, search: Search, cell: Cell
) -> tuple[Company, ChosenApproach, float]:
    """A meeting whose approach begins at a time, and when the arm is ready for it [s].

    Raises:
        PlanningFailed: The arm cannot reach the object there, or not move with it.
    """
    last = PlanningFailed("PLANNING_FAILED", f"it leaves '{ride.belt}'")
    for pace in PACES:
        if not ride.is_on(begin + 2 * pace + search.closing):
            break
        waiting = ride.pose(begin + 0.5 * pace)
        with expecting(ride.object, waiting, cell):
            chosen = search.choose()
        try:
            company, state = _company(begin, pace, waiting, chosen, ride, search, cell)
            company_plan(company, state, search.group, cell)
            return company, chosen, _reach_time(state, search, cell) + SPARE
        except PlanningFailed as failure:
            last = failure
    raise last


def _company(
    begin: float,
    pace: float,
    waiting: SE3,
    chosen: ChosenApproach,
    ride: Ride,
    search: Search,
    cell: Cell,
) -> tuple[Company, FloatArray]:
    """The motion with the object, and the state of the whole robot in which it begins.

    Raises:
        PlanningFailed: The arm has no way to where the approach begins.
    """
    if chosen.begin is None:
        raise PlanningFailed("PLANNING_FAILED", "the arm has no way to the start of the approach")
    names = cell.description.groups[search.group].joint_names
    positions = np.array([chosen.begin[name] for name in names])
    state = with_arm(positions, search.start, search.group, cell)
    before = waiting.inverse() @ cell.kinematics.link_pose(state, cell.description.tcp_link)
    approach = chosen.approach
    way = np.subtract(approach.at.target.xyz, approach.before.target.xyz)
    at = SE3(before.rotation, before.translation + waiting.rotation.T @ way)
    return Company(ride, begin, pace, search.closing, before, at, search.lift), state


def company_plan(
    company: Company, state: FloatArray, group: str, cell: Cell, *, padded: bool = True
) -> MotionPlan:
    """The plan of a motion with an object, which is not where the planning scene has it meanwhile.

    Args:
        company: The motion of the TCP next to the belt.
        state: The state of the whole robot in which it begins.
        group: The name of the planning group.
        cell: The cell with its planner.
        padded: Whether the planner's padding applies; what is put down comes as near as it stands.

    Raises:
        PlanningFailed: The arm cannot follow the object so.
    """
    pair = ("robot", company.ride.object)
    cell.scene.set_allowed([pair], allowed=True)
    try:
        motion = TimedLinkMotion(cell.description.tcp_link, company.tcp_pose, company.duration)
        options = cell.current.options if padded else replace(cell.current.options, padding=0.0)
        return cell.planner.plan(MotionRequest(group, state, motion, options))
    finally:
        cell.scene.set_allowed([pair], allowed=False)
        for around in cell.allowed:  # may name the same pair
            cell.scene.set_allowed(around, allowed=True)


def divided(plan: MotionPlan, time: float) -> tuple[MotionPlan, MotionPlan]:
    """The parts of a plan before and after one of its set points; the arm moves in between."""
    whole = plan.trajectory
    at = int(np.argmin(np.abs(whole.times - time)))
    first, second = (
        replace(
            whole,
            times=whole.times[part] - whole.times[part][0],
            positions=whole.positions[part],
            velocities=whole.velocities[part],
            accelerations=whole.accelerations[part],
        )
        for part in (slice(0, at + 1), slice(at, None))
    )
    return replace(plan, trajectory=first), replace(plan, trajectory=second)


def _reach_time(state: FloatArray, search: Search, cell: Cell) -> float:
    """The time that the free motion to where the approach begins takes [s].

    Raises:
        PlanningFailed: There is none.
    """
    goal = JointGoal(state[list(cell.description.group_indices(search.group))])
    options = replace(cell.current.options, is_explained=False)
    request = MotionRequest(search.group, search.start, FreeMotion(goal), options)
    return cell.planner.plan(request).trajectory.duration


def _missed(
    ride: Ride, search: Search, late: float, failures: Sequence[PlanningFailed]
) -> PlanningFailed:
    """No meeting: by how much the arm is late, or what prevents those that were tried."""
    what = f"'{ride.object}' cannot be met on '{ride.belt}' ({ride.motion})"
    if ride.ends < LOOK_AHEAD:
        what += f", which it leaves in {ride.ends:.2f} s"
    advice = "start the pick earlier, or let the belt run slower"
    if np.isfinite(late):
        message = f"{what}: the arm would be {late:.2f} s late at the nearest meeting"
        return PlanningFailed("TIMED_OUT", message, Explanation(advice=advice))
    if not failures:
        least = 2 * PACES[0] + search.closing
        message = f"{what}: a pick in motion takes {least:.2f} s from the begin of the approach"
        return PlanningFailed("TIMED_OUT", message, Explanation(advice=advice))
    # Those whose motion was planned came farther than those without a grasp in reach.
    order = ("INVALID_MOTION_PLAN", "PLANNING_FAILED", "GOAL_IN_COLLISION", "NO_IK_SOLUTION")
    nearest = min(
        failures, key=lambda each: order.index(each.code) if each.code in order else len(order)
    )
    reason = f"of {len(failures)} meetings that were tried, the nearest fails: {nearest.message}"
    return PlanningFailed(nearest.code, f"{what}; {reason}", *nearest.details)
