"""What an importer gives."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from harness.importers.notes import Note
from harness.spec.world import WorldSpec


@dataclass(frozen=True, eq=False)
class ImportedWorld:
    """A world with where it is from.

    Attributes:
        world: As a file of ours would say it; mesh files with whole paths.
        path: The file.
        notes: What of it is left out, or taken otherwise.
    """

    world: WorldSpec
    path: Path
    notes: tuple[Note, ...] = ()
