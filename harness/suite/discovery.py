"""Which scenario files a command line, or a test run, means."""

from __future__ import annotations

import os
from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import NoReturn

from harness.core.errors import HarnessError
from harness.core.files import is_dir, is_file, path_exists
from harness.core.resources import data_folder

SUFFIX = ".scenario.yaml"


class UsageError(HarnessError):
    """A command names something that does not exist (exit code 2)."""


def discover(paths: Sequence[str | Path]) -> list[Path]:
    """Find scenario files.

    A path is a file (of any name), a folder (its `*.scenario.yaml`, at any depth, in the order of
    their names), or, where no such path exists, a bundled scenario or folder of them, also without
    `.scenario.yaml` or with `scenarios/` before it: `lessons`, `lessons/01_gripper_and_joints`.

    Returns:
        Files in the order of `paths`, each once.

    Raises:
        UsageError: A path does not exist, is a folder without scenarios or one that cannot be
            listed, or a file has a name that is not UTF-8.
    """
    found: dict[Path, Path] = {}
    for path in paths:
        for file in _files(Path(path)):
            if not _is_utf8(file):
                raise UsageError(
                    f"the name of {os.fsencode(file)!r} is not UTF-8, as reports need it; rename it"
                )
            found.setdefault(file.resolve(), file)
    return list(found.values())


def bundled_scenarios() -> dict[str, Path]:
    """Names of the bundled scenarios and their files."""
    folder = data_folder("scenarios")
    here = Path.cwd()
    if folder.is_relative_to(here):
        folder = folder.relative_to(here)
    return {
        file.relative_to(folder).as_posix().removesuffix(SUFFIX): file
        for file in _in_folder(folder)
    }


def _files(path: Path) -> list[Path]:
    if is_file(path):
        return [path]
    if is_dir(path):
        files = _in_folder(path)
        if not files:
            raise UsageError(f"no *{SUFFIX} in folder '{path}'")
        return files
    bundled = bundled_scenarios()
    name = path.as_posix().removesuffix(SUFFIX).removeprefix("scenarios/")
    if name in bundled:
        return [bundled[name]]
    below = [file for each, file in bundled.items() if each.startswith(f"{name}/")]
    if below and not path.is_absolute():
        return below
    if path_exists(path):
        raise UsageError(f"'{path}' is neither a file nor a folder")
    raise UsageError(f"no such file or folder: '{path}'{_hint(path, bundled)}")


def _in_folder(folder: Path) -> list[Path]:
    """The scenario files below a folder, in the order of their names; hidden folders are left out.

    Raises:
        UsageError: A folder cannot be listed, or vanishes meanwhile.
    """

    def refuse(error: OSError) -> NoReturn:
        raise UsageError(
            f"scenarios in '{error.filename}' cannot be found: {error.strerror}; name files or"
            " other folders"
        ) from error

    found: list[Path] = []
    for place, folders, names in os.walk(folder, onerror=refuse):
        folders[:] = [each for each in folders if not each.startswith(".")]
        files = (Path(place, name) for name in names if name.endswith(SUFFIX))
        found += (file for file in files if not file.name.startswith(".") and is_file(file))
    return sorted(found)


def _is_utf8(file: Path) -> bool:
    try:
        str(file).encode()
    except UnicodeEncodeError:
        return False
    return True


def _hint(path: Path, bundled: dict[str, Path]) -> str:
    siblings = [
        str(file)
        for file in (path.parent.iterdir() if is_dir(path.parent) else ())
        if _usable(file)
    ]
    near = get_close_matches(str(path), sorted(siblings) + sorted(bundled), n=1, cutoff=0.5)
    if near:
        return f"; did you mean '{near[0]}'?"
    return "; `harness new FILE` writes a scenario to start from"


def _usable(file: Path) -> bool:
    return file.name.endswith(SUFFIX) or (is_dir(file) and not file.name.startswith("."))
