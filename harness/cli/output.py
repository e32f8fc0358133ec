"""Writing to the terminal, and errors that a command ends with."""

from __future__ import annotations

import io
import os
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from harness.core.errors import HarnessError, RobotError, SpecError
from harness.suite.discovery import UsageError
from harness.suite.outcome import EXIT_CODES, USAGE_EXIT_CODE


def say(text: str) -> None:
    """Write a line to stdout, at once."""
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


def complain(text: str) -> None:
    """Write a line to stderr."""
    sys.stderr.write(f"{text}\n")
    sys.stderr.flush()


def guarded(work: Callable[[], int]) -> int:
    """A command's work, with errors that are raised on purpose told without a traceback."""
    try:
        return work()
    except SpecError as error:
        complain(str(error))
        return EXIT_CODES["invalid"]
    except (UsageError, RobotError) as error:
        complain(f"harness: {error}")
        return USAGE_EXIT_CODE
    except HarnessError as error:
        complain(f"harness: {error}")
        return EXIT_CODES["error"]
    except BrokenPipeError:
        raise
    except Exception:  # noqa: BLE001 - a defect of ours is an error, and no failed scenario
        complain(traceback.format_exc().rstrip())
        return EXIT_CODES["error"]


@contextmanager
def only_json_on_stdout() -> Iterator[Callable[[object], None]]:
    """Send to stderr whatever prints to stdout meanwhile, native libraries too.

    Yields:
        A function that writes a document to the true stdout, as JSON.
    """
    from harness.reporting.json_text import json_text

    sys.stdout.flush()
    try:
        descriptor = sys.stdout.fileno()
    except io.UnsupportedOperation:  # stdout is a text buffer of the caller's
        yield lambda document: say(json_text(document).rstrip())
        return
    true_stdout = os.dup(descriptor)
    os.dup2(2, descriptor)
    documents: list[object] = []
    try:
        yield documents.append
    finally:
        sys.stdout.flush()
        os.dup2(true_stdout, descriptor)
        os.close(true_stdout)
    for document in documents:
        say(json_text(document).rstrip())
