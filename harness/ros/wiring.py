"""The controllers of a cell on the graph: action servers and command topics."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from harness.core.types import FloatArray
from harness.recording.commands import CommandKind, CommandRecord
from harness.reporting.rosbag.messages import message
from harness.ros.actions import ActionServer
from harness.ros.control.cell import ExternalCell
from harness.ros.control.controller import Outcome, Window
from harness.ros.control.goals import MOTION
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
        self._servers: list[ActionServer] = []
        cell.on_outcome = self._report
        actions = {
            "trajectory": ("follow_joint_trajectory", FOLLOW, follow_content),
            "gripper": ("gripper_cmd", GRIPPER, grip_content),
        }
        for name, controller in cell.controllers.items():
            on_message = partial(self._take, "trajectory", name, trajectory_content, "")
            graph.subscribe(f"/{name}/joint_trajectory", TRAJECTORY, on_message)
            for kind in controller.start:
                action, action_type, content = actions[kind]
                server = ActionServer(
                    graph,
                    f"/{name}/{action}",
                    action_type,
                    clock=lambda: cell.time,
                    on_goal=partial(self._take, kind, name, content),
                    on_cancel=partial(self._take, "cancel", name, dict),
                )
                self._servers.append(server)

    def after_tick(self) -> None:
        """Say now and then how far goals are."""
        self._ticks += 1
        if self._ticks % FEEDBACK_EVERY:
            return
        for controller, window in self._cell.tracking():
            for server in self._servers:
                if server.kind == FOLLOW and server.owns(controller.goal):
                    content = follow_feedback(controller.joint_names, window)
                    server.feedback(controller.goal, content)

    def _report(self, outcome: Outcome) -> None:
        """Send the result of a goal that ended; a trajectory from a topic has none."""
        for server in self._servers:
            if server.owns(outcome.goal):
                server.finish(outcome.goal, outcome.has_succeeded, outcome.result)

    def _take(
        self,
        kind: CommandKind,
        name: str,
        content: Callable[[Any], Content],
        goal: str,
        sent: Any = (),
    ) -> bool:
        """Let a command take effect; whether it was accepted."""
        if not self.is_open:
            return False
        record = self._cell.receive(kind, name, goal, content(sent))
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
                **{key: getattr(point, key).tolist() for key in MOTION},
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


def follow_feedback(names: Sequence[str], window: Window) -> Any:
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
