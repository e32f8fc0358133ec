"""Masses and inertias of links that a tool has filled in."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from harness.cell.program import Program
from harness.cell.program_part import ProgramPart
from harness.plugins.authoring.doubtful_masses import mass_notes


class Masses(ProgramPart):
    """Placeholders and doubtful values of the robot's file, before a scenario is carried out."""

    name: ClassVar[str] = "masses"

    def remarks(self, program: Program) -> Iterator[str]:
        yield from (f"robot: {note}" for note in mass_notes(program.description))
