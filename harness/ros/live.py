"""Live nodes command the robot: the graph, the pace, the programs that were launched."""

from __future__ import annotations

import signal
from collections.abc import Callable, Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import FrameType
from typing import Any

import numpy as np

from harness.ports import ExternalRequest, ExternalResult
from harness.recording.commands import CommandRecord
from harness.ros.camera_topics import CameraTopics
from harness.ros.graph import Graph
from harness.ros.handover import HandOver
from harness.ros.launch import Allowed, Program
from harness.ros.names import unserved
from harness.ros.pacing import Pace
from harness.ros.state_topics import StateTopics
from harness.ros.wiring import Wiring
from harness.session.run_request import RunRequest

Say = Callable[[str], None]

NAMES_EVERY = 100
"""Ticks between two looks at the names that nodes use."""


@dataclass(frozen=True)
class BridgeRequest:
    """A scenario, and how nodes reach its cell.

    Attributes:
        run: The case, and what is written of it.
        domain: The number of the ROS domain.
        is_local: Whether nodes of other machines are kept out.
        adapter: `rtps`, or `rclpy` of a ROS 2 installation.
        nodes: Commands that steps may start, by name.
        factor: Simulated seconds in a wall second.
        is_interactive: Whether the first Ctrl-C ends the session and not the command.
        say: Receives notes for the user while it runs.
        should_end: Called a hundred times a second; whether the session ends now.
    """

    run: RunRequest
    domain: int
    is_local: bool = True
    adapter: str = "rtps"
    nodes: Mapping[str, str] = field(default_factory=dict[str, str])
    factor: float = 1.0
    is_interactive: bool = False
    say: Say = lambda _: None
    should_end: Callable[[], bool] = lambda: False


class LiveControl(HandOver):
    """Serves the robot on a graph while a step hands it over."""

    def __init__(self, prepared: Any, simulator: Any, graph: Graph, request: BridgeRequest) -> None:
        super().__init__(prepared, simulator)
        self.pace = Pace(request.factor)
        self._graph, self._request = graph, request
        self._allowed = Allowed(request.nodes, request.domain)
        self._states = StateTopics(graph, self.robot)
        self._wiring = Wiring(graph, self.cell, self._note)
        program = self.prepared.program
        self._cameras = CameraTopics(
            graph,
            tuple(program.cameras.values()),
            program.description,
            program.all_objects(),
            program.seed,
        )
        self._program: Program | None = None
        self._is_stopped = False
        self._said: set[str] = set()
        self.output = ""
        self.names: tuple[str, ...] = ()
        """Sentences on names that are not served, where the last step did not end with `until`."""
        self.exit_code: int | None = None
        """The exit code of the last program, where it ended by itself."""

    def hand_over(self, request: ExternalRequest) -> ExternalResult:
        """Serve the robot until the request's end; start the program that it names."""
        self._program = self._allowed.start(request.launch)
        self._wiring.is_open = True
        self.pace.start()
        try:
            with self._interruptible():
                result = self.drive(request, self._feed, self._after)
            self._look_for_names()
            if result.ended_by == "until":
                self.names = ()
            return result
        finally:
            self._wiring.is_open = False
            self._cameras.close()
            if self._program is not None:
                self.output = self._program.output()
                self._program.stop()
                self._program = None

    def refusal(self) -> str:
        """Why a run that did not pass says nothing about the nodes; empty where it does."""
        if not self.pace.is_slow:
            return ""
        return f"this machine is too slow to judge the nodes: {self.pace.text()}"

    def _feed(self) -> None:
        """Receive until the next tick is due."""
        self._graph.spin(self.pace.next())
        self.pace.tick()
        if self.pace.ticks % NAMES_EVERY == 0:
            self._look_for_names()
        if self._is_stopped or self._request.should_end():
            self._is_stopped = False
            self.cell.receive("end", content={"reason": "stopped"})
        program = self._program
        if program is not None and program.exit_code is not None:
            self.exit_code = program.exit_code
            self.cell.receive("end", content={"reason": "exit", "code": self.exit_code})
            self.output = program.output()
            program.stop()
            self._program = None

    def _after(self) -> None:
        simulator = self.simulator
        positions, velocities = simulator.measured(simulator.sample_count - 1)
        efforts = np.zeros(len(simulator.description.joint_names))
        efforts[simulator.physics.actuated] = simulator.efforts()
        self._wiring.after_tick()
        self._states.publish(simulator.time, positions[-1], velocities[-1], efforts)
        sample = simulator.sample_count - 1
        self._cameras.publish(simulator.time, sample, positions[-1], simulator.objects_now)

    def _look_for_names(self) -> None:
        """Keep the names that are not served; a node that has ended uses none any more."""
        self.names = tuple(unserved(*self._graph.names())) or self.names

    def _note(self, record: CommandRecord) -> None:
        """A command took effect; say it, where it did not."""
        self.pace.command()
        if record.answer != "accepted" and record.answer not in self._said:
            self._said.add(record.answer)
            self._request.say(
                f"t={record.time:.2f} s: {record.kind} for {record.controller}: {record.answer}"
            )
        self._wiring.report()

    @contextmanager
    def _interruptible(self) -> Generator[None]:
        """Let the first Ctrl-C end an interactive session in order."""
        if not self._request.is_interactive:
            yield
            return

        def stop(_number: int, _frame: FrameType | None) -> None:
            self._is_stopped = True
            signal.signal(signal.SIGINT, before)

        before = signal.signal(signal.SIGINT, stop)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, before)
