"""Action servers and clients from services and topics, as rcl_action makes them."""

from __future__ import annotations

import uuid
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any

import numpy as np

from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.endpoints import LATCHED, Reply
from harness.plugins.ros.interfaces import CANCEL, UUID, seconds, stamp
from harness.plugins.ros.rtps.graph import Graph

INFO = "action_msgs/msg/GoalInfo"
STATUSES = "action_msgs/msg/GoalStatusArray"
Clock = Callable[[], float]  # the simulated time [s]
OnGoal = Callable[[str, Any], bool]
"""Takes a goal's identifier and content; whether it is accepted. A rejected goal may have a result
already, for those who request it nevertheless."""
OnCancel = Callable[[str], object]  # takes the identifier of a running goal, which has to end then
MOST_ENDED = 100  # goals that are kept after their end, for those who request the result later


class Status(IntEnum):
    """States of a goal (action_msgs/GoalStatus)."""

    UNKNOWN = 0
    ACCEPTED = 1
    EXECUTING = 2
    CANCELING = 3
    SUCCEEDED = 4
    CANCELED = 5
    ABORTED = 6


class CancelCode(IntEnum):
    """Return codes of a request to cancel."""

    NONE = 0
    UNKNOWN_GOAL = 2
    TERMINATED = 3


@dataclass
class _Goal:
    """A goal: its GoalStatus as it is published, its result, and who waits for that."""

    entry: Any
    result: Any = None
    waiting: list[Reply] = field(default_factory=list[Reply])


class ActionServer:
    """Serves one action; the caller decides about goals, and reports their end."""

    def __init__(
        self, graph: Graph, name: str, kind: str, clock: Clock, on_goal: OnGoal, on_cancel: OnCancel
    ) -> None:
        """Serve an action, such as `/arm_controller/follow_joint_trajectory`, from now on."""
        self.name, self.kind = name, kind
        self._clock, self._on_goal, self._on_cancel = clock, on_goal, on_cancel
        self._goals: dict[str, _Goal] = {}
        self._feedback = graph.advertise(f"{name}/_action/feedback", f"{kind}_FeedbackMessage")
        self._status = graph.advertise(f"{name}/_action/status", STATUSES, LATCHED)
        graph.serve(f"{name}/_action/send_goal", f"{kind}_SendGoal", self._take_goal)
        graph.serve(f"{name}/_action/cancel_goal", CANCEL, self._take_cancel)
        graph.serve(f"{name}/_action/get_result", f"{kind}_GetResult", self._take_request)

    def feedback(self, goal: str, content: Any) -> None:
        """Publish feedback of a goal, if it is one of this server."""
        if goal in self._goals:
            kind = f"{self.kind}_FeedbackMessage"
            self._feedback.publish(message(kind, goal_id=uuid_of(goal), feedback=content))

    def finish(self, goal: str, has_succeeded: bool, result: Any) -> None:
        """End a goal, if it is one of this server; who requested its result gets it."""
        known = self._goals.get(goal)
        if known is None:
            return
        known.result = result
        if known.entry.status == Status.CANCELING:
            known.entry.status = Status.CANCELED
        elif known.entry.status != Status.UNKNOWN:  # which a rejected goal keeps
            known.entry.status = Status.SUCCEEDED if has_succeeded else Status.ABORTED
        for reply in known.waiting:
            reply(self._response(known))
        known.waiting.clear()
        self._publish_status()
        ended = [each for each, known in self._goals.items() if known.result is not None]
        for each in ended[:-MOST_ENDED]:
            del self._goals[each]

    def _take_goal(self, request: Any, reply: Reply) -> None:
        goal = hex_of(request.goal_id)
        accepted = goal not in self._goals
        if accepted:
            info = message(INFO, goal_id=request.goal_id, stamp=stamp(self._clock()))
            known = self._goals[goal] = _Goal(message("action_msgs/msg/GoalStatus", goal_info=info))
            accepted = self._on_goal(goal, request.goal)
            if accepted:
                known.entry.status = Status.EXECUTING
            elif known.result is None:
                del self._goals[goal]
        kind = f"{self.kind}_SendGoal_Response"
        reply(message(kind, accepted=accepted, stamp=stamp(self._clock())))
        if accepted:
            self._publish_status()

    def _take_request(self, request: Any, reply: Reply) -> None:
        known = self._goals.get(hex_of(request.goal_id))
        if known is not None and known.result is None:
            known.waiting.append(reply)
        else:
            reply(self._response(known))

    def _take_cancel(self, request: Any, reply: Reply) -> None:
        info = request.goal_info
        goal, before = hex_of(info.goal_id), seconds(info.stamp)
        is_named = any(info.goal_id.uuid)
        running = {each: known.entry for each, known in self._goals.items() if known.result is None}
        canceling = {
            each: entry
            for each, entry in running.items()
            if (is_named and each == goal)
            or (before and seconds(entry.goal_info.stamp) <= before)
            or not (is_named or before)
        }
        code = CancelCode.NONE
        if is_named and goal not in running:
            code = CancelCode.TERMINATED if goal in self._goals else CancelCode.UNKNOWN_GOAL
        for each, entry in canceling.items():
            entry.status = Status.CANCELING
            self._on_cancel(each)
        infos = [entry.goal_info for entry in canceling.values()]
        reply(message(f"{CANCEL}_Response", return_code=int(code), goals_canceling=infos))

    def _response(self, known: _Goal | None) -> Any:
        fields = {"status": known.entry.status, "result": known.result} if known else {}
        return message(f"{self.kind}_GetResult_Response", **fields)

    def _publish_status(self) -> None:
        states = (known.entry for known in self._goals.values())
        known = [entry for entry in states if entry.status != Status.UNKNOWN]
        self._status.publish(message(STATUSES, status_list=known))


def uuid_of(goal: str) -> Any:
    """The message with a goal's identifier."""
    return message(UUID, uuid=np.frombuffer(bytes.fromhex(goal), np.uint8))


def hex_of(uuid: Any) -> str:
    """The identifier in a message."""
    return bytes(uuid.uuid).hex()


@dataclass
class ClientGoal:
    """A goal that was sent, by its UUID in hex, and what the server answered.

    Attributes:
        is_accepted: None before the server answered.
        status: How it ended; UNKNOWN before.
    """

    identifier: str
    is_accepted: bool | None = None
    status: Status = Status.UNKNOWN
    result: Any = None
    feedback: list[Any] = field(default_factory=list[Any])

    @property
    def is_over(self) -> bool:
        """Whether it was rejected, or its result is there."""
        return self.is_accepted is False or self.result is not None


class ActionClient:
    """Sends goals to one action server."""

    def __init__(self, graph: Graph, name: str, kind: str) -> None:
        self.name, self.kind = name, kind
        self._goals: dict[str, ClientGoal] = {}
        self._send = graph.client(f"{name}/_action/send_goal", f"{kind}_SendGoal")
        self._cancel = graph.client(f"{name}/_action/cancel_goal", CANCEL)
        self._result = graph.client(f"{name}/_action/get_result", f"{kind}_GetResult")
        graph.subscribe(f"{name}/_action/feedback", f"{kind}_FeedbackMessage", self._take_feedback)

    @property
    def is_ready(self) -> bool:
        """Whether the server's three services are there."""
        return all(each.is_ready() for each in (self._send, self._cancel, self._result))

    def send(self, goal: Any) -> ClientGoal:
        """Send a goal and request its result; that of a rejected goal may give the reason."""
        sent = ClientGoal(uuid.uuid4().hex)
        self._goals[sent.identifier] = sent

        def answered(response: Any) -> None:
            sent.is_accepted = bool(response.accepted)
            request = message(f"{self.kind}_GetResult_Request", goal_id=uuid_of(sent.identifier))
            self._result.call(request, ended)

        def ended(response: Any) -> None:
            sent.status, sent.result = Status(response.status), response.result

        kind, identifier = f"{self.kind}_SendGoal_Request", uuid_of(sent.identifier)
        self._send.call(message(kind, goal_id=identifier, goal=goal), answered)
        return sent

    def cancel(self, goal: ClientGoal) -> None:
        """Request that a goal is canceled."""
        info = message(INFO, goal_id=uuid_of(goal.identifier))
        self._cancel.call(message(f"{CANCEL}_Request", goal_info=info), lambda _: None)

    def _take_feedback(self, content: Any) -> None:
        goal = self._goals.get(hex_of(content.goal_id))
        if goal is not None:
            goal.feedback.append(content.feedback)
