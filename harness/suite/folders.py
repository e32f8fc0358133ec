"""Where each case's report goes."""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from harness.core.files import is_dir, is_file, part_of, path_exists
from harness.core.resources import data_folder
from harness.suite.discovery import SUFFIX, UsageError

LONGEST_NAME = 200  # the longest name of a report's folder [bytes]


def refuse_unwritable_file(file: Path, option: str = "") -> None:
    """Check before anything runs that a file can be written, and the folders above it.

    Args:
        option: What a message begins with, such as `--ctrf: `.

    Raises:
        UsageError: It cannot.
    """
    if is_dir(file):
        raise UsageError(f"{option}'{file}' is a folder; name a file")
    if is_file(file) or not path_exists(file):  # no pipe and no device
        _refuse(part_of(Path(os.path.realpath(file))), f"{option}'{file}' cannot be written")


def refuse_unwritable(root: Path, option: str = "") -> None:
    """Check before anything runs that a folder can be written, or created; see above.

    Raises:
        UsageError: It cannot.
    """
    _refuse(root, f"{option}nothing can be written into '{root}'")


def _refuse(path: Path, what: str) -> None:
    place = path
    while not path_exists(place) and place != place.parent:
        place = place.parent
    if not is_dir(place):
        raise UsageError(f"{what}, as '{place}' is a file; choose another folder")
    longest = os.pathconf(place, "PC_NAME_MAX")
    if any(len(os.fsencode(part)) > longest for part in path.parts):
        raise UsageError(f"{what}: a name has at most {longest} bytes; choose a shorter one")
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
        place = place_of(file)
        folder = root / place.parent / folder_name(place.name)
        number = 2
        while folder in folders:
            folder = root / place.parent / folder_name(f"{place.name}-{number}")
            number += 1
        folders.append(folder)
    return folders


def folder_name(name: str) -> str:
    """A name for the folder of a report: a long one is cut, and a hash keeps it apart from others.

    File systems take 255 bytes, and the folder has a longer name while it is written.
    """
    content = os.fsencode(name)
    if len(content) <= LONGEST_NAME:
        return name
    cut = content[: LONGEST_NAME - 9].decode("utf-8", "ignore")
    return f"{cut}-{hashlib.sha256(content).hexdigest()[:8]}"


@cache
def place_of(file: Path) -> Path:
    """A file's path below the working directory, or below the bundled scenarios, without suffix."""
    absolute = file.resolve()
    stem = absolute.name.removesuffix(SUFFIX).removesuffix(".yaml")
    if is_dir(absolute.parent / stem):
        stem = absolute.name.removesuffix(".yaml")  # an adjacent folder has the plain name
    for base in (Path.cwd().resolve(), data_folder("scenarios").resolve()):
        if absolute.is_relative_to(base):
            return absolute.parent.relative_to(base) / stem
    return absolute.parent.relative_to(absolute.anchor) / stem
