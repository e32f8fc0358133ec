"""The time in which external programs command the robot: the same loop, live and in a replay."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from harness.cell.cell import Presence
from harness.engine.execute import object_record
from harness.ports.external import ExternalRequest, ExternalResult
from harness.recording.commands import CommandRecord
from harness.ros.control.cell import ExternalCell, controller_names
from harness.ros.watch import Watch
from harness.session.prepare import Prepared
from harness.session.record import robot_record
from harness.simulation.mujoco_simulator import MujocoSimulator

GRACE = 1.0
"""Simulated time that a step goes on after its program has ended and the arm stands [s]."""

LATE_ENDS = ("timeout", "exit")
"""Ends of a step before `until` holds, by time or by the program's end."""


@dataclass
class HandOver:
    """What commands the robot between two ticks, and what is done after each.

    Attributes:
        prepared: The scenario that is executed.
        simulator: The physics of the run.
    """

    prepared: Prepared
    simulator: MujocoSimulator
    cell: ExternalCell = field(init=False)

    def __post_init__(self) -> None:
        description = self.prepared.program.description
        names = controller_names(description, self.prepared.loaded.scenario.ros2)
        self.cell = ExternalCell(self.simulator, names)
        self.robot = robot_record(description, self.prepared.kinematics)

    @property
    def commands(self) -> tuple[CommandRecord, ...]:
        """Everything that was received, in order."""
        return tuple(self.cell.commands)

    def refusal(self) -> str:
        """Why a run that did not pass says nothing about the programs; empty where it does."""
        return ""

    def drive(
        self, request: ExternalRequest, feed: Callable[[], None], after: Callable[[], None]
    ) -> ExternalResult:
        """Move time tick by tick until the request's end.

        Args:
            request: What ends the loop, and when.
            feed: Lets commands take effect before a tick.
            after: Called after each tick.
        """
        cell = self.cell
        before = seen = len(cell.commands)
        cell.hold_commanded(self.simulator.commanded_positions())
        objects = tuple(
            object_record(Presence(obj, obj.pose, [[0.0, np.inf]]), np.inf)
            for obj in self.prepared.program.world.objects
        )
        watch = Watch(request, self.simulator, self.robot, objects)
        end: CommandRecord | None = None
        ended_at, ended_by = np.inf, ""
        while not ended_by:
            feed()
            arrived, seen = cell.commands[seen:], len(cell.commands)
            end = next((each for each in arrived if each.kind == "end"), end)
            if end is not None and end.content.get("reason") == "stopped":
                ended_by = "stopped"
                break
            cell.tick()
            after()
            if end is not None and (ended_at == np.inf or not cell.is_idle):
                ended_at = cell.time
            if watch.holds():
                ended_by = "until"
            elif watch.elapsed >= request.timeout - 1e-9:
                ended_by = "timeout"
            elif cell.time >= ended_at + GRACE:
                ended_by = "exit"
        count = sum(command.kind != "end" for command in cell.commands[before:])
        cell.finish()
        after()
        return ExternalResult(ended_by, count, _said(end) if ended_by in LATE_ENDS else "")


def _said(end: CommandRecord | None) -> str:
    """What is said of a program that ended."""
    if end is None:
        return ""
    code = end.content.get("code")
    how = "without an error" if code == 0 else f"with exit code {code}"
    return f"the launched program ended {how} at t={end.time:.2f} s"
