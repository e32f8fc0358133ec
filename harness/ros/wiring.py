"""The controllers of a cell on the graph: action servers and command topics."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from harness.core.types import FloatArray
from harness.recording.commands import CommandKind, CommandRecord
from harness.reporting.rosbag.messages import message
from harness.ros.actions import ActionServer
from harness.ros.control.cell import ExternalCell
from harness.ros.control.controller import Window
from harness.ros.graph import Graph
from harness.ros.interfaces import FOLLOW, GRIPPER, POINT, TRAJECTORY, header, seconds

FEEDBACK_EVERY = 5
"""Ticks between two messages of feedback: 20 Hz, as controllers are set by default."""

Content = dict[str, Any]
"""The values of a command as they are recorded."""


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
        serve = partial(self._serve, graph)
        self._servers: list[ActionServer] = []
        for name in cell.trajectories:
            action = f"/{name}/follow_joint_trajectory"
            self._servers.append(serve("trajectory", name, action, FOLLOW, follow_content))
            graph.subscribe(f"/{name}/joint_trajectory", TRAJECTORY, partial(self._topic, name))
        if cell.gripper is not None:
            name = cell.gripper.name
            action = f"/{name}/gripper_cmd"
            self._servers.append(serve("gripper", name, action, GRIPPER, grip_content))

    def after_tick(self) -> None:
        """Report what ended, and how far the others are."""
        self.report()
        self._ticks += 1
        if self._ticks % FEEDBACK_EVERY:
            return
        for controller, window in self._cell.tracking():
            for server in self._servers:
                if server.owns(controller.goal):
                    content = follow_feedback(controller.joint_names, window)
                    server.feedback(controller.goal, content)

    def report(self) -> None:
        """Send the results of goals that ended; a trajectory from a topic has none."""
        outcomes, self._cell.outcomes = self._cell.outcomes, []
        for outcome in outcomes:
            for server in self._servers:
                if server.owns(outcome.goal):
                    server.finish(outcome.goal, outcome.has_succeeded, outcome.result)

    def _serve(
        self,
        graph: Graph,
        kind: CommandKind,
        controller: str,
        action: str,
        action_type: str,
        content: Callable[[Any], Content],
    ) -> ActionServer:
        return ActionServer(
            graph,
            action,
            action_type,
            clock=lambda: self._cell.time,
            on_goal=lambda goal, sent: self._take(kind, controller, goal, content(sent)),
            on_cancel=lambda goal: self._take("cancel", controller, goal, {}),
        )

    def _topic(self, name: str, sent: Any) -> None:
        self._take("trajectory", name, "", trajectory_content(sent))

    def _take(self, kind: CommandKind, name: str, goal: str, content: Content) -> bool:
        """Let a command take effect; whether it was accepted."""
        if not self.is_open:
            return False
        record = self._cell.receive(kind, name, goal, content)
        self._on_command(record)
        return record.answer == "accepted"


def trajectory_content(trajectory: Any) -> Content:
    """The content of a JointTrajectory."""
    return {
        "joint_names": [str(name) for name in trajectory.joint_names],
        "stamp": seconds(trajectory.header.stamp),
        "points": [
            {
                "time": seconds(point.time_from_start),
                "positions": point.positions.tolist(),
                "velocities": point.velocities.tolist(),
                "accelerations": point.accelerations.tolist(),
            }
            for point in trajectory.points
        ],
    }


def follow_content(goal: Any) -> Content:
    """The content of a goal of FollowJointTrajectory."""
    path, end = (
        [{"name": str(t.name), "position": t.position, "velocity": t.velocity} for t in tolerances]
        for tolerances in (goal.path_tolerance, goal.goal_tolerance)
    )
    return {
        **trajectory_content(goal.trajectory),
        "path_tolerance": path,
        "goal_tolerance": end,
        "goal_time": seconds(goal.goal_time_tolerance),
    }


def grip_content(goal: Any) -> Content:
    """The content of a goal of GripperCommand."""
    return {"position": goal.command.position, "max_effort": goal.command.max_effort}


def follow_feedback(names: tuple[str, ...], window: Window) -> Any:
    """Feedback of a trajectory that is followed."""

    def point(motion: FloatArray) -> Any:
        positions, velocities = np.ascontiguousarray(motion)
        return message(POINT, positions=positions, velocities=velocities)

    desired, actual = window.desired[:2, -1], window.measured[:, -1]
    return message(
        f"{FOLLOW}_Feedback",
        header=header(float(window.times[-1])),
        joint_names=list(names),
        desired=point(desired),
        actual=point(actual),
        error=point(desired - actual),
    )
