"""What a plug-in resolves of a scenario, with the mistakes that it finds there."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, ClassVar

from harness.cell.program import Program
from harness.cell.scope import Scope
from harness.core.registry import Plugin, registry
from harness.language.scenario import ScenarioContent


class ProgramPart(Plugin):
    """A part of every program, `Program.parts[name]`, which the same plug-in reads."""

    plugin_kind: ClassVar[str] = "program_part"

    def resolve(self, scenario: ScenarioContent, scope: Scope) -> object:
        """The part; mistakes of the scenario are added to the problems of the scope."""

    def remarks(self, program: Program) -> Iterable[str]:
        """What the scenario allows and probably does not intend."""
        del program
        return ()


def resolved_parts(scenario: ScenarioContent, scope: Scope) -> Mapping[str, Any]:
    """The parts of all plug-ins, by their names."""
    parts = registry(ProgramPart.plugin_kind).items()
    return {name: part().resolve(scenario, scope) for name, part in parts}
