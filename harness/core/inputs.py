"""The files that this process has read, which its results follow from.

A file that a result follows from is read with `read_input`, so that a run that goes on, or a merge,
can see whether it has changed. The set grows as long as the process lives: one file too many costs
a run, one too few keeps a wrong result.
"""

from __future__ import annotations

import hashlib
import stat
import sys
from collections.abc import Callable, Mapping
from glob import glob
from pathlib import Path

from harness.core.errors import Problem, SpecError
from harness.core.files import is_dir, path_exists, read_at_most

INSTALLED = ("site-packages", "dist-packages")  # installed packages: their versions count
FOLDER = "folder"  # in place of a folder's hash: not the empty one of a missing place

_read: dict[str, str] = {}
_listeners: list[Callable[[str], object]] = []


def read_input(path: Path) -> bytes:
    """The bytes of a file, which is noted as an input.

    Raises:
        OSError: It cannot be read.
    """
    key = str(path.absolute())
    for listener in _listeners:
        listener(key)
    try:
        content = read_at_most(path, sys.maxsize)
    except FileNotFoundError:
        _read[key] = ""
        raise
    _read[key] = hashlib.sha256(content).hexdigest()
    return content


def read_bounded(path: Path, kind: str, largest: int) -> bytes:
    """The bytes of a file, which is noted as an input.

    Args:
        kind: What it should be, for messages.
        largest: The largest size [bytes].

    Raises:
        SpecError: Not there, not a regular file, or too large.
    """
    name = str(path)
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            found = "a folder" if stat.S_ISDIR(status.st_mode) else "not a regular file"
            raise SpecError([Problem(name, 0, 0, f"this is {found}; a {kind} is expected")])
        if status.st_size > largest:
            size = f"{status.st_size / 1e6:.1f} MB; at most {largest / 1e6:.0f} MB are read"
            raise SpecError([Problem(name, 0, 0, f"the file has {size}")])
        return read_input(path)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        missing = isinstance(error, FileNotFoundError)
        message = "there is no such file" if missing else f"cannot be read: {reason}"
        raise SpecError([Problem(name, 0, 0, message)]) from error


def note_inputs(listener: Callable[[str], object]) -> None:
    """Call a function with the path of each input before it is read."""
    _listeners.append(listener)


def is_there(path: Path) -> bool:
    """Whether a path of a search exists; where nothing is, that is an input.

    What appears there later would be found first. So are the names that a path with wildcards has.
    """
    if not (found := path_exists(path)):
        _read.setdefault(str(path.absolute()), content_hash(path))
    return found


def forget_inputs() -> None:
    """Forget what was read for all cases: files of the program, which count as one."""
    _read.clear()


def inputs_read() -> Mapping[str, str]:
    """The absolute path and the hash of every input; the hash is empty where there was no file.

    The modules of plug-ins, and those that they import from outside installed packages, are inputs.
    """
    own = str(Path(__file__).resolve().parents[1])
    programs = (own, sys.prefix, sys.base_prefix)
    for module in list(sys.modules.values()):
        file = getattr(module, "__file__", None)
        if not isinstance(file, str) or file in _read or file.startswith(programs):
            continue
        path = Path(file)
        if path.suffix == ".py" and path.is_file() and not set(INSTALLED) & set(path.parts):
            read_input(path)
    return dict(_read)


def content_hash(path: Path) -> str:
    """The hash of a file as `inputs_read` has it; empty where there is nothing."""
    if is_dir(path):
        return FOLDER
    try:
        return hashlib.sha256(read_at_most(path, sys.maxsize)).hexdigest()
    except OSError:
        names = sorted(glob(path.name, root_dir=path.parent))  # noqa: PTH207 - `**` is `*` here
        return hashlib.sha256("/".join(names).encode()).hexdigest() if names else ""
