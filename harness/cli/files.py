"""Files and folders that arguments of commands name."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from harness.core.files import write_whole
from harness.suite.discovery import UsageError, discover

RUN = "run.json"


def run_folder(name: str) -> Path:
    """The folder of a saved run, named by itself or by a file in it.

    Raises:
        UsageError: It holds no run.
    """
    path = Path(name)
    folder = path if path.is_dir() else path.parent
    if not path.exists() or not (folder / RUN).is_file():
        raise UsageError(f"'{name}' is not the folder of a run: it has no {RUN}")
    return folder


def one_scenario(name: str) -> Path:
    """The scenario file that an argument names.

    Raises:
        UsageError: It names none, or several.
    """
    found = discover([name])
    if len(found) != 1:
        raise UsageError(f"'{name}' holds {len(found)} scenarios; name one of them")
    return found[0]


def refuse_existing(path: Path, *, is_forced: bool = False) -> None:
    """Refuse to replace a file without `--force`.

    Raises:
        UsageError: It exists.
    """
    if path.exists() and not is_forced:
        raise UsageError(f"'{path}' exists already; nothing was written (--force overwrites)")


@contextmanager
def refusing_unwritable() -> Iterator[None]:
    """Report a file that cannot be written as wrong usage.

    Raises:
        UsageError: It names the file and the reason.
    """
    try:
        yield
    except OSError as error:
        raise UsageError(f"cannot write '{error.filename}': {error.strerror}") from error


def write_text(path: Path, text: str) -> None:
    """Write a text file whole, and the folder that it is in.

    Raises:
        UsageError: It cannot be written.
    """
    with refusing_unwritable():
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, text)
