"""MoveIt's interface on the graph: services, actions and topics of `move_group`."""

from __future__ import annotations

from collections.abc import Callable

from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.control.cell import ExternalCell
from harness.plugins.ros.control.controller import Outcome
from harness.plugins.ros.endpoints import LATCHED
from harness.plugins.ros.interfaces import register_move_group
from harness.plugins.ros.moveit import services
from harness.plugins.ros.moveit.client_scene import ClientScene
from harness.plugins.ros.moveit.motions import Motions
from harness.plugins.ros.moveit.requests import Requests
from harness.plugins.ros.moveit.scene_changes import (
    changes_of,
    changes_of_attached,
    changes_of_scene,
    changes_of_world,
)
from harness.plugins.ros.rtps.graph import Graph
from harness.recording.commands import CommandRecord

SCENE = "moveit_msgs/msg/PlanningScene"
DISPLAY = "moveit_msgs/msg/DisplayTrajectory"


class MoveGroup:
    """Answers MoveIt's clients while a step hands the arm over.

    Requests wait until `work`; simulated time stands still until it is over.
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
        self._requests = requests = Requests(cell, note, say)
        services.serve(graph, requests)
        self._motions = Motions(graph, requests)
        for topic, kind, read in (
            ("planning_scene", "PlanningScene", changes_of_scene),
            ("planning_scene_world", "PlanningSceneWorld", changes_of_world),
            ("collision_object", "CollisionObject", changes_of),
            ("attached_collision_object", "AttachedCollisionObject", changes_of_attached),
        ):
            graph.subscribe(f"/{topic}", f"moveit_msgs/msg/{kind}", requests.topic(read))
        requests.on_scene = graph.advertise("/monitored_planning_scene", SCENE, LATCHED).publish
        requests.on_plan = graph.advertise("/display_planned_path", DISPLAY).publish
        semantic = graph.advertise("/robot_description_semantic", "std_msgs/msg/String", LATCHED)
        semantic.publish(message("std_msgs/msg/String", data=cell.description.srdf))

    @property
    def is_open(self) -> bool:
        """Whether requests are answered."""
        return self._requests.scene is not None

    @property
    def has_requests(self) -> bool:
        """Whether something waits for `work`."""
        return self.is_open and self._requests.has_waiting

    def work(self) -> bool:
        """Answer what waits; whether a plan is still made."""
        return self._requests.work()

    def finish(self, outcome: Outcome) -> None:
        """Give the client of a trajectory its result."""
        self._motions.finish(outcome)

    def begin(self, scene: ClientScene) -> None:
        """Answer from now on, about a cell."""
        self._requests.scene = scene
        self._requests.on_scene(scene.as_message())

    def end(self) -> None:
        """Answer no more."""
        self._motions.end()
        self._requests.forget()
