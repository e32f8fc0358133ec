"""The time in which external programs command the robot, live or from a recorded stream."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from harness.assertions.judge import judge
from harness.assertions.placed import PlacedExpectation
from harness.cell.cell import Presence
from harness.core.errors import HarnessError
from harness.engine.execute import object_record
from harness.language.expectation import ExpectationFields
from harness.ports.external import ExternalRequest, ExternalResult
from harness.recording.commands import CommandRecord
from harness.recording.read_run import read_run
from harness.recording.run import Run
from harness.recording.step_record import StepRecord
from harness.recording.stored_run import RESOLVED
from harness.reporting.result import CaseResult
from harness.ros.control.cell import ExternalCell, controller_names
from harness.session.prepare import Prepared
from harness.session.record import robot_record
from harness.session.run_case import run_case
from harness.session.run_request import RunRequest
from harness.simulation.mujoco_simulator import MujocoSimulator

GRACE = 1.0
"""Simulated time that a step goes on after its program has ended and the arm stands [s]."""

LOOK_EVERY, LOOK_SHARE = 0.5, 0.05
"""Simulated time between two looks at `until` [s], and at least this share of the step's time: a
look reads the whole record. Wall time has no part in it, so that a replay ends alike."""


class HandOver:
    """What commands the robot between two ticks, and what is done after each.

    Attributes:
        prepared: The scenario that is executed.
        simulator: The physics of the run.
    """

    def __init__(self, prepared: Prepared, simulator: MujocoSimulator) -> None:
        description = prepared.program.description
        self.prepared, self.simulator = prepared, simulator
        names = controller_names(description, prepared.loaded.scenario.ros2)
        self.cell = ExternalCell(simulator, names)
        self.robot = robot_record(description, prepared.kinematics)

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
        cell, begin = self.cell, self.simulator.time
        before = seen = len(cell.commands)
        cell.hold_commanded(self.simulator.commanded_positions())
        record, look_at = self._record(request), LOOK_EVERY
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
            elapsed, holds = cell.time - begin, False
            if elapsed >= look_at - 1e-9:
                look_at = elapsed + max(LOOK_EVERY, LOOK_SHARE * elapsed)
                holds = self._holds(request, record)
            if holds:
                ended_by = "until"
            elif elapsed >= request.timeout - 1e-9:
                ended_by = "timeout"
            elif cell.time >= ended_at + GRACE:
                ended_by = "exit"
        count = sum(command.kind != "end" for command in cell.commands[before:])
        cell.finish()
        after()
        detail = _said(end) if end is not None and ended_by in ("timeout", "exit") else ""
        return ExternalResult(ended_by, count, detail)

    def _record(self, request: ExternalRequest) -> Run:
        """The record of a step that begins now; what its end decides is filled in by a look."""
        step = StepRecord(
            id=request.step,
            path=request.step,
            verb="",
            summary="",
            line=request.line,
            status="passed",
            start_time=self.simulator.time,
            end_time=self.simulator.time,
            start_index=max(0, self.simulator.sample_count - 1),
            end_index=self.simulator.sample_count,
        )
        return Run(
            scenario="",
            file="",
            case="",
            seed=0,
            robot=self.robot,
            objects=tuple(
                object_record(Presence(obj, obj.pose, [[0.0, np.inf]]), np.inf)
                for obj in self.prepared.program.world.objects
            ),
            attachments=(),
            steps=(step,),
            signals=self.simulator.finish(),
            unrecorded=("clearances", "planned_clearances"),
        )

    def _holds(self, request: ExternalRequest, record: Run) -> bool:
        """Whether the expectation passes now that ends the step."""
        until, simulator = request.until, self.simulator
        if not isinstance(until, ExpectationFields):
            return False
        [step] = record.steps
        step = replace(step, end_time=simulator.time, end_index=simulator.sample_count)
        run = replace(record, steps=(step,), signals=simulator.finish())
        placed = PlacedExpectation.of(until, request.step, request.line)
        return judge(run, [placed])[0].status == "passed"


def _said(end: CommandRecord) -> str:
    """What is said of a program that ended."""
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

    def hand_over(self, request: ExternalRequest) -> ExternalResult:
        """Let the recorded commands take effect until the request's end.

        Raises:
            HarnessError: A command belongs to a sample that this run does not stop at.
        """
        return self.drive(request, self._feed, self.cell.outcomes.clear)

    def _feed(self) -> None:
        now = self.simulator.sample_count - 1
        while self._left and self._left[0].sample <= now:
            command = self._left.pop(0)
            if command.sample < now:
                raise HarnessError(
                    f"the command at t={command.time:.3f} s comes too late in this replay: the"
                    " recorded commands belong to another run"
                )
            self.cell.receive(command.kind, command.controller, command.goal, command.content)


def replay(folder: Path, report_dir: Path | None = None) -> CaseResult:
    """Run a saved run again with its recorded command stream, without any network.

    Args:
        folder: The run's report folder.
        report_dir: Where the replayed run is written; None writes nothing.

    Raises:
        HarnessError: There is no run, or its commands do not fit.
    """
    commands = read_run(folder).run.commands
    return run_case(
        RunRequest(folder / RESOLVED, report_dir=report_dir),
        make_session=lambda prepared, simulator: ReplayControl(prepared, simulator, commands),
    )
