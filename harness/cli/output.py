"""Writing to the terminal, and errors that a command ends with."""

from __future__ import annotations

import errno
import io
import os
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TextIO

from harness.core.error_text import error_text
from harness.core.errors import HarnessError, RobotError, SpecError
from harness.core.extras import missing_extra
from harness.core.interruption import is_interrupted
from harness.core.printable import cropped, fitted, printable, printable_lines, terminal_text
from harness.core.resources import with_short_names
from harness.suite.discovery import UsageError
from harness.suite.outcome import EXIT_CODES, USAGE_EXIT_CODE

CLEAR_LINE = "\r\x1b[2K"
TICK = 1.0  # [s], after which the status line is written again: a terminal is never silent
SHORTEST = 0.1  # seconds between two frequent statuses, at least
AGAIN = "again:"  # how a line begins that holds a command for the shell


class OutputError(Exception):
    """Standard output or standard error takes no more text."""


class Output:
    """A stream of lines; on a terminal, with a status line below them that is rewritten.

    Lines are made printable and, on a terminal, broken at spaces where they are too long.
    """

    def __init__(self, stream: TextIO) -> None:
        from threading import RLock

        self.stream = stream
        self._name = "standard error" if stream is sys.stderr else "standard output"
        self._is_terminal = stream.isatty()
        self._rewrites = self._is_terminal and os.environ.get("TERM") != "dumb"
        self._lock = RLock()
        self._status: Callable[[], str] | None = None
        self._is_drawn = False
        self._begin = time.monotonic()
        self._last_tick = 0.0

    def line(self, text: str) -> None:
        self._write_line(terminal_text, with_short_names(text))

    def command(self, text: str) -> None:
        """Write one line that a CI service reads as a command."""
        self._write_line(printable, text)

    def document(self, text: str) -> None:
        """Write a document whose text is printable already, such as JSON, as it is."""
        with self._lock:
            self.clear()
            self._write(text)

    def status(self, text: Callable[[], str] | None, *, is_frequent: bool = False) -> None:
        """Show a status below the lines from now on, at once and with every `tick`.

        Args:
            text: What it says at any time; None: how long the command has been at work.
            is_frequent: Whether so many follow each other that some need not be written.
        """
        with self._lock:
            self._status = text
            is_due = time.monotonic() - self._last_tick > SHORTEST
            if text is not None and (is_due or not is_frequent):
                self.tick()

    def tick(self) -> None:
        """Write the status line as it is now."""
        if not self._rewrites:
            return
        with self._lock:
            text = self._status() if self._status else f"  working, {self._elapsed:.0f} s"
            self._write(f"{CLEAR_LINE}{cropped(printable(text), self.columns - 1)}")
            self._is_drawn, self._last_tick = True, time.monotonic()

    def clear(self) -> None:
        """Remove the status line, until something writes it again."""
        with self._lock:
            if self._is_drawn:
                self._is_drawn = False
                self._write(CLEAR_LINE)

    @contextmanager
    def ticking(self) -> Iterator[None]:
        """Keep the status line current, in a thread, for as long as a command is at work."""
        if not self._rewrites:
            yield
            return
        from threading import Event, Thread

        end = Event()

        def work() -> None:
            while not end.wait(TICK):
                try:
                    self.tick()
                except (OutputError, OSError):
                    return  # the next line of the command finds out as well

        thread = Thread(target=work, daemon=True)
        thread.start()
        try:
            yield
        finally:
            end.set()
            thread.join()
            self._status = None
            self.clear()

    @property
    def _elapsed(self) -> float:
        return time.monotonic() - self._begin

    @property
    def columns(self) -> int:
        """The width of the terminal [characters]."""
        return shutil.get_terminal_size().columns

    def _write_line(self, shown: Callable[[str], str], text: str) -> None:
        parts = [printable(text)]
        if self._is_terminal:
            end = " \\" if text.lstrip().startswith(AGAIN) else ""
            parts = fitted(parts[0], self.columns, end)
        with self._lock:
            self.clear()
            self._write("".join(f"{shown(part)}\n" for part in parts))

    def _write(self, text: str) -> None:
        try:
            self.stream.write(text)
            self.stream.flush()
        except BrokenPipeError:
            raise
        except OSError as error:
            raise OutputError(f"{self._name} cannot be written: {error.strerror}") from error


_outputs: dict[str, Output] = {}


def output(name: str = "stdout") -> Output:
    """The output of this process on standard output, or on `stderr`."""
    stream: TextIO = getattr(sys, name)
    if name not in _outputs or _outputs[name].stream is not stream:
        _outputs[name] = Output(stream)
    return _outputs[name]


def say(*lines: str) -> None:
    """Write lines to stdout, at once; a line end inside one of them is escaped."""
    for line in lines:
        output().line(line)


def say_text(text: str) -> None:
    """Write a text of several lines to stdout, at once."""
    say(*printable_lines(text).split("\n"))


def complain(text: str) -> None:
    """Write a text to stderr."""
    with suppress(OutputError, BrokenPipeError):  # nothing can be printed; the exit code stays
        output().clear()
        for line in printable_lines(text).split("\n"):
            output("stderr").line(line)


def indented(message: str) -> str:
    """A message whose further lines, whatever is in them, do not look like lines of the program."""
    return message.replace("\n", "\n    ")


FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
OF_A_PATH = (errno.ENAMETOOLONG, errno.ELOOP, errno.EACCES, errno.EROFS, *FULL)  # or of its disk


def guarded(work: Callable[[], int], *, ticks: bool = True) -> int:
    """Run a command; errors that are raised on purpose are shown without a traceback.

    Args:
        ticks: Whether a terminal shows that the command is at work; not where a debugger may be.
    """
    try:
        if not ticks:
            return work()
        with output().ticking():
            return work()
    except SpecError as error:
        complain(str(error))
        return EXIT_CODES["invalid"]
    except UsageError as error:
        complain(printable(f"harness: {error}"))
        return USAGE_EXIT_CODE
    except RobotError as error:
        complain(indented(f"harness: {error}"))
        return USAGE_EXIT_CODE
    except HarnessError as error:
        complain(indented(f"harness: {error}"))
        return EXIT_CODES["error"]
    except (BrokenPipeError, OutputError):
        raise
    except Exception as error:
        if is_interrupted():
            raise KeyboardInterrupt from error
        if missing := missing_extra(error):
            complain(f"harness: {missing}")
            return USAGE_EXIT_CODE
        found = error.__context__ if type(error) is RuntimeError else error  # until Python 3.12
        if isinstance(found, OSError) and found.errno in OF_A_PATH:
            complain(printable(f"harness: '{cropped(str(found.filename), 200)}': {found.strerror}"))
            return USAGE_EXIT_CODE
        complain(error_text(error).rstrip())
        return EXIT_CODES["error"]


_documents: list[str] = []


def say_document(text: str) -> None:
    """Write a document to stdout, as it is, when the command has ended."""
    _documents.append(text)


def say_json(document: object) -> None:
    """Write a document to stdout as JSON when the command has ended."""
    from harness.reporting.json_text import json_text

    say_document(json_text(document))


@contextmanager
def only_json_on_stdout() -> Iterator[None]:
    """Send to stderr whatever prints to stdout meanwhile, native libraries too; then the documents.

    A text buffer of the caller's in place of stdout receives everything.
    """
    sys.stdout.flush()
    _documents.clear()
    try:
        descriptor = sys.stdout.fileno()
    except io.UnsupportedOperation:
        yield
    else:
        true_stdout = os.dup(descriptor)
        os.dup2(2, descriptor)
        try:
            yield
        finally:
            output().clear()
            sys.stdout.flush()
            os.dup2(true_stdout, descriptor)
            os.close(true_stdout)
    for document in _documents:
        output().document(document)
