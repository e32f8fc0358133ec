"""The services of `move_group`: kinematics, plans, and the planning scene."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from harness.cell.cell import Cell
from harness.core.errors import StepFailed
from harness.plugins.ros.bag.messages import message, pose_message
from harness.plugins.ros.endpoints import Reply
from harness.plugins.ros.interfaces import header
from harness.plugins.ros.moveit.goals import path_constraints_of
from harness.plugins.ros.moveit.kept import kept
from harness.plugins.ros.moveit.planning import (
    PLANNERS,
    Planned,
    plan_cartesian_path,
    plan_fields,
    sequence_response,
    solve_pose,
)
from harness.plugins.ros.moveit.requests import Requests
from harness.plugins.ros.moveit.scene_changes import changes_of_scene
from harness.plugins.ros.moveit.values import (
    error_code,
    frame_of,
    link_of,
    positions_of,
    state_message,
)
from harness.plugins.ros.rtps.graph import Graph

SRV = "moveit_msgs/srv/"
EMPTY = "std_srvs/srv/Empty"
Begin = Callable[[Requests, Any, Reply], None]
"""Begins what takes long, of a request, and replies once it is known."""


def serve(graph: Graph, requests: Requests) -> None:
    """Serve them on a graph."""
    for name, kind, answer in (
        ("compute_ik", "GetPositionIK", _inverse),
        ("compute_fk", "GetPositionFK", _forward),
        ("check_state_validity", "GetStateValidity", _validity),
        ("query_planner_interface", "QueryPlannerInterfaces", _planners),
        ("get_planner_params", "GetPlannerParams", _parameters),
        ("get_planning_scene", "GetPlanningScene", partial(_scene, requests)),
        ("apply_planning_scene", "ApplyPlanningScene", partial(_apply, requests)),
    ):
        graph.serve(f"/{name}", SRV + kind, requests.service(answer))
    empty = f"{EMPTY}_Response"
    graph.serve("/clear_octomap", EMPTY, lambda _, reply: reply(message(empty)))  # there is none
    for name, kind, begin in (
        ("plan_kinematic_path", "GetMotionPlan", _plan),
        ("compute_cartesian_path", "GetCartesianPath", _cartesian),
        ("plan_sequence_path", "GetMotionSequence", _sequence),
    ):
        graph.serve(f"/{name}", SRV + kind, partial(_in_turn, requests, begin))


def _inverse(cell: Cell, request: Any) -> Any:
    kind = f"{SRV}GetPositionIK_Response"
    try:
        state = state_message(cell, solve_pose(cell, request.ik_request))
    except StepFailed as failure:
        return message(kind, error_code=error_code(failure))
    return message(kind, solution=state, error_code=error_code(None))


def _forward(cell: Cell, request: Any) -> Any:
    kind = f"{SRV}GetPositionFK_Response"
    names = [str(name) for name in request.fk_link_names]
    if not names:
        failure = StepFailed("INVALID_LINK_NAME", "the request names no link")
        return message(kind, error_code=error_code(failure))
    frame_id = str(request.header.frame_id) or "world"
    try:
        back = frame_of(cell, frame_id).inverse()
        positions = positions_of(cell, request.robot_state)
        links = [link_of(cell, name) for name in names]
    except StepFailed as failure:
        return message(kind, error_code=error_code(failure))
    stamped = [
        message(
            "geometry_msgs/msg/PoseStamped",
            header=header(cell.simulator.time, frame_id),
            pose=pose_message([*(back @ cell.kinematics.link_pose(positions, link)).as_vector()]),
        )
        for link in links
    ]
    return message(kind, pose_stamped=stamped, fk_link_names=names, error_code=error_code(None))


def _validity(cell: Cell, request: Any) -> Any:
    kind = f"{SRV}GetStateValidity_Response"
    try:
        cell.sync_scene()
        positions = positions_of(cell, request.robot_state)
        each = kept(cell, path_constraints_of(cell, request.constraints), positions)
    except StepFailed:
        return message(kind, valid=False)
    results = [
        message(
            "moveit_msgs/msg/ConstraintEvalResult",
            result=one.holds,
            distance=max(0.0, one.excess),
        )
        for one in each
    ]
    is_kept = all(one.holds for one in each)
    touches = cell.scene.touches(positions)
    contacts = [
        message(
            "moveit_msgs/msg/ContactInformation",
            contact_body_1=each.first,
            contact_body_2=each.second,
            depth=-each.distance,
        )
        for each in touches
    ]
    valid = is_kept and not touches
    return message(kind, valid=valid, contacts=contacts, constraint_result=results)


def _planners(_cell: Cell, _request: Any) -> Any:
    kind = "moveit_msgs/msg/PlannerInterfaceDescription"
    each = [
        message(kind, name=name, pipeline_id=name, planner_ids=list(planners))
        for name, planners in PLANNERS.items()
    ]
    return message(f"{SRV}QueryPlannerInterfaces_Response", planner_interfaces=each)


def _parameters(_cell: Cell, _request: Any) -> Any:
    return message(f"{SRV}GetPlannerParams_Response")


def _in_turn(requests: Requests, begin: Begin, request: Any, reply: Reply) -> None:
    requests.in_turn(lambda: begin(requests, request, reply))


def _plan(requests: Requests, request: Any, reply: Reply) -> None:
    cell = requests.here.cell

    def done(planned: Planned | None, code: Any, seconds: float) -> None:
        fields = plan_fields(cell, planned)
        response = message(
            "moveit_msgs/msg/MotionPlanResponse",
            group_name=str(request.motion_plan_request.group_name),
            trajectory=fields["planned_trajectory"],
            trajectory_start=fields["trajectory_start"],
            planning_time=seconds,
            error_code=code,
        )
        reply(message(f"{SRV}GetMotionPlan_Response", motion_plan_response=response))

    requests.plan(request.motion_plan_request, done)


def _sequence(requests: Requests, request: Any, reply: Reply) -> None:
    kind, cell = f"{SRV}GetMotionSequence_Response", requests.here.cell

    def done(planned: Planned | None, code: Any, seconds: float) -> None:
        reply(message(kind, response=sequence_response(cell, planned, code, seconds)))

    if request.request.items:
        requests.plan(request.request, done)
    else:  # as MoveIt
        done(None, error_code(None), 0.0)


def _cartesian(requests: Requests, request: Any, reply: Reply) -> None:
    cell, kind = requests.here.cell, f"{SRV}GetCartesianPath_Response"

    def done(result: tuple[Planned | None, float] | StepFailed) -> None:
        if isinstance(result, StepFailed):
            requests.report(result)
            reply(message(kind, fraction=-1.0, error_code=error_code(result)))
            return
        planned, fraction = result
        fields = plan_fields(cell, planned)
        response = message(
            kind,
            start_state=fields["trajectory_start"],
            solution=fields["planned_trajectory"],
            fraction=fraction,
            error_code=error_code(None),
        )
        reply(response)

    if not request.avoid_collisions:
        requests.note_once("Cartesian paths avoid collisions, also without `avoid_collisions`")
    requests.compute(lambda: plan_cartesian_path(cell, request), done)


def _scene(requests: Requests, _cell: Cell, _request: Any) -> Any:
    return message(f"{SRV}GetPlanningScene_Response", scene=requests.here.as_message())


def _apply(requests: Requests, _cell: Cell, request: Any) -> Any:
    done = requests.change(changes_of_scene, request.scene)
    return message(f"{SRV}ApplyPlanningScene_Response", success=done)
