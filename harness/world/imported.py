"""Results of importers."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from harness.language.world import WorldSpec
from harness.world.notes import Note


@dataclass(frozen=True, eq=False)
class ImportedWorld:
    """An imported world.

    Attributes:
        world: The world as a world file describes it; mesh files have absolute paths.
        path: The path of the imported file.
        notes: Notes on elements that are left out or changed.
    """

    world: WorldSpec
    path: Path
    notes: tuple[Note, ...] = ()
