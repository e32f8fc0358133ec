"""The services, actions and topics of `move_group`."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from harness.cell.cell import Cell
from harness.core.errors import StepFailed
from harness.plugins.ros.actions import ActionServer
from harness.plugins.ros.control.cell import PREEMPTED, ExternalCell
from harness.plugins.ros.control.controller import Outcome
from harness.plugins.ros.endpoints import LATCHED, Reply
from harness.plugins.ros.interfaces import EXECUTE, MOVE, header, register_move_group
from harness.plugins.ros.moveit.client_scene import ClientScene
from harness.plugins.ros.moveit.planning import (
    PLANNERS,
    Planned,
    plan_cartesian_path,
    plan_motion,
    solve_pose,
    unknown_planner,
)
from harness.plugins.ros.moveit.scene_changes import (
    Change,
    changes_of,
    changes_of_attached,
    changes_of_scene,
)
from harness.plugins.ros.moveit.values import (
    error_code,
    frame_of,
    link_of,
    positions_of,
    robot_trajectory,
    state_message,
)
from harness.plugins.ros.rtps.graph import Graph
from harness.plugins.ros.wiring import trajectory_content
from harness.recording.commands import CommandRecord
from harness.reporting.rosbag.messages import message, pose_message

SRV = "moveit_msgs/srv/"
SCENE = "moveit_msgs/msg/PlanningScene"
FARTHEST_START = 0.01
"""How far a joint may be from the start of a trajectory that is executed [rad or m]: MoveIt's
`allowed_start_tolerance`."""

Work = Callable[[], object]


@dataclass
class _Motion:
    """A goal of an action whose trajectory a controller follows."""

    server: ActionServer
    result: Any


class MoveGroup:
    """Answers MoveIt's clients while a step hands the arm over.

    Requests wait until `work`, between two ticks; simulated time stands still meanwhile.
    """

    def __init__(
        self,
        graph: Graph,
        cell: ExternalCell,
        note: Callable[[CommandRecord], None],
        say: Callable[[str], None],
    ) -> None:
        """Serve MoveIt's names on a graph.

        Args:
            note: Takes each command that a client gave.
            say: Takes sentences for the user: requests that failed, and why.
        """
        register_move_group()
        self._control, self._note, self._say = cell, note, say
        self._waiting: deque[Work] = deque()
        self._running: dict[str, _Motion] = {}
        self._cell: Cell | None = None
        self._serve(graph)
        self._scene_topic = graph.advertise("/monitored_planning_scene", SCENE, LATCHED)
        semantic = graph.advertise("/robot_description_semantic", "std_msgs/msg/String", LATCHED)
        semantic.publish(message("std_msgs/msg/String", data=cell.description.srdf))

    def _serve(self, graph: Graph) -> None:
        for name, kind, answer in (
            ("compute_ik", "GetPositionIK", self._inverse),
            ("compute_fk", "GetPositionFK", self._forward),
            ("plan_kinematic_path", "GetMotionPlan", self._plan),
            ("compute_cartesian_path", "GetCartesianPath", self._cartesian),
            ("get_planning_scene", "GetPlanningScene", self._scene),
            ("apply_planning_scene", "ApplyPlanningScene", self._apply),
            ("check_state_validity", "GetStateValidity", self._validity),
            ("query_planner_interface", "QueryPlannerInterfaces", self._planners),
            ("get_planner_params", "GetPlannerParams", self._parameters),
        ):
            graph.serve(f"/{name}", SRV + kind, self._later(answer))
        for topic, kind, read in (
            ("planning_scene", "PlanningScene", changes_of_scene),
            ("collision_object", "CollisionObject", changes_of),
            ("attached_collision_object", "AttachedCollisionObject", changes_of_attached),
        ):
            graph.subscribe(f"/{topic}", f"moveit_msgs/msg/{kind}", self._take(read))
        control = self._control
        self._move = ActionServer(
            graph, "/move_action", MOVE, lambda: control.time, self._take_move, self._cancel
        )
        self._execute = ActionServer(
            graph, "/execute_trajectory", EXECUTE, lambda: control.time, self._take_trajectory,
            self._cancel,
        )  # fmt: skip

    @property
    def is_open(self) -> bool:
        """Whether requests are answered."""
        return self._cell is not None

    def begin(self, scene: ClientScene) -> None:
        """Answer from now on, about a cell."""
        self._cell = scene.cell
        self._scene_now = scene
        self._scene_topic.publish(scene.as_message())

    def end(self) -> None:
        """Answer no more; what waits is forgotten."""
        self._cell = None
        self._waiting.clear()

    def work(self) -> float:
        """Answer what waits; the wall time that it took [s]."""
        begin = time.monotonic()
        while self._waiting and self._cell is not None:
            self._waiting.popleft()()
        return time.monotonic() - begin

    def finish(self, outcome: Outcome) -> None:
        """Give the client of a trajectory its result."""
        motion = self._running.pop(outcome.goal, None)
        if motion is None:
            return
        failure = None
        if not outcome.has_succeeded:
            reason = str(outcome.result.error_string)
            is_ended = outcome.result.error_code == 0 or reason == PREEMPTED
            failure = StepFailed("PREEMPTED" if is_ended else "CONTROL_FAILED", reason)
        motion.result.error_code = error_code(failure)
        motion.server.finish(outcome.goal, outcome.has_succeeded, motion.result)

    # -- waiting ------------------------------------------------------------------------------

    def _later(self, answer: Callable[[Cell, Any], Any]) -> Callable[[Any, Reply], None]:
        """What takes a request of a service now and answers it in `work`."""

        def take(request: Any, reply: Reply) -> None:
            self._waiting.append(lambda: reply(answer(self._here(), request)))

        return take

    def _take(self, read: Callable[[Cell, Any], Any]) -> Callable[[Any], None]:
        """What takes a message of a topic that changes the planning scene."""
        return lambda content: self._waiting.append(lambda: self._change(read, content))

    def _here(self) -> Cell:
        if self._cell is None:
            raise StepFailed("FAILURE", "the arm is not handed over")
        return self._cell

    # -- the planning scene -------------------------------------------------------------------

    def _change(self, read: Callable[[Cell, Any], Any], content: Any) -> bool:
        """Change the planning scene as a message says; whether it could be done."""
        try:
            changes: list[Change] = [*read(self._here(), content)]
        except StepFailed as failure:
            self._say(f"t={self._control.time:.2f} s: planning scene: {failure}")
            return False
        if not changes:
            return True
        record = self._control.receive("scene", changes=changes)
        self._note(record)
        self._scene_topic.publish(self._scene_now.as_message())
        return record.answer == "accepted"

    def _apply(self, _cell: Cell, request: Any) -> Any:
        done = self._change(changes_of_scene, request.scene)
        return message(f"{SRV}ApplyPlanningScene_Response", success=done)

    def _scene(self, _cell: Cell, _request: Any) -> Any:
        return message(f"{SRV}GetPlanningScene_Response", scene=self._scene_now.as_message())

    # -- kinematics ---------------------------------------------------------------------------

    def _inverse(self, cell: Cell, request: Any) -> Any:
        kind = f"{SRV}GetPositionIK_Response"
        try:
            state = state_message(cell, solve_pose(cell, request.ik_request))
        except StepFailed as failure:
            return message(kind, error_code=error_code(failure))
        return message(kind, solution=state, error_code=error_code(None))

    def _forward(self, cell: Cell, request: Any) -> Any:
        kind = f"{SRV}GetPositionFK_Response"
        names = [str(name) for name in request.fk_link_names] or [cell.description.tcp_link]
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
                pose=pose_message(
                    [*(back @ cell.kinematics.link_pose(positions, link)).as_vector()]
                ),
            )
            for link in links
        ]
        return message(kind, pose_stamped=stamped, fk_link_names=names, error_code=error_code(None))

    def _validity(self, cell: Cell, request: Any) -> Any:
        kind = f"{SRV}GetStateValidity_Response"
        try:
            cell.sync_scene()
            positions = positions_of(cell, request.robot_state)
        except StepFailed:
            return message(kind, valid=False)
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
        return message(kind, valid=not touches, contacts=contacts)

    # -- planning -----------------------------------------------------------------------------

    def _planned(self, cell: Cell, request: Any) -> tuple[Planned | None, Any, float]:
        """The plan of a request, its error code, and the wall time that it took [s]."""
        begin = time.monotonic()
        if note := unknown_planner(request):
            self._say(f"{note}; the default plans instead, as with MoveIt")
        try:
            planned, failure = plan_motion(cell, request), None
        except StepFailed as error:
            planned, failure = None, error
            self._say(f"t={self._control.time:.2f} s: {failure}")
        goal = str(request.group_name) or cell.description.default_group
        answer = "planned" if failure is None else str(failure)
        self._control.receive("plan", goal="", group=goal, answer=answer)
        return planned, error_code(failure), time.monotonic() - begin

    def _plan(self, cell: Cell, request: Any) -> Any:
        planned, code, seconds = self._planned(cell, request.motion_plan_request)
        fields = _plan_fields(cell, planned)
        response = message(
            "moveit_msgs/msg/MotionPlanResponse",
            group_name=str(request.motion_plan_request.group_name),
            trajectory=fields["planned_trajectory"],
            trajectory_start=fields["trajectory_start"],
            planning_time=seconds,
            error_code=code,
        )
        return message(f"{SRV}GetMotionPlan_Response", motion_plan_response=response)

    def _cartesian(self, cell: Cell, request: Any) -> Any:
        kind = f"{SRV}GetCartesianPath_Response"
        try:
            planned, fraction = plan_cartesian_path(cell, request)
        except StepFailed as failure:
            self._say(f"t={self._control.time:.2f} s: {failure}")
            return message(kind, fraction=-1.0, error_code=error_code(failure))
        fields = _plan_fields(cell, planned)
        return message(
            kind,
            start_state=fields["trajectory_start"],
            solution=fields["planned_trajectory"],
            fraction=fraction,
            error_code=error_code(None),
        )

    def _planners(self, _cell: Cell, _request: Any) -> Any:
        kind = "moveit_msgs/msg/PlannerInterfaceDescription"
        each = [
            message(kind, name=name, pipeline_id=name, planner_ids=list(planners))
            for name, planners in PLANNERS.items()
        ]
        return message(f"{SRV}QueryPlannerInterfaces_Response", planner_interfaces=each)

    def _parameters(self, _cell: Cell, _request: Any) -> Any:
        return message(f"{SRV}GetPlannerParams_Response")

    # -- motions ------------------------------------------------------------------------------

    def _take_move(self, goal: str, content: Any) -> bool:
        if self._cell is not None:
            self._waiting.append(lambda: self._move_now(goal, content))
        return self._cell is not None

    def _move_now(self, goal: str, content: Any) -> None:
        cell, options = self._here(), content.planning_options
        if not self._change(changes_of_scene, options.planning_scene_diff):
            code = error_code(StepFailed("FAILURE", "planning_scene_diff cannot be applied"))
            result = message(f"{MOVE}_Result", error_code=code)
            self._move.finish(goal, has_succeeded=False, result=result)
            return
        planned, code, seconds = self._planned(cell, content.request)
        fields = _plan_fields(cell, planned)
        result = message(f"{MOVE}_Result", error_code=code, planning_time=seconds, **fields)
        if planned is None or options.plan_only:
            self._move.finish(goal, has_succeeded=planned is not None, result=result)
            return
        result.executed_trajectory = result.planned_trajectory
        self._follow(goal, self._move, result, result.planned_trajectory)

    def _take_trajectory(self, goal: str, content: Any) -> bool:
        result = message(f"{EXECUTE}_Result")
        if self._cell is not None:
            self._waiting.append(
                lambda: self._follow(goal, self._execute, result, content.trajectory)
            )
        return self._cell is not None

    def _follow(self, goal: str, server: ActionServer, result: Any, trajectory: Any) -> None:
        """Give a trajectory to the controller that has its joints."""
        joints = trajectory.joint_trajectory
        name = self._controller_of([str(each) for each in joints.joint_names])
        self._running[goal] = _Motion(server, result)
        if reason := self._start_error(joints) if name else "no controller has these joints":
            self._running.pop(goal)
            result.error_code = error_code(StepFailed("CONTROL_FAILED", reason))
            self._say(f"t={self._control.time:.2f} s: CONTROL_FAILED: {reason}")
            server.finish(goal, has_succeeded=False, result=result)
            return
        self._note(self._control.receive("trajectory", name, goal, **trajectory_content(joints)))

    def _controller_of(self, joints: list[str]) -> str:
        for name, controller in self._control.controllers.items():
            fits = {joint.name for joint in controller.joints} == {*joints}
            if fits and "trajectory" in controller.kinds:
                return name
        return ""

    def _start_error(self, trajectory: Any) -> str:
        """Why a trajectory cannot be begun from where the arm is; empty where it can."""
        if not trajectory.points:
            return "the trajectory has no points"
        now, index = self._here().planning_start(), self._here().description.joint_index
        first = trajectory.points[0]
        if len(first.positions) != len(trajectory.joint_names):
            return "the first point has another number of positions than there are joints"
        for name, value in zip(trajectory.joint_names, first.positions, strict=True):
            off = abs(float(value) - now[index[str(name)]])
            if not off <= FARTHEST_START:
                return (
                    f"the trajectory begins {off:.4g} rad or m from where {name} is; plan from the"
                    " present state"
                )
        return ""

    def _cancel(self, goal: str) -> None:
        self._note(self._control.receive("cancel", goal=goal))


def _plan_fields(cell: Cell, planned: Planned | None) -> dict[str, Any]:
    """The fields of a result that a plan fills."""
    if planned is None:
        return {
            "trajectory_start": message("moveit_msgs/msg/RobotState"),
            "planned_trajectory": robot_trajectory(None),
        }
    return {
        "trajectory_start": state_message(cell, planned.start),
        "planned_trajectory": robot_trajectory(planned.plan.trajectory),
    }
