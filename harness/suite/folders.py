"""Where each case's report goes."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from harness.core.resources import data_folder
from harness.suite.discovery import SUFFIX, UsageError


def refuse_unwritable(root: Path) -> None:
    """Check before anything runs that a folder can be written, or created.

    Raises:
        UsageError: It cannot.
    """
    place = root
    while not place.exists() and place != place.parent:
        place = place.parent
    what = f"--report-dir: nothing can be written into '{root}'"
    if not place.is_dir():
        raise UsageError(f"{what}, as '{place}' is a file; choose a folder")
    try:
        Path(tempfile.mkdtemp(prefix=".armharness-", dir=place)).rmdir()
    except OSError as error:
        raise UsageError(f"{what}: {error.strerror} in '{place}'; choose another folder") from None


def report_folders(files: Sequence[Path], root: Path) -> list[Path]:
    """The report folder of each file, no two the same and none inside another.

    It repeats the file's path, without its suffix, below the working directory or else below the
    bundled scenarios; of a file outside both, the whole path.
    """
    folders: list[Path] = []
    for file in files:
        folder = root / place_of(file)
        number = 2
        while folder in folders:
            folder = root / f"{place_of(file)}-{number}"
            number += 1
        folders.append(folder)
    return folders


@cache
def place_of(file: Path) -> Path:
    """A file's path below the working directory, or below the bundled scenarios, without suffix."""
    absolute = file.resolve()
    stem = absolute.name.removesuffix(SUFFIX).removesuffix(".yaml")
    if (absolute.parent / stem).is_dir():
        stem = absolute.name.removesuffix(".yaml")  # an adjacent folder has the plain name
    for base in (Path.cwd().resolve(), data_folder("scenarios").resolve()):
        if absolute.is_relative_to(base):
            return absolute.parent.relative_to(base) / stem
    return absolute.parent.relative_to(absolute.anchor) / stem
