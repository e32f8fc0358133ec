"""Puts an object down onto a belt: moves with the surface while the gripper opens."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import PrivateAttr

from harness.cell.cell import Cell
from harness.cell.grasp_choice import with_arm
from harness.cell.grasping import UP, gripper_axes, position_for_width
from harness.core.errors import PlanningFailed
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.plugins.belts.interception import PACES, Company, closing_time, company_plan, divided
from harness.plugins.belts.pick_in_motion import AJAR, BUILD_UP, PlannedLin
from harness.plugins.belts.ride import Ride, ride_of
from harness.ports.goals import PoseGoal
from harness.ports.motion_planning import MotionPlan, MotionRequest
from harness.ports.motions import FreeMotion
from harness.steps._approach import world_pose_spec
from harness.steps.move_to import MoveTo
from harness.steps.release import Release

LOWERING = 0.05  # Length of the descent next to the belt [m]


class _ReleaseInMotion(Release):
    """The gripper opens in motion and goes back, and then it is verified that it holds nothing."""

    _plan: MotionPlan = PrivateAttr()
    _opened: float = PrivateAttr()  # position of the gripper's joint

    def planned(self, plan: MotionPlan, opened: float) -> _ReleaseInMotion:
        """The step with the plan of the dwell and the retreat, and how far the gripper opens."""
        self._plan, self._opened = plan, opened
        return self

    def execute(self, cell: Cell) -> None:
        hand = cell.gripper
        cell.simulator.start_gripper(self._opened, hand.max_effort, hand.joint)
        cell.carry_out(self._plan)
        super().execute(cell)


def place_in_motion(
    name: str, targets: Sequence[SE3], retreat: float, group: str, cell: Cell
) -> None:
    """Lower an object at the speed of the belt under it, open, go back, verify."""
    failures: list[PlanningFailed] = []
    opened, opening = _opened(cell)
    for target in targets:
        ride = ride_of(name, cell, target)
        for pace in PACES:
            company = _company(ride, pace, opening, retreat, name, cell)
            try:
                start = _start_of(company, group, cell)
                plan = company_plan(company, start, group, cell, padded=False)
            except PlanningFailed as failure:
                failures.append(failure)
                continue
            names = cell.description.groups[group].joint_names
            joints = {joint: float(start[cell.description.joint_index[joint]]) for joint in names}
            lowering, leaving = divided(plan, pace)
            goal = world_pose_spec(company.tcp_pose(pace))
            lower = PlannedLin(pose=goal, group=group).planned(lowering)
            release = _ReleaseInMotion(object=name).planned(leaving, opened)
            cell.run_children(
                [
                    cell.child(
                        "reach", MoveTo(joints=joints, group=group), f"move_to above {name}"
                    ),
                    cell.child("lower", lower, f"lin with '{ride.belt}'"),
                    cell.child("release", release, f"release {name} in motion"),
                ]
            )
            return
    raise failures[-1]


def _opened(cell: Cell) -> tuple[float, float]:
    """Where the gripper's joint goes to let go next to a belt, and the time that it takes [s]."""
    hand, description = cell.gripper, cell.description
    now = float(cell.simulator.joint_positions()[description.joint_index[hand.joint]])
    if hand.cups:
        opened = hand.open_position
        return opened, BUILD_UP + closing_time(description, hand, now, opened)
    widest = float(hand.widths[:, 1].max())
    opened = position_for_width(hand, min(float(hand.gap_at(now)) + AJAR, widest))
    return opened, closing_time(description, hand, now, opened)


def _company(
    ride: Ride, pace: float, opening: float, retreat: float, name: str, cell: Cell
) -> Company:
    """The motion of the TCP that brings the held object to the start of a ride."""
    state, target = cell.planning_start(), ride.pose(0.0)
    tcp = cell.kinematics.link_pose(state, cell.description.tcp_link)
    at = cell.scene.object_pose(name, state).inverse() @ tcp
    above = SE3(at.rotation, at.translation + LOWERING * target.rotation.T @ UP)
    back: FloatArray = -retreat * (target.rotation @ at.rotation @ gripper_axes(cell)[0])
    return Company(ride, -pace, pace, opening, above, at, back)


def _start_of(company: Company, group: str, cell: Cell) -> FloatArray:
    """The state of the whole robot in which the motion with the belt begins.

    Raises:
        PlanningFailed: The arm has no free way to it.
    """
    start = cell.planning_start()
    goal = PoseGoal(cell.description.tcp_link, company.tcp_pose(0.0))
    request = MotionRequest(group, start, FreeMotion(goal), cell.current.options)
    end = cell.planner.plan(request).trajectory.positions[-1]
    return with_arm(end, start, group, cell)
