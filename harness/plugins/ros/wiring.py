"""The controllers of a cell on the graph: action servers and command topics."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from harness.plugins.ros.actions import ActionServer
from harness.plugins.ros.control.cell import ExternalCell
from harness.plugins.ros.control.controller import Outcome
from harness.plugins.ros.control.goals import MOTION
from harness.plugins.ros.interfaces import FOLLOW, GRIPPER, TRAJECTORY, seconds
from harness.plugins.ros.rtps.graph import Graph
from harness.recording.commands import CommandKind, CommandRecord

Content = dict[str, Any]  # the values of a command as they are recorded
Read = Callable[[Any], Content]  # reads them from a message


class Wiring:
    """Serves the controllers of a cell.

    Attributes:
        is_open: Whether commands are taken; else goals are rejected and topics ignored.
    """

    def __init__(
        self, graph: Graph, cell: ExternalCell, on_command: Callable[[CommandRecord], None]
    ) -> None:
        self.is_open = False
        self._cell, self._on_command = cell, on_command
        self._servers: list[ActionServer] = []
        cell.on_outcome = self._report
        for name, controller in cell.controllers.items():
            on_message = partial(self._take, "trajectory", name, trajectory_content, "")
            graph.subscribe(f"/{name}/joint_trajectory", TRAJECTORY, on_message)
            for kind in controller.kinds:
                action, action_type, read = ACTIONS[kind]
                take = partial(self._take, kind, name, read)
                cancel = partial(self._take, "cancel", name, dict)
                server = ActionServer(
                    graph, f"/{name}/{action}", action_type, lambda: cell.time, take, cancel
                )
                self._servers.append(server)

    def publish_feedback(self) -> None:
        """Say how far goals are."""
        for goal, content in self._cell.feedback():
            for server in self._servers:
                server.feedback(goal, content)

    def _report(self, outcome: Outcome) -> None:
        """Send the result of a goal that ended; a trajectory from a topic has none."""
        for server in self._servers:
            server.finish(outcome.goal, outcome.has_succeeded, outcome.result)

    def _take(self, kind: CommandKind, name: str, read: Read, goal: str, sent: Any = ()) -> bool:
        """Let a command take effect; whether it was accepted."""
        if not self.is_open:
            return False
        record = self._cell.receive(kind, name, goal, **read(sent))
        self._on_command(record)
        return record.answer == "accepted"


def trajectory_content(trajectory: Any) -> Content:
    """The content of a JointTrajectory."""
    points = [
        {"time": seconds(point.time_from_start)}
        | {key: getattr(point, key).tolist() for key in MOTION}
        for point in trajectory.points
    ]
    names = [str(name) for name in trajectory.joint_names]
    return {"joint_names": names, "stamp": seconds(trajectory.header.stamp), "points": points}


def follow_content(goal: Any) -> Content:
    """The content of a goal of FollowJointTrajectory."""
    content = trajectory_content(goal.trajectory)
    for key in ("path_tolerance", "goal_tolerance"):
        content[key] = [
            {"name": str(each.name), "position": each.position, "velocity": each.velocity}
            for each in getattr(goal, key)
        ]
    content["goal_time"] = seconds(goal.goal_time_tolerance)
    return content


def grip_content(goal: Any) -> Content:
    """The content of a goal of GripperCommand."""
    return {"position": goal.command.position, "max_effort": goal.command.max_effort}


ACTIONS = {
    "trajectory": ("follow_joint_trajectory", FOLLOW, follow_content),
    "gripper": ("gripper_cmd", GRIPPER, grip_content),
}
"""The action of each kind of command: its name, its type, and what reads the content of a goal."""
