"""The files of a studio: inside one folder, written whole, and safe from a crash."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from harness.core.errors import HarnessError, Problem, SpecError
from harness.studio.document import Document

SUFFIX = ".scenario.yaml"
UNSAVED = ".unsaved"
TEXTS = ("scenario", "description", "name", "text", "verifies", "title")
"""Keys whose values are for people, whatever they look like."""


class OutsideError(HarnessError):
    """A path leads out of the folder in which the studio was started."""


class StudioFiles:
    """The scenario's file and the copy of unsaved work next to it.

    Attributes:
        root: The folder in which the studio was started; nothing outside is read or written.
        path: The file of the scenario.
    """

    def __init__(self, root: Path, path: Path) -> None:
        self.root = root.resolve()
        self.path = path

    @property
    def unsaved(self) -> Path:
        """The copy of work that was not saved."""
        return self.path.with_name(f".{self.path.name}{UNSAVED}")

    def named(self, name: str) -> Path:
        """The file that a page may write.

        Raises:
            OutsideError: It is outside the folder, or no scenario's file.
        """
        path = self.root / name
        if not name.endswith(SUFFIX) or len(Path(name).name) == len(SUFFIX):
            raise OutsideError(f"the name of a scenario ends in {SUFFIX}")
        if not name.isprintable() or not path.resolve().is_relative_to(self.root):
            raise OutsideError(f"'{name}' is outside the folder {self.root}")
        if not path.parent.is_dir():
            raise OutsideError(f"there is no folder '{path.parent}'")
        return path

    def save(self, name: str, text: str) -> Path:
        """Write the scenario, and forget the unsaved copy."""
        path = self.named(name)
        _write(path, text)
        self.unsaved.unlink(missing_ok=True)
        self.path = path
        return path

    def keep_unsaved(self, text: str) -> None:
        """Keep a copy of the text that a crash leaves."""
        with contextlib.suppress(OSError):  # a folder that cannot be written has no copy
            _write(self.unsaved, text)

    def restored(self) -> str | None:
        """The text that a crash left; None where there is none."""
        try:
            return self.unsaved.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError):
            return None

    def refuse_outside(self, document: Document) -> None:
        """See that a text names no file outside the folder.

        Raises:
            SpecError: It does.
        """
        folder = self.path.parent
        problems: list[Problem] = []
        for words in _words(document.root.plain()):
            given = Path(words).expanduser()
            looks_like_path = words.startswith(("/", "~")) or ".." in given.parts
            if looks_like_path and not (folder / given).resolve().is_relative_to(self.root):
                line = next((n for n, t in enumerate(document.lines, 1) if words in t), 1)
                message = f"`{words}` is outside {self.root}, where the studio reads nothing"
                problems.append(Problem(str(self.path), line, 1, message))
        if problems:
            raise SpecError(problems)


def _words(value: Any) -> Iterator[str]:
    if isinstance(value, Mapping):
        for key, each in value.items():
            if key not in TEXTS or not isinstance(each, str):
                yield from _words(each)
    elif isinstance(value, str):
        yield value
    elif isinstance(value, Sequence):
        for each in value:
            yield from _words(each)


def _write(path: Path, text: str) -> None:
    partial = path.with_name(f"{path.name}.partial")
    partial.write_text(text, encoding="utf-8")
    os.replace(partial, path)  # noqa: PTH105 - one call that replaces the file whole
