"""The files of a studio: inside one folder, written whole, and safe from a crash."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Sequence
from pathlib import Path

from harness.core.errors import HarnessError, SpecError
from harness.core.files import expanded, read_at_most, replaced
from harness.core.limits import STUDIO_MESSAGE
from harness.language.files.source import Located, walk
from harness.language.reading.load import WORLD_SUFFIXES, LoadedScenario, load_world

SUFFIX = ".scenario.yaml"
UNSAVED = ".unsaved"
TEXTS = (("scenario",), ("description",), ("text",), ("verifies",), ("title",))
"""Ends of the paths of values that are for people, whatever they look like."""


class OutsideError(HarnessError):
    """A path leads out of the folder in which the studio was started."""


class StudioFiles:
    """The scenario's file and the copy of unsaved work next to it.

    Attributes:
        root: The folder in which the studio was started; nothing outside is read or written.
        path: The file of the scenario.
        given: Files that the command line names; they may be read wherever they are.
    """

    def __init__(self, root: Path, path: Path, given: Sequence[Path] = ()) -> None:
        self.root = root.resolve()
        self.path = path
        self.given = frozenset(each.resolve() for each in given)

    @property
    def name(self) -> str:
        """The file as a page names it, from the folder."""
        return os.path.relpath(self.path, self.root)

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

    def save(self, path: Path, text: str) -> None:
        """Write the scenario to a path of `named`, and forget the unsaved copy.

        Raises:
            HarnessError: The file cannot be written.
        """
        try:
            _write(path, text)
        except OSError as error:
            raise HarnessError(f"'{path.name}' cannot be written: {error.strerror}") from error
        with contextlib.suppress(OSError):
            self.unsaved.unlink(missing_ok=True)
        self.path = path

    def keep_unsaved(self, text: str) -> str:
        """Keep a copy of the text that a crash leaves; returns why that is not possible."""
        try:
            _write(self.unsaved, text)
        except OSError as error:
            return (
                f"a crash would lose this work: {self.unsaved} cannot be written: {error.strerror}"
            )
        return ""

    def restored(self) -> str | None:
        """The text that a crash left; None where there is none."""
        try:
            return read_at_most(self.unsaved, STUDIO_MESSAGE).decode()
        except (OSError, UnicodeDecodeError):
            return None

    def refuse_outside(self, written: Located) -> None:
        """See that no value of a file leads out of the folder.

        Raises:
            SpecError: Some do, each at its place.
        """
        problems = [
            item.place.problem(f"`{item.value}` is outside {self.root}, where nothing is read")
            for loc, item in walk(written)
            if isinstance(item.value, str) and loc[-1:] not in TEXTS and self._leads_out(item)
        ]
        if problems:
            raise SpecError(problems)

    def refuse_used_outside(self, loaded: LoadedScenario) -> None:
        """See the same of the values as they are used: parameters filled in, the world's too.

        Raises:
            SpecError: Some lead out of the folder.
        """
        self.refuse_outside(loaded.written)
        world = loaded.scenario.world.name
        if Path(world).suffix in WORLD_SUFFIXES:
            try:
                written = load_world(world, loaded.path.parent).written
            except SpecError:  # whoever compiles it reports that
                return
            self.refuse_outside(written)

    def _leads_out(self, item: Located) -> bool:
        words = str(item.value)
        if not words.isprintable() or not {"/", ".", "~"} & set(words):
            return False
        path = (Path(item.place.source.path).parent / expanded(words)).resolve()
        if path.is_relative_to(self.root) or path in self.given:
            return False
        return words.startswith(("/", "~")) or ".." in Path(words).parts or path.exists()


def _write(path: Path, text: str) -> None:
    with replaced(path) as file:
        file.write(text.encode())
