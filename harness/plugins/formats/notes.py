"""Notes on parts of files that importers leave out or change."""

from __future__ import annotations

from harness.language.files.source import Place
from harness.world.imported import Note


class Notes:
    """Collects notes; equal messages of a file become one note with a count."""

    def __init__(self) -> None:
        self._found: dict[tuple[str, str], Note] = {}

    def add(self, place: Place, message: str) -> None:
        """Add a note at a place."""
        key = (place.source.path, message)
        known = self._found.get(key)
        line, count = (known.line, known.count + 1) if known else (place.line, 1)
        self._found[key] = Note(place.source.path, line, message, count)

    def all(self) -> tuple[Note, ...]:
        """Every note, by file and line."""
        return tuple(sorted(self._found.values(), key=lambda note: (note.path, note.line)))
