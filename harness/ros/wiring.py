"""The controllers of a cell on the graph: action servers and command topics."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from harness.recording.commands import CommandRecord
from harness.ros.action_server import ActionServer
from harness.ros.contents import (
    follow_content,
    follow_feedback,
    follow_result,
    gripper_content,
    gripper_result,
    trajectory_content,
)
from harness.ros.control.cell import ExternalCell
from harness.ros.control.gripper import Gripped
from harness.ros.graph import Graph
from harness.ros.interfaces import FOLLOW, GRIPPER, TRAJECTORY

FEEDBACK_EVERY = 5
"""Ticks between two messages of feedback: 20 Hz, as controllers are set by default."""


class Wiring:
    """Serves the controllers of a cell.

    Attributes:
        is_open: Whether commands are taken; else goals are rejected and topics ignored.
    """

    def __init__(
        self, graph: Graph, cell: ExternalCell, on_command: Callable[[CommandRecord], None]
    ) -> None:
        self.is_open = False
        self._cell, self._on_command, self._ticks = cell, on_command, 0
        self._servers: list[ActionServer] = []
        for name in cell.trajectories:
            self._serve(
                graph, f"/{name}/follow_joint_trajectory", FOLLOW, partial(self._follow, name)
            )
            graph.subscribe(f"/{name}/joint_trajectory", TRAJECTORY, partial(self._topic, name))
        if cell.gripper is not None:
            name = f"/{cell.gripper.name}/gripper_cmd"
            self._serve(graph, name, GRIPPER, self._grip)

    def after_tick(self) -> None:
        """Report what ended, and how far the others are."""
        self.report()
        self._ticks += 1
        if self._ticks % FEEDBACK_EVERY:
            return
        for tracking in self._cell.tracking():
            for server in self._servers:
                if server.owns(tracking.goal):
                    names = self._cell.trajectories[server.name.split("/")[1]].joint_names
                    server.feedback(tracking.goal, follow_feedback(tracking, names))

    def report(self) -> None:
        """Send the results of goals that ended."""
        outcomes, self._cell.outcomes = self._cell.outcomes, []
        for outcome in outcomes:
            server = next((each for each in self._servers if each.owns(outcome.goal)), None)
            if server is None:  # a trajectory from a topic has no result
                continue
            if isinstance(outcome, Gripped):
                server.finish(outcome.goal, *gripper_result(outcome))
            else:
                server.finish(outcome.goal, *follow_result(outcome))

    def _serve(
        self, graph: Graph, name: str, kind: str, on_goal: Callable[[str, Any], bool]
    ) -> None:
        controller = name.split("/")[1]
        self._servers.append(
            ActionServer(
                graph,
                name,
                kind,
                clock=lambda: self._cell.time,
                on_goal=on_goal,
                on_cancel=partial(self._cancel, controller),
            )
        )

    def _follow(self, name: str, goal: str, content: Any) -> bool:
        if not self.is_open:
            return False
        record = self._cell.receive("trajectory", name, goal, follow_content(content))
        self._take(record)
        return record.answer == "accepted"

    def _grip(self, goal: str, content: Any) -> bool:
        if not self.is_open or self._cell.gripper is None:
            return False
        name = self._cell.gripper.name
        record = self._cell.receive("gripper", name, goal, gripper_content(content))
        self._take(record)
        return record.answer == "accepted"

    def _cancel(self, name: str, goal: str) -> bool:
        record = self._cell.receive("cancel", name, goal)
        self._take(record)
        return record.answer == "accepted"

    def _topic(self, name: str, content: Any) -> None:
        if self.is_open:
            self._take(self._cell.receive("trajectory", name, "", trajectory_content(content)))

    def _take(self, record: CommandRecord) -> None:
        self._on_command(record)
