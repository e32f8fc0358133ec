"""Live nodes command the robot: the graph, the state topics, the pace, the launched programs."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from textwrap import indent
from threading import Event
from typing import TYPE_CHECKING

import numpy as np

from harness.core.printable import counted
from harness.plugins.ros.bag.frames import camera_edges
from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.camera_topics import CameraTopics
from harness.plugins.ros.control.controller import Outcome
from harness.plugins.ros.controller_manager import controller_managers
from harness.plugins.ros.endpoints import Qos
from harness.plugins.ros.external_programs import ExternalRequest, ExternalResult
from harness.plugins.ros.handover import HandOver
from harness.plugins.ros.interfaces import stamp
from harness.plugins.ros.launch import Program, start_program
from harness.plugins.ros.moveit.server import MoveGroup
from harness.plugins.ros.names import mismatched, unserved
from harness.plugins.ros.pacing import Pace
from harness.plugins.ros.prefix import Prefix
from harness.plugins.ros.rtps.graph import Graph
from harness.plugins.ros.state_topics import StateTopics
from harness.plugins.ros.wiring import Wiring
from harness.recording.commands import CommandRecord
from harness.session.prepare import Prepared
from harness.session.run_request import RunRequest

if TYPE_CHECKING:
    from harness.simulation.mujoco_simulator import MujocoSimulator
Say = Callable[[str], None]

FEEDBACK_EVERY = 5  # ticks between messages of feedback: 20 Hz, as controllers are set
LOOK_EVERY = 50  # ticks between two looks at how nodes use topics
BREATH = 0.001  # wall time between two looks at whether a plan is made [s]
MOST_NOTES = 50  # notes that are given of a run while it continues
LOG, WARN = "rcl_interfaces/msg/Log", 30  # the type of /rosout, on which notes are published too


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
        self._calls: tuple[str, ...] = ()
        self._has_company = False
        self._graph, self._request = graph, request
        self._pace = Pace(request.factor)
        program = prepared.program
        prefix = Prefix(program.parts["controllers"].prefix, self.robot)
        graph.outward, graph.inward = prefix.outward, prefix.inward
        objects = [each.name for each in program.all_objects()]
        cameras = camera_edges(tuple(program.cameras.values()), self.robot, objects)
        self._states = StateTopics(graph, self.robot, cameras)
        self._wiring = Wiring(graph, self.cell, self._note)
        self._managers = controller_managers(graph, self.cell)
        self._move_group = MoveGroup(graph, self.cell, self._note, self._say_once)
        report = self.cell.on_outcome
        self.cell.on_outcome = lambda outcome: (report(outcome), self._end_of(outcome))
        self._log = graph.advertise("/rosout", LOG, Qos(is_latched=True, depth=MOST_NOTES))
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
        remarks = [f"{counted(self.command_count, 'command')}; {self._pace.text()}"]
        if not self.command_count:
            domain = f"ROS domain {self._request.domain}"
            none = (
                f"no other node was in {domain}"
                if not self._has_company
                else (f"other nodes were in {domain}, and sent none")
            )
            remarks.append(f"no command came: {none}")
        remarks += [name for name in self._names if name not in self._noted]
        remarks += self._cameras.remarks()
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
        self._pace.next()
        while True:
            self._graph.spin(self._pace.due, lambda: self._move_group.has_requests)
            self._answer()
            if self._pace.is_due:
                break
        self._pace.tick()
        if self._pace.ticks % LOOK_EVERY == 0:
            self._look_at_names()
        if self._request.stop.is_set():
            self.cell.receive("end", reason="stopped")
        program = self._program
        if program is not None and program.exit_code is not None and self.cell.end is None:
            self.cell.receive("end", reason="exit", code=program.exit_code)
            program.stop()

    def _answer(self) -> None:
        """Answer MoveIt's clients, while simulated time stands still, and all others meanwhile."""
        begin, is_busy = time.monotonic(), True
        while is_busy and not self._request.stop.is_set():
            is_busy = self._move_group.work()
            if is_busy:
                self._graph.spin(time.monotonic() + BREATH)
            now = time.monotonic()
            self._pace.pause(now - begin)
            begin = now

    def after(self) -> None:
        simulator = self.simulator
        sample = simulator.sample_count - 1
        positions, velocities = (part[-1] for part in simulator.measured(sample))
        efforts = np.zeros(len(positions))
        efforts[simulator.physics.actuated] = simulator.efforts()
        if self._pace.ticks % FEEDBACK_EVERY == 0:
            self._wiring.publish_feedback()
            for manager in self._managers:
                manager.publish()
        self._states.publish(simulator.time, positions, velocities, efforts)
        for sensor in self.robot.wrench_sensors:
            wrench = simulator.wrench(sensor, simulator.timestep)
            self._states.publish_wrench(simulator.time, sensor, wrench)
        self._cameras.publish(simulator.time, sample, positions, simulator.objects_now)

    def _look_at_names(self) -> None:
        """Note wrong types at once, services and actions that nothing serves at the second look.

        Other names that are not served are noted where a step fails. A node that has ended uses
        none any more, so the last ones that were found are kept.
        """
        uses = self._graph.uses()
        self._has_company |= bool(uses[1])
        calls = tuple(unserved(*uses, with_topics=False))
        for note in (*mismatched(*uses), *(each for each in calls if each in self._calls)):
            self._say_once(note)
        self._calls, self._names = calls, tuple(unserved(*uses)) or self._names

    def _end_of(self, outcome: Outcome) -> None:
        """Give MoveIt's clients their results; say why a trajectory from a topic was aborted."""
        self._move_group.finish(outcome)
        if not outcome.goal and not outcome.has_succeeded:
            reason = outcome.result.error_string
            self._say_once(
                f"t={self.cell.time:.2f} s: a trajectory from a topic is aborted: {reason}"
            )

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
            head = {"stamp": stamp(self.cell.time), "level": WARN, "name": "bridge"}
            self._log.publish(message(LOG, msg=note, **head))
