"""The actions of `move_group`: goals that wait, are planned, and are followed by a controller."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from harness.core.errors import StepFailed
from harness.plugins.ros.actions import ActionServer
from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.control.cell import CANCELED, PREEMPTED
from harness.plugins.ros.control.controller import Outcome
from harness.plugins.ros.control.goals import MOTION, Code
from harness.plugins.ros.control.trajectory import follow_result
from harness.plugins.ros.interfaces import EXECUTE, MOVE, SEQUENCE
from harness.plugins.ros.moveit.planning import Planned, plan_fields, sequence_response
from harness.plugins.ros.moveit.requests import Requests
from harness.plugins.ros.moveit.scene_changes import changes_of_scene
from harness.plugins.ros.moveit.values import error_code
from harness.plugins.ros.rtps.graph import Graph
from harness.plugins.ros.wiring import Content, trajectory_content

FARTHEST_START = 0.01
"""How far a joint may be from the start of a trajectory that is executed [rad or m]: MoveIt's
`allowed_start_tolerance`."""

EVENTS = "/trajectory_execution_event"
"""The topic with which clients of MoveIt stop what is executed, by the word `stop`."""


@dataclass
class _Goal:
    """A goal of an action, and the result that its client will get.

    Attributes:
        content: What the client sent.
        is_followed: Whether a controller follows its trajectory; before that it waits.
    """

    server: ActionServer
    content: Any
    result: Any
    is_followed: bool = False


class Motions:
    """Serves `move_action`, `execute_trajectory` and `sequence_move_group`."""

    def __init__(self, graph: Graph, requests: Requests) -> None:
        """Serve them on a graph."""
        self._requests, self._control = requests, requests.control
        self._goals: dict[str, _Goal] = {}
        self._parts: dict[str, str] = {}  # what a controller follows -> the goal it is a part of
        clock = lambda: requests.control.time  # noqa: E731 - one function for both
        self._servers = [
            ActionServer(graph, f"/{name}", kind, clock, partial(self._take, place), self._cancel)
            for place, (name, kind) in enumerate(
                (
                    ("move_action", MOVE),
                    ("execute_trajectory", EXECUTE),
                    ("sequence_move_group", SEQUENCE),
                )
            )
        ]
        graph.subscribe(EVENTS, "std_msgs/msg/String", self._take_event)

    def end(self) -> None:
        """End the goals that still wait, which nothing will plan."""
        for goal in [*self._goals]:
            if not self._goals[goal].is_followed:
                self._finish(goal, StepFailed("ABORT", "the session ended before this goal"))

    def finish(self, outcome: Outcome) -> None:
        """Give the client of a trajectory its result."""
        goal = self._parts.pop(outcome.goal, "")
        if goal not in self._goals:
            return
        others = [part for part, whole in self._parts.items() if whole == goal]
        # the result of a GripperCommand has no reason; without success it was interrupted
        reason = str(
            getattr(outcome.result, "error_string", "" if outcome.has_succeeded else PREEMPTED)
        )
        if outcome.has_succeeded and reason != CANCELED:
            if not others:
                self._finish(goal)
            return
        code = "PREEMPTED" if reason in (PREEMPTED, CANCELED) else "CONTROL_FAILED"
        self._finish(goal, StepFailed(code, reason))
        for part in others:  # between two ticks, so that a replay does the same
            self._requests.put(partial(self._stop, part))

    def _take(self, place: int, goal: str, content: Any) -> bool:
        if self._requests.scene is None:
            return False
        server = self._servers[place]
        self._goals[goal] = _Goal(server, content, message(f"{server.kind}_Result"))
        begin = self._execute if server.kind == EXECUTE else self._plan
        self._requests.in_turn(lambda: begin(goal) if goal in self._goals else None)
        return True

    def _cancel(self, goal: str) -> None:
        known = self._goals.get(goal)
        if known is not None and not known.is_followed:
            self._finish(goal, StepFailed("PREEMPTED", f"{CANCELED} before it was begun"))
            return
        for part in [part for part, whole in self._parts.items() if whole == goal]:
            self._stop(part)

    def _stop(self, part: str) -> None:
        if part in self._parts:
            self._requests.note(self._control.receive("cancel", goal=part))

    def _take_event(self, event: Any) -> None:
        """Stop what is executed, and what waits to be."""
        if str(event.data) == "stop":
            for goal in [*self._goals]:
                self._cancel(goal)

    def _finish(self, goal: str, failure: StepFailed | None = None) -> None:
        known = self._goals.pop(goal)
        getattr(known.result, "response", known.result).error_code = error_code(failure)
        self._end(goal, known, has_succeeded=failure is None)

    def _end(self, goal: str, known: _Goal, *, has_succeeded: bool) -> None:
        _publish_state(goal, known, "IDLE")
        known.server.finish(goal, has_succeeded, known.result)

    def _plan(self, goal: str) -> None:
        """Plan a goal, and follow the plan unless it is requested alone."""
        known, requests = self._goals[goal], self._requests
        _publish_state(goal, known, "PLANNING")
        options, cell = known.content.planning_options, requests.here.cell
        for name in ("replan", "look_around"):
            if getattr(options, name):
                requests.note_once(f"`{name}` of a goal has no effect: it is planned once")
        try:
            diff = [*changes_of_scene(cell, options.planning_scene_diff)]
        except StepFailed as failure:
            requests.report(failure)
            self._finish(goal, failure)
            return

        def done(planned: Planned | None, code: Any, seconds: float) -> None:
            planned_fields, kind = plan_fields(cell, planned), known.server.kind
            if kind == SEQUENCE:
                fields = {"response": sequence_response(cell, planned, code, seconds)}
            else:
                fields = {"error_code": code, "planning_time": seconds, **planned_fields}
            known.result = message(f"{kind}_Result", **fields)
            if planned is None or options.plan_only:
                self._end(goal, self._goals.pop(goal), has_succeeded=planned is not None)
                return
            trajectory = planned_fields["planned_trajectory"]
            if kind == MOVE:
                known.result.executed_trajectory = trajectory
            self._follow(goal, trajectory)

        content = known.content.request
        if known.server.kind == SEQUENCE and not content.items:  # as MoveIt
            self._finish(goal)
            return
        requests.plan(content, done, diff=diff, is_awaited=lambda: goal in self._goals)

    def _execute(self, goal: str) -> None:
        self._follow(goal, self._goals[goal].content.trajectory)

    def _follow(self, goal: str, trajectory: Any) -> None:
        """Give a trajectory to the controller that has its joints, or to several that have."""
        joints, description = trajectory.joint_trajectory, self._control.description
        named = {str(each) for each in joints.joint_names}
        followers = {each.name for each in description.movable_joints if each.mimic}
        names = self._controllers_of(named - followers)
        if reason := self._start_error(joints) if names else "no controllers have these joints":
            failure = StepFailed("CONTROL_FAILED", reason)
            self._requests.report(failure)
            self._finish(goal, failure)
            return
        self._goals[goal].is_followed = True
        _publish_state(goal, self._goals[goal], "MONITOR")
        content = trajectory_content(joints)
        parts = {name: f"{goal}:{place}" if place else goal for place, name in enumerate(names)}
        self._parts |= dict.fromkeys(parts.values(), goal)
        for name, part in parts.items():
            if goal not in self._goals:  # another part was refused
                del self._parts[part]
                continue
            self._begin_part(name, part, content)

    def _begin_part(self, name: str, part: str, content: Content) -> None:
        """Give a controller its share: a gripper the last position, as MoveIt's manager does."""
        controller = self._control.controllers[name]
        own = [joint.name for joint in controller.joints]
        share = content if {*content["joint_names"]} == {*own} else _share(content, own)
        if controller.gripper is None:
            record = self._control.receive("trajectory", name, part, **share)
        else:
            last = {"position": share["points"][-1]["positions"][0], "max_effort": 0.0}
            record = self._control.receive("gripper", name, part, **last)
            if record.has_failed:
                self.finish(Outcome(part, False, follow_result(Code.INVALID_GOAL, record.answer)))
        self._requests.note(record)

    def _controllers_of(self, joints: set[str]) -> list[str]:
        """Controllers that have some joints, and no others; none where a joint is left over."""
        found: dict[int, str] = {}
        for name, controller in self._control.controllers.items():
            if joints.issuperset(joint.name for joint in controller.joints):
                found.setdefault(id(controller), name)
        chosen = [self._control.controllers[name] for name in found.values()]
        covered = {joint.name for each in chosen for joint in each.joints}
        return [*found.values()] if covered == joints else []

    def _start_error(self, trajectory: Any) -> str:
        """Why a trajectory cannot be begun from where the arm is; empty where it can."""
        if not trajectory.points:
            return "the trajectory has no points"
        cell = self._requests.here.cell
        now, index = cell.planning_start(), cell.description.joint_index
        first, count = trajectory.points[0], len(trajectory.joint_names)
        for place, point in enumerate(trajectory.points):
            if any(len(getattr(point, key)) not in (0, count) for key in MOTION):
                return f"point {place} has not one number for each of {count} joints"
        if len(first.positions) != count or not len(trajectory.points[-1].positions):
            return "the first or the last point has no positions"
        for name, value in zip(trajectory.joint_names, first.positions, strict=True):
            off = abs(float(value) - now[index[str(name)]])
            if not off <= FARTHEST_START:
                return (
                    f"the trajectory begins {off:.4g} rad or m from where {name} is; plan from the"
                    " present state"
                )
        return ""


def _share(content: Content, joints: Sequence[str]) -> Content:
    """What a trajectory holds for some of its joints."""
    columns = [content["joint_names"].index(name) for name in joints]
    points = [
        {"time": point["time"]}
        | {key: [point[key][c] for c in columns] if point[key] else [] for key in MOTION}
        for point in content["points"]
    ]
    return {**content, "joint_names": list(joints), "points": points}


def _publish_state(goal: str, known: _Goal, word: str) -> None:
    """Send a goal's feedback, in MoveIt's words."""
    known.server.feedback(goal, message(f"{known.server.kind}_Feedback", state=word))
