"""The coordinator `rounds`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from harness.cell.program import ProgramStep
from harness.plugins.assembly.at_once import AtOnce
from harness.session.coordinator import Coordinator, Runner


class Rounds(Coordinator):
    """Each arm does its next motion in each round, as soon as the others leave room."""

    name: ClassVar[str] = "rounds"

    def run(self, runner: Runner, steps: Sequence[ProgramStep]) -> tuple[float, ...]:
        """Carry out the steps in rounds."""
        return AtOnce(runner, steps).run()
