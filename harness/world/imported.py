"""Results of importers: a world, and notes on parts of a file that are not imported."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from harness.core.errors import Problem, SpecError
from harness.language.world import WorldSpec


@dataclass(frozen=True)
class Note:
    """A note on a part of a file that is left out or changed.

    Attributes:
        path: The file, as the user named it.
        line: Line of its first occurrence, from 1.
        message: The part, and how it is treated.
        count: The number of its occurrences.
    """

    path: str
    line: int
    message: str
    count: int = 1

    def __str__(self) -> str:
        more = f" ({self.count} times; here first)" if self.count > 1 else ""
        return f"{self.path}:{self.line}: {self.message}{more}"


@dataclass(frozen=True, eq=False)
class ImportedWorld:
    """An imported world.

    Attributes:
        world: The world as a world file describes it; mesh files have absolute paths.
        unusable: Objects that lack a mesh file, and why; the world has their places only.
    """

    world: WorldSpec
    path: Path
    notes: tuple[Note, ...] = ()
    unusable: tuple[tuple[str, Problem], ...] = ()

    def refuse_unusable(self, replaced: Collection[str] = ()) -> None:
        """Refuse objects that lack a mesh file, except those that a scenario replaces.

        Raises:
            SpecError: Such an object is not replaced; each at its place.
        """
        problems = [problem for name, problem in self.unusable if name not in replaced]
        if problems:
            raise SpecError(problems)
