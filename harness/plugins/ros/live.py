"""Live nodes command the robot: the graph, the state topics, the pace, the launched programs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from textwrap import indent
from threading import Event
from typing import TYPE_CHECKING

import numpy as np

from harness.core.printable import counted
from harness.plugins.ros.camera_topics import CameraTopics
from harness.plugins.ros.controller_manager import ControllerManager
from harness.plugins.ros.handover import HandOver
from harness.plugins.ros.launch import Program, start_program
from harness.plugins.ros.moveit.server import MoveGroup
from harness.plugins.ros.names import mismatched, unserved
from harness.plugins.ros.pacing import Pace
from harness.plugins.ros.rtps.graph import Graph
from harness.plugins.ros.wiring import Wiring
from harness.ports.external import ExternalRequest, ExternalResult
from harness.recording.commands import CommandRecord
from harness.reporting.rosbag.frames import camera_edges
from harness.robot.description import RobotDescription
from harness.session.prepare import Prepared
from harness.session.run_request import RunRequest

if TYPE_CHECKING:
    from harness.simulation.mujoco_simulator import MujocoSimulator
from collections.abc import Iterable

from harness.core.types import FloatArray
from harness.plugins.ros.endpoints import LATCHED, Qos
from harness.plugins.ros.interfaces import header, stamp
from harness.reporting.rosbag.frames import Edge, robot_edges, transform_stamped
from harness.reporting.rosbag.messages import message

Say = Callable[[str], None]

FEEDBACK_EVERY = 5  # ticks between messages of feedback: 20 Hz, as controllers are set
LOOK_EVERY = 50  # ticks between two looks at how nodes use topics
MOST_NOTES = 50  # notes that are given of a run while it continues
TF = "tf2_msgs/msg/TFMessage"
TF_EVERY = 2  # ticks between two messages of frames: 50 Hz


class StateTopics:
    """Publishes the state of the robot after every tick."""

    def __init__(self, graph: Graph, robot: RobotDescription, cameras: Iterable[Edge]) -> None:
        """Advertise the topics, and publish what does not change, with the frames of cameras."""
        self._moved = robot.movable_joints
        self._clock = graph.advertise("/clock", "rosgraph_msgs/msg/Clock", Qos(depth=1))
        self._joints = graph.advertise("/joint_states", "sensor_msgs/msg/JointState")
        self._state = message("sensor_msgs/msg/JointState", name=robot.joint_names)
        self._tf = graph.advertise("/tf", TF, Qos(depth=100))
        static = graph.advertise("/tf_static", TF, LATCHED)
        fixed = [
            transform_stamped(header(0.0, edge.parent), edge.child, edge.pose)
            for edge in (*robot_edges(robot), *cameras)
        ]
        static.publish(message(TF, transforms=fixed))
        description = graph.advertise("/robot_description", "std_msgs/msg/String", LATCHED)
        description.publish(message("std_msgs/msg/String", data=robot.urdf))
        self._ticks = 0

    def publish(
        self, time: float, positions: FloatArray, velocities: FloatArray, efforts: FloatArray
    ) -> None:
        """Publish the state of the joints, description order, at a simulated time [s]."""
        moment = stamp(time)
        self._clock.publish(message("rosgraph_msgs/msg/Clock", clock=moment))
        state = self._state
        state.header.stamp = moment
        state.position, state.velocity, state.effort = positions, velocities, efforts
        self._joints.publish(state)
        self._ticks += 1
        if self._ticks % TF_EVERY == 0 and self._tf.subscribers:
            transforms = [
                transform_stamped(
                    header(time, joint.parent), joint.child, joint.at(position).as_vector()
                )
                for joint, position in zip(self._moved, positions, strict=True)
            ]
            self._tf.publish(message(TF, transforms=transforms))


@dataclass(frozen=True)
class BridgeRequest:
    """A scenario, and how nodes reach its cell.

    Attributes:
        is_local: Whether nodes of other machines are kept out.
        factor: Simulated seconds in a wall second.
        say: Receives notes for the user while it runs.
        stop: Ends the session when it is set.
    """

    run: RunRequest
    domain: int
    is_local: bool = True
    factor: float = 1.0
    say: Say = lambda _: None
    stop: Event = field(default_factory=Event)


class LiveControl(HandOver):
    """Serves the robot on a graph while a step hands it over."""

    def __init__(
        self, prepared: Prepared, simulator: MujocoSimulator, graph: Graph, request: BridgeRequest
    ) -> None:
        super().__init__(prepared, simulator)
        self._names: tuple[str, ...] = ()
        self._graph, self._request = graph, request
        self._pace = Pace(request.factor)
        program = prepared.program
        objects = [each.name for each in program.all_objects()]
        cameras = camera_edges(tuple(program.cameras.values()), self.robot, objects)
        self._states = StateTopics(graph, self.robot, cameras)
        self._wiring = Wiring(graph, self.cell, self._note)
        self._manager = ControllerManager(graph, self.cell)
        self._move_group = MoveGroup(graph, self.cell, self._note, self._say_once)
        finish = self.cell.on_outcome
        self.cell.on_outcome = lambda outcome: (finish(outcome), self._move_group.finish(outcome))
        self._cameras = CameraTopics(graph, prepared.program)
        self._program: Program | None = None
        self._noted: set[str] = set()

    def hand_over(self, request: ExternalRequest) -> ExternalResult:
        """Serve the robot until the request's end; start the program that it names."""
        nodes, domain = self._request.run.nodes, self._request.domain
        self._program = start_program(nodes, request.launch, domain)
        self._wiring.is_open = True
        self._pace.start()
        try:
            result = super().hand_over(request)
            self._look_at_names()
            if result.ended_by == "until":
                self._names = ()
            return result
        finally:
            self._wiring.is_open = False
            self._move_group.end()
            self._cameras.close()
            if self._program is not None:
                self._program.stop()

    def refusal(self) -> str:
        """Why a run that did not pass says nothing about the nodes; empty where it does."""
        slow = f"this machine is too slow to judge the nodes: {self._pace.text()}"
        return slow if self._pace.is_slow else ""

    @property
    def command_count(self) -> int:
        """The number of commands that arrived."""
        return sum(command.kind != "end" for command in self.cell.commands)

    def remarks(self, *, has_passed: bool) -> tuple[str, ...]:
        """Remarks on wall time, names and the launched program; none of them is judged."""
        remarks = [f"{counted(self.command_count, 'command')}; {self._pace.text()}", *self._names]
        codes = [each.content["code"] for each in self.cell.commands if "code" in each.content]
        code = codes[-1] if codes else 0
        output = self._program.output if self._program is not None else ""
        if code and has_passed:
            remarks.append(f"the launched program ended with exit code {code}")
        if output and (code or not has_passed):
            remarks.append(f"the launched program printed:\n{indent(output, '  ')}")
        return tuple(remarks)

    def feed(self) -> None:
        """Receive until the next tick is due."""
        if self.scene is not None and not self._move_group.is_open:
            self._move_group.begin(self.scene)
        self._graph.spin(self._pace.next())
        self._pace.pause(self._move_group.work())
        self._pace.tick()
        if self._pace.ticks % LOOK_EVERY == 0:
            self._look_at_names()
        if self._request.stop.is_set():
            self.cell.receive("end", reason="stopped")
        program = self._program
        if program is not None and program.exit_code is not None and self.cell.end is None:
            self.cell.receive("end", reason="exit", code=program.exit_code)
            program.stop()

    def after(self) -> None:
        simulator = self.simulator
        sample = simulator.sample_count - 1
        positions, velocities = (part[-1] for part in simulator.measured(sample))
        efforts = np.zeros(len(positions))
        efforts[simulator.physics.actuated] = simulator.efforts()
        if self._pace.ticks % FEEDBACK_EVERY == 0:
            self._wiring.publish_feedback()
            self._manager.publish()
        self._states.publish(simulator.time, positions, velocities, efforts)
        self._cameras.publish(simulator.time, sample, positions, simulator.objects_now)

    def _look_at_names(self) -> None:
        """Note wrong types at once, and names that are not served where a step fails.

        A node that has ended uses none any more, so the last ones that were found are kept.
        """
        uses = self._graph.uses()
        for note in mismatched(*uses):
            self._say_once(note)
        self._names = tuple(unserved(*uses)) or self._names

    def _note(self, record: CommandRecord) -> None:
        """Count a command; note a command that was refused."""
        self._pace.command()
        if record.answer != "accepted":
            what = f"t={record.time:.2f} s: {record.kind} for {record.controller}: {record.answer}"
            self._say_once(what, record.answer)

    def _say_once(self, note: str, key: str = "") -> None:
        key = key or note
        if key not in self._noted and len(self._noted) < MOST_NOTES:
            self._noted.add(key)
            self._request.say(note)
