"""A recorded command stream in place of nodes: the same run again, offline."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from harness.core.errors import HarnessError
from harness.ports.external import ExternalRequest, ExternalResult
from harness.recording.commands import CommandRecord
from harness.recording.read_run import read_run
from harness.recording.stored_run import RESOLVED
from harness.reporting.result import CaseResult
from harness.ros.handover import HandOver
from harness.session.prepare import Prepared
from harness.session.run_case import run_case
from harness.session.run_request import RunRequest

if TYPE_CHECKING:
    from harness.simulation.mujoco_simulator import MujocoSimulator


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
