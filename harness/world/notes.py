"""Notes on parts of a file that are not imported, one for each kind."""

from __future__ import annotations

from dataclasses import dataclass

from harness.language.files.source import Place


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
