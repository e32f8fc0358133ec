"""Picks an object from a belt: meets it, moves with it while the fingers close, lifts it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from pydantic import PrivateAttr

from harness.cell.cell import Cell
from harness.cell.goals import group_of
from harness.cell.grasp_choice import ChosenApproach
from harness.cell.grasping import least_gap, level_sides, position_for_width
from harness.core.details import Detail
from harness.core.errors import StepFailed
from harness.core.types import FloatArray
from harness.language.poses import Direction
from harness.plugins.belts.interception import (
    Company,
    Search,
    closing_time,
    company_plan,
    divided,
    find_meeting,
)
from harness.plugins.belts.ride import ride_of
from harness.ports.motion_planning import MotionPlan
from harness.steps.grasp import Grasp
from harness.steps.lin import Lin
from harness.steps.move_relative import MoveRelative
from harness.steps.move_to import MoveTo
from harness.steps.wait import Wait

AJAR = 0.03  # [m], by which the pads are farther apart than the object is wide: 15 mm on each side
SQUEEZE = -0.01  # [m], beyond its width, so that the fingers press with their whole effort
BUILD_UP = 0.1  # [s], for which suction cups stay with the object once the valve is open
MEETINGS = 3  # searched for, where the motion to the first takes longer than it was predicted


@dataclass(frozen=True)
class Interception(Detail):
    """Where an object on a belt was met.

    Attributes:
        belt: The belt or turntable that carried it.
        met: When the fingers began to close [s].
        miss: Where the object was then, from where it was predicted, in its axes [m].
    """

    belt: str
    met: float
    miss: tuple[float, float, float]


class PlannedLin(Lin):
    """A straight motion relative to a belt, which is planned before and ends in motion."""

    _plan: MotionPlan = PrivateAttr()

    def planned(self, plan: MotionPlan) -> PlannedLin:
        """The step with its plan."""
        self._plan = plan
        return self

    def execute(self, cell: Cell) -> None:
        cell.carry_out(self._plan)


class _GraspInMotion(Grasp):
    """The fingers close in motion, the object is lifted, and then the grasp is verified."""

    results = (*Grasp.results, Interception)

    _plan: MotionPlan = PrivateAttr()
    _closed: float = PrivateAttr()  # position of the gripper's joint
    _company: Company = PrivateAttr()

    def planned(self, plan: MotionPlan, closed: float, company: Company) -> _GraspInMotion:
        """The step with the plan of the dwell and the lift, and where the fingers close to."""
        self._plan, self._closed, self._company = plan, closed, company
        return self

    def execute(self, cell: Cell) -> None:
        company, belt = self._company, self._company.ride.belt
        expected = company.ride.pose(company.begin + company.pace)
        met = cell.simulator.time
        miss = expected.inverse().apply(cell.measured_pose(self.object).translation)
        x, y, z = miss.tolist()
        cell.report(Interception(belt, met, (x, y, z)))
        hand = cell.gripper
        cell.simulator.start_gripper(self._closed, self.max_effort or hand.grip_effort, hand.joint)
        cell.carry_out(self._plan)
        try:
            super().execute(cell)
        except StepFailed as failed:
            message = (
                f"{failed.message}; at t={met:.3f} s, when the fingers began to close, it was"
                f" {1e3 * np.linalg.norm(miss):.1f} mm from where '{belt}' was to bring it"
            )
            raise StepFailed(failed.code, message, *failed.details) from failed


def pick_in_motion(
    grasp: Grasp, lift: MoveRelative, choose: Callable[[], ChosenApproach], cell: Cell
) -> None:
    """Meet the object where its belt takes it, move with it, close, lift; then verify the grasp."""
    name, hand = grasp.object, cell.gripper
    ajar, squeezed = _ajar_and_closed(name, cell)
    start = cell.planning_start()
    start[cell.description.joint_index[hand.joint]] = ajar
    search = Search(
        group_of(cell, lift.group),
        cell.description.with_mimics(start),
        closing_time(cell.description, hand, ajar, squeezed) + (BUILD_UP if hand.cups else 0.0),
        _rise(lift, cell),
        choose,
    )
    with cell.unpadded_gripper(name):
        company, chosen = _reach(name, ajar, search, cell)
        plan = company_plan(company, cell.planning_start(), search.group, cell)
        joining, leaving = divided(plan, company.pace)
        keys = chosen.approach.at.keys
        approach = PlannedLin(**keys, group=lift.group).planned(joining)
        closing = _GraspInMotion(**dict(grasp)).planned(leaving, squeezed, company)
        cell.run_children(
            [
                cell.child("approach", approach, f"lin with {name}"),
                cell.child("grasp", closing, f"grasp and lift {name}"),
            ]
        )


def _ajar_and_closed(name: str, cell: Cell) -> tuple[float, float]:
    """Positions of the gripper's joint before it closes on an object, and after; off and on."""
    hand = cell.gripper
    if hand.cups:
        return hand.open_position, hand.closed_position
    width = level_sides(cell.presence[name].obj, cell.measured_pose(name), cell)[0][0]
    before, after = (
        position_for_width(hand, max(least_gap(cell), width + more)) for more in (AJAR, SQUEEZE)
    )
    return before, after


def _reach(name: str, ajar: float, search: Search, cell: Cell) -> tuple[Company, ChosenApproach]:
    """Go to where the approach begins, and wait there.

    Raises:
        PlanningFailed: There is no meeting.
    """
    wait = 0.0
    for attempt in range(1, MEETINGS + 1):
        began = cell.simulator.time
        company, chosen = find_meeting(ride_of(name, cell), search, cell)
        cell.simulator.start_gripper(ajar, cell.gripper.max_effort, cell.gripper.joint)
        reach = MoveTo(**chosen.reach_keys, group=search.group)
        number = "" if attempt == 1 else f"{attempt}"
        cell.run_children([cell.child(f"reach{number}", reach, f"move_to before {name}")])
        wait = began + company.begin - cell.simulator.time
        if wait >= 0:
            if wait > 0:
                waiting = cell.child(f"wait{number}", Wait(duration=wait), f"wait for {name}")
                cell.run_children([waiting])
            return company, chosen
    raise StepFailed("TIMED_OUT", f"the arm was {-wait:.2f} s late for '{name}'")


def _rise(lift: MoveRelative, cell: Cell) -> FloatArray:
    """The way of a lift in the world, shape (3,) [m]."""
    direction = lift.direction or Direction(xyz=(0, 0, 1))
    return (lift.distance or lift.max_distance or 0.0) * cell.world_direction(direction)
