"""The time in which external programs command the robot, live or from a recorded stream."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from harness.cell.cell import Cell
from harness.core.errors import HarnessError
from harness.judging.ends import holds_now
from harness.language.expectation import ExpectationFields
from harness.plugins.ros.control.cell import ExternalCell
from harness.plugins.ros.external_programs import ExternalRequest, ExternalResult
from harness.plugins.ros.moveit.client_scene import ClientScene
from harness.recording.commands import CommandRecord
from harness.recording.read_run import read_run
from harness.recording.stored_run import RESOLVED
from harness.reporting.result import CaseResult
from harness.session.prepare import Prepared
from harness.session.run_case import run_case
from harness.session.run_request import RunRequest
from harness.session.start import Start, start_simulated
from harness.session.timing import Clock
from harness.simulation.mujoco_simulator import MujocoSimulator

GRACE = 1.0  # [s], simulated, that a step goes on after its program has ended and the arm stands

LOOK_EVERY, LOOK_SHARE = 0.5, 0.05
"""Simulated time between two looks at `until` [s], and at least this share of the step's time: a
look reads the whole record. Wall time has no part in it, so that a replay ends alike."""


class HandOver(ABC):
    """Lets time pass while programs command the robot: what they do between two ticks."""

    def __init__(self, prepared: Prepared, simulator: MujocoSimulator) -> None:
        self.prepared, self.simulator = prepared, simulator
        self.cell = ExternalCell(simulator, prepared.program.parts["controllers"])
        self.robot = prepared.program.description
        self.scene: ClientScene | None = None
        self._looked = 0

    @property
    def commands(self) -> tuple[CommandRecord, ...]:
        """Everything that was received, in order."""
        return tuple(self.cell.commands)

    def refusal(self) -> str:
        """Why a run that did not pass says nothing about the programs; empty where it does."""
        return ""

    @abstractmethod
    def feed(self) -> None:
        """Let commands take effect before a tick."""

    @abstractmethod
    def after(self) -> None:
        """Do what follows a tick."""

    def hand_over(self, request: ExternalRequest) -> ExternalResult:
        """Move time tick by tick until the request's end."""
        cell, simulator = self.cell, self.simulator
        begin, first, before = simulator.time, simulator.sample_count - 1, len(cell.commands)
        cell.begin()
        if self.scene is None and isinstance(request.cell, Cell):
            self.scene = ClientScene(request.cell)
            cell.change_scene = self.scene.apply
        look_at, ended_at, ended_by = LOOK_EVERY, np.inf, ""
        while not ended_by:
            self.feed()
            if cell.end is not None and cell.end.content.get("reason") == "stopped":
                ended_by = "stopped"
                break
            cell.tick(begin + request.timeout)
            self.after()
            if cell.end is not None and (ended_at == np.inf or not cell.is_idle):
                ended_at = cell.time
            elapsed, is_due = cell.time - begin, cell.time - begin >= look_at - 1e-9
            if is_due:
                look_at = elapsed + max(LOOK_EVERY, LOOK_SHARE * elapsed)
            if is_due and self._holds(request, begin, first):
                ended_by = "until"
            elif elapsed >= request.timeout - 1e-9:
                ended_by = "timeout"
            elif cell.time >= ended_at + GRACE:
                ended_by = "exit"
        count = sum(command.kind != "end" for command in cell.commands[before:])
        cell.finish()
        self.after()
        detail = _end_text(cell.end) if cell.end and ended_by in ("timeout", "exit") else ""
        return ExternalResult(ended_by, count, detail)

    def _holds(self, request: ExternalRequest, begin: float, first: int) -> bool:
        """Whether the expectation passes now that ends the step, which began at a sample."""
        until, cell = request.until, request.cell
        if not isinstance(until, ExpectationFields) or not isinstance(cell, Cell):
            return False
        looked, self._looked = self._looked, self.simulator.sample_count - 1
        looked = looked if looked > first else 0  # of an earlier step
        return holds_now(until, cell, self.simulator, since=(begin, first), looked=looked)


def _end_text(end: CommandRecord) -> str:
    """The remark on a program that ended."""
    code = end.content.get("code")
    how = "without an error" if code == 0 else f"with exit code {code}"
    return f"the launched program ended {how} at t={end.time:.2f} s"


class ReplayControl(HandOver):
    """Gives each command at the sample at which it took effect."""

    def __init__(
        self, prepared: Prepared, simulator: MujocoSimulator, commands: Sequence[CommandRecord]
    ) -> None:
        super().__init__(prepared, simulator)
        self._left = list(commands)

    def feed(self) -> None:
        """Let the recorded commands of this sample take effect.

        Raises:
            HarnessError: A command belongs to a sample that this run does not stop at.
        """
        now = self.simulator.sample_count - 1
        while self._left and self._left[0].sample <= now:
            command = self._left.pop(0)
            if command.sample < now:
                raise HarnessError(
                    f"the command at t={command.time:.3f} s comes too late in this replay: the"
                    " recorded commands belong to another run"
                )
            self.cell.receive(command.kind, command.controller, command.goal, **command.content)

    def after(self) -> None:
        """Nothing: no program waits for an answer."""


def replay(folder: Path, report_dir: Path | None = None) -> CaseResult:
    """Run a saved run again with its recorded command stream, without any network.

    Args:
        folder: The run's report folder.
        report_dir: Where the replayed run is written; None writes nothing.

    Raises:
        HarnessError: There is no run, or its commands do not fit.
    """
    commands = read_run(folder).run.commands

    def start(request: RunRequest, clock: Clock) -> Start[MujocoSimulator]:
        start = start_simulated(request, clock)
        session = partial(ReplayControl, start.prepared, start.simulator, commands)
        return replace(start, open_session=session)

    return run_case(RunRequest(folder / RESOLVED, report_dir=report_dir), start=start)
