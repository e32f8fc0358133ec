"""An action client: goals, feedback, results and cancellation, as rclpy's ActionClient."""

from __future__ import annotations

import time
import uuid
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from harness.ros.action_server import Status
from harness.ros.graph import Graph
from harness.ros.interfaces import CANCEL, UUID, message


@dataclass
class ClientGoal:
    """A goal that was sent, and what the server said of it.

    Attributes:
        identifier: The goal's UUID in hex.
        is_accepted: None before the server answered.
        status: How it ended; UNKNOWN before.
        result: The result; None before the end.
        feedback: What arrived, in order.
        cancel_code: The return code of the request to cancel it; None before the answer.
    """

    identifier: str
    is_accepted: bool | None = None
    status: Status = Status.UNKNOWN
    result: Any = None
    feedback: list[Any] = field(default_factory=list[Any])
    cancel_code: int | None = None

    @property
    def is_over(self) -> bool:
        """Whether it was rejected, or its result is there."""
        return self.is_accepted is False or self.result is not None


class ActionClient:
    """Sends goals to one action server."""

    def __init__(self, graph: Graph, name: str, kind: str) -> None:
        self._graph, self.name, self.kind = graph, name, kind
        self._goals: dict[str, ClientGoal] = {}
        self._send = graph.client(f"{name}/_action/send_goal", f"{kind}_SendGoal")
        self._cancel = graph.client(f"{name}/_action/cancel_goal", CANCEL)
        self._result = graph.client(f"{name}/_action/get_result", f"{kind}_GetResult")
        graph.subscribe(f"{name}/_action/feedback", f"{kind}_FeedbackMessage", self._take_feedback)

    @property
    def is_ready(self) -> bool:
        """Whether the server's three services are there."""
        return self._send.is_ready and self._cancel.is_ready and self._result.is_ready

    def wait_until(self, holds: Callable[[], bool], timeout: float) -> bool:
        """Spin until something holds; whether it did within the wall time [s]."""
        deadline = time.monotonic() + timeout
        while not holds():
            if time.monotonic() > deadline:
                return False
            self._graph.spin(min(deadline, time.monotonic() + 0.005))
        return True

    def send(self, goal: Any) -> ClientGoal:
        """Send a goal and request its result; that of a rejected goal may give the reason."""
        sent = ClientGoal(uuid.uuid4().hex)
        self._goals[sent.identifier] = sent

        def answered(response: Any) -> None:
            sent.is_accepted = bool(response.accepted)
            request = message(f"{self.kind}_GetResult_Request", goal_id=_uuid(sent))
            self._result.call(request, ended)

        def ended(response: Any) -> None:
            sent.status, sent.result = Status(response.status), response.result

        request = message(f"{self.kind}_SendGoal_Request", goal_id=_uuid(sent), goal=goal)
        self._send.call(request, answered)
        return sent

    def cancel(self, goal: ClientGoal) -> None:
        """Request that a goal is canceled."""
        info = message("action_msgs/msg/GoalInfo", goal_id=_uuid(goal))

        def answered(response: Any) -> None:
            goal.cancel_code = response.return_code

        self._cancel.call(message(f"{CANCEL}_Request", goal_info=info), answered)

    def _take_feedback(self, content: Any) -> None:
        goal = self._goals.get(bytes(content.goal_id.uuid).hex())
        if goal is not None:
            goal.feedback.append(content.feedback)


def _uuid(goal: ClientGoal) -> Any:
    content = np.frombuffer(bytes.fromhex(goal.identifier), np.uint8)
    return message(UUID, uuid=content)
