"""Plans what MoveIt's requests describe, with the program's own planner."""

from __future__ import annotations

import operator
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import accumulate
from typing import Any

import numpy as np

from harness.cell.cell import Cell
from harness.core.errors import PlanningFailed, StepFailed
from harness.core.printable import counted
from harness.core.registry import registry
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.motion_planner import STATE_CHECKS_PER_SECOND
from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.moveit.goals import arc_point_of, goal_of, path_constraints_of
from harness.plugins.ros.moveit.kept import kept
from harness.plugins.ros.moveit.trajectory_limits import check_constraints, slowed
from harness.plugins.ros.moveit.values import (
    frame_of,
    link_of,
    pose_of,
    positions_of,
    robot_trajectory,
    state_message,
)
from harness.ports.goals import AnyGoal, JointGoal, PoseGoal
from harness.ports.motion_planning import MotionRequest, PlanningOptions
from harness.ports.motions import (
    CartesianPathOptions,
    CircularMotion,
    FreeMotion,
    JointMotion,
    JumpThreshold,
    LinearMotion,
    PlannedMotion,
    SequenceItem,
    WaypointMotion,
)
from harness.recording.motion_failures import SearchFailure
from harness.recording.step_results import CartesianPathResult

PILZ = "pilz_industrial_motion_planner"
PLANNERS = {
    "ompl": ("RRTConnectkConfigDefault", "RRTConnect"),
    PILZ: ("PTP", "LIN", "CIRC"),
}
"""The pipelines that requests may name, and planners of each."""

MOST_ATTEMPTS = 10
"""Plans that are tried for one request; a client that names more waits no longer."""

PRECISION = 1e-3
"""How far a Cartesian path may leave its lines [m]: MoveIt names none."""

DEFAULT_TIME = 1.0
"""The `allowed_planning_time` of a request that has none or a negative one [s], as in MoveIt."""


@dataclass(frozen=True, eq=False)
class Planned:
    """The trajectory of a plan, and the joint positions that it starts from."""

    trajectory: JointTrajectory
    start: FloatArray


def plan_fields(cell: Cell, planned: Planned | None) -> dict[str, Any]:
    """The fields of a result that a plan fills."""
    if planned is None:
        return {
            "trajectory_start": message("moveit_msgs/msg/RobotState"),
            "planned_trajectory": robot_trajectory(None),
        }
    return {
        "trajectory_start": state_message(cell, planned.start),
        "planned_trajectory": robot_trajectory(planned.trajectory),
    }


def display_trajectory(cell: Cell, planned: Planned) -> Any:
    """A DisplayTrajectory."""
    fields = plan_fields(cell, planned)
    return message(
        "moveit_msgs/msg/DisplayTrajectory",
        model_id=cell.description.name,
        trajectory_start=fields["trajectory_start"],
        trajectory=[fields["planned_trajectory"]],
    )


def sequence_response(cell: Cell, planned: Planned | None, code: Any, seconds: float) -> Any:
    """A MotionSequenceResponse."""
    fields = plan_fields(cell, planned)
    return message(
        "moveit_msgs/msg/MotionSequenceResponse",
        error_code=code,
        sequence_start=fields["trajectory_start"],
        planned_trajectories=[fields["planned_trajectory"]] if planned else [],
        planning_time=seconds,
    )


def motion_text(request: Any) -> str:
    """What a MotionPlanRequest is about, for people: its planner and its goals."""
    planner = f"{request.pipeline_id} {request.planner_id}".strip()
    goals = [_goal_text(each) for each in request.goal_constraints]
    return f"{f' by {planner}' if planner else ''}: {' or '.join(goals) or 'no goal'}"


def _goal_text(constraints: Any) -> str:
    places = [
        f"{each.link_name} at {at.position.x:.3f}, {at.position.y:.3f}, {at.position.z:.3f}"
        f" in {each.header.frame_id or 'world'}"
        for each in constraints.position_constraints
        for at in each.constraint_region.primitive_poses[:1]
    ]
    turns = [f"{each.link_name} turned" for each in constraints.orientation_constraints]
    joints = len(constraints.joint_constraints)
    named = [*(places or turns), *([counted(joints, "joint")] if joints else [])]
    return ", ".join(named) or "nothing"


def warm_up(cell: Cell) -> None:
    """Plan to where the arm is: load what a process that is forked to plan would load each time."""
    start, group = cell.planning_start(), cell.description.default_group
    index = cell.description.joint_index
    here = start[[index[name] for name in cell.description.groups[group].joint_names]]
    with suppress(StepFailed):
        cell.sync_scene()
        motion = FreeMotion(JointGoal(here))
        cell.planner.plan(MotionRequest(group, start, motion, cell.current.options))


def plan_motion(cell: Cell, request: Any) -> Planned:
    """Plan a MotionPlanRequest.

    Raises:
        StepFailed: With MoveIt's code: there is no such motion, or the request cannot be read.
            TIMED_OUT, when its `allowed_planning_time` is used up.
    """
    cell.sync_scene()
    return plan_from(cell, request, positions_of(cell, request.start_state))


def plan_from(cell: Cell, request: Any, start: FloatArray) -> Planned:
    """Plan a MotionPlanRequest from joint positions in description order.

    Raises:
        StepFailed: As `plan_motion` does.
    """
    group = group_of(cell, request.group_name)
    if request.trajectory_constraints.constraints or request.reference_trajectories:
        reason = "trajectory constraints and reference trajectories are not kept"
        raise StepFailed("FAILURE", reason)
    options = _budgeted(scaled(cell, request), request)
    pipeline = str(request.pipeline_id) or "ompl"
    if pipeline not in PLANNERS:
        known = ", ".join(PLANNERS)
        raise StepFailed("FAILURE", f"there is no pipeline '{pipeline[:80]}'; pipelines: {known}")
    motion = _motion(cell, request, group, start)
    if pipeline == "ompl":
        name = "auto" if unknown_planner(request) else str(request.planner_id) or "auto"
        options = replace(options, pipeline="ompl", planner_id=name)
    try:
        plan = cell.planner.plan(MotionRequest(group, start, motion, options))
    except PlanningFailed as failure:
        search = failure.details.find(SearchFailure)
        if search is None or search.state_checks < options.attempts * options.max_state_checks:
            raise
        reason = f"{failure.message}; allowed_planning_time: {request.allowed_planning_time:g} s"
        raise StepFailed("TIMED_OUT", reason, *failure.details) from failure
    if pipeline == PILZ and str(request.planner_id) != "CIRC":
        check_constraints(cell, request, plan.trajectory, start)
    return Planned(slowed(cell, request, plan.trajectory, start), start)


def _budgeted(options: PlanningOptions, request: Any) -> PlanningOptions:
    """Options with the budget of a request, which its attempts share; the step's is the most."""
    attempts = min(max(1, int(request.num_planning_attempts)), MOST_ATTEMPTS)
    allowed = float(request.allowed_planning_time)
    seconds = allowed if allowed > 0 else DEFAULT_TIME
    checks = min(float(options.max_state_checks), seconds * STATE_CHECKS_PER_SECOND)
    return replace(options, attempts=attempts, max_state_checks=max(1, int(checks / attempts)))


def unknown_planner(request: Any) -> str:
    """Why OMPL has no planner of the request's name, for a note; empty where it has.

    The default plans then, as with MoveIt.
    """
    name = str(request.planner_id)
    if name and str(request.pipeline_id) in ("", "ompl"):
        try:
            registry("planner")["ompl"].check(name, {})
        except ValueError as error:
            return str(error)
    return ""


def _motion(cell: Cell, request: Any, group: str, start: FloatArray) -> PlannedMotion:
    if str(request.pipeline_id) != PILZ:
        goal = goal_of(cell, group, request.goal_constraints, start)
        return FreeMotion(goal, path_constraints_of(cell, request.path_constraints))
    item = pilz_item(cell, request, group, start)
    goal = item.goal
    if item.kind == "lin":
        return LinearMotion(goal)
    if item.point is not None:
        return CircularMotion(goal, item.point)
    if isinstance(goal, JointGoal):
        return JointMotion(goal.positions)
    solutions = cell.kinematics.solve(group, goal, start, cell.current.options.seed)
    if not solutions:
        raise PlanningFailed("NO_IK_SOLUTION", "no joint positions reach the goal")
    return JointMotion(solutions[0])


def pilz_item(
    cell: Cell, request: Any, group: str, start: FloatArray, blend_radius: float = 0.0
) -> SequenceItem:
    """The motion that Pilz would plan for a request.

    Raises:
        StepFailed: Pilz has no such planner, or takes no such goal.
    """
    goal, planner = goal_of(cell, group, request.goal_constraints, start), str(request.planner_id)
    if planner not in PLANNERS[PILZ]:
        raise StepFailed("FAILURE", f"Pilz has no planner '{planner[:80]}', but PTP, LIN and CIRC")
    if isinstance(goal, AnyGoal):
        raise StepFailed("INVALID_GOAL_CONSTRAINTS", "Pilz takes one goal")
    if planner == "CIRC":
        point = arc_point_of(cell, request.path_constraints)
        return SequenceItem("circ", goal, point, blend_radius)
    return SequenceItem("lin" if planner == "LIN" else "ptp", goal, None, blend_radius)


def plan_cartesian_path(cell: Cell, request: Any) -> tuple[Planned | None, float]:
    """Plan a GetCartesianPath request.

    Returns:
        The plan, None where no part of the path can be followed, and the fraction that it follows.

    Raises:
        StepFailed: The request cannot be read.
    """
    cell.sync_scene()
    group = group_of(cell, request.group_name)
    link = link_of(cell, request.link_name, group)
    if path_constraints_of(cell, request.path_constraints):
        raise StepFailed("FAILURE", "path constraints of a Cartesian path are not kept")
    if not 1e-4 <= request.max_step < np.inf:
        raise StepFailed("FAILURE", "a Cartesian path needs a max_step from 0.0001 m")
    if not request.waypoints:  # as MoveIt
        return None, 0.0
    start = positions_of(cell, request.start_state)
    if str(request.header.frame_id).lstrip("/") == link:  # each in the frame of the one before
        here = cell.kinematics.link_pose(start, link)
        poses = [*accumulate(map(pose_of, request.waypoints), operator.matmul, initial=here)][1:]
    else:
        frame = frame_of(cell, str(request.header.frame_id))
        poses = [frame @ pose_of(each) for each in request.waypoints]
    goals = [PoseGoal(link, pose) for pose in poses]
    jump = JumpThreshold(
        _threshold(request.revolute_jump_threshold, 0.5),
        _threshold(request.prismatic_jump_threshold, 0.1),
    )
    path = CartesianPathOptions(float(request.max_step), PRECISION, 0.0, jump)
    motion = WaypointMotion(goals, path)
    try:
        plan = cell.planner.plan(MotionRequest(group, start, motion, scaled(cell, request)))
    except PlanningFailed as failure:
        followed = failure.details.find(CartesianPathResult)
        if followed is None:
            raise
        return None, followed.fraction
    followed = plan.result.find(CartesianPathResult)
    trajectory = slowed(cell, request, plan.trajectory, start)
    return Planned(trajectory, start), followed.fraction if followed else 1.0


def solve_pose(cell: Cell, request: Any) -> FloatArray:
    """Solve a PositionIKRequest; the joint positions in description order.

    Raises:
        StepFailed: With MoveIt's code.
    """
    cell.sync_scene()
    group, description = group_of(cell, request.group_name), cell.description
    stamped, name = request.pose_stamped, request.ik_link_name
    if len(request.pose_stamped_vector) == 1:
        [stamped], name = request.pose_stamped_vector, [*request.ik_link_names, ""][0]
    elif request.pose_stamped_vector:
        raise StepFailed("FAILURE", "one link and one pose are solved")
    link, constraints = (
        link_of(cell, name, group), path_constraints_of(cell, request.constraints)
    )  # fmt: skip
    pose = frame_of(cell, str(stamped.header.frame_id)) @ pose_of(stamped.pose)
    seed, options = positions_of(cell, request.robot_state), cell.current.options
    columns = [description.joint_index[name] for name in description.groups[group].joint_names]
    solutions = cell.kinematics.solve(group, PoseGoal(link, pose), seed, options.seed)
    reasons = Counter[str]()
    for solution in solutions:
        row = seed.copy()
        row[columns] = solution
        row = description.with_mimics(row)
        broken = [each.what for each in kept(cell, constraints, row) if not each.holds]
        if broken:
            reasons[f"break the constraint of the {broken[0]}"] += 1
        elif request.avoid_collisions and cell.scene.touches(row, options.padding):
            reasons["collide"] += 1
        else:
            return row
    how = "".join(f"; {count} solutions {reason}" for reason, count in reasons.items())
    raise StepFailed("NO_IK_SOLUTION", f"no joint positions reach the pose{how}")


def group_of(cell: Cell, name: str) -> str:
    """A planning group by its name; an empty one is the arm's where there is one arm.

    Raises:
        StepFailed: INVALID_GROUP_NAME.
    """
    default = "" if cell.description.needs_arm else cell.description.default_group
    group, groups = str(name) or default, cell.description.groups
    if group not in groups:
        reason = f"there is no group '{group[:80]}'; groups: {', '.join(groups)}"
        raise StepFailed("INVALID_GROUP_NAME", reason)
    return group


def scaled(cell: Cell, request: Any) -> PlanningOptions:
    """The step's options with the scaling factors of a request; 0 and what exceeds 1 is 1."""
    factors = request.max_velocity_scaling_factor, request.max_acceleration_scaling_factor
    velocity, acceleration = (float(each) if 0 < each <= 1 else 1.0 for each in factors)
    options = cell.current.options
    return replace(options, velocity_scaling=velocity, acceleration_scaling=acceleration)


def _threshold(value: float, default: float) -> float:
    return float(value) if 0 < value < np.inf else default
