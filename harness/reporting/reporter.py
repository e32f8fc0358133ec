"""What writes a file into the folder of a finished case, as a plug-in."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Generator, Iterable, Sequence
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import ClassVar

from harness.core.activity import Activity, unobserved
from harness.core.errors import HarnessError
from harness.core.registry import Plugin, described, raised, registry
from harness.recording.stored_run import StoredRun
from harness.reporting.progress_events import ProgressEvent

__all__ = ["Reporter", "StoredRun"]  # what a package needs to add a reporter of its own


class Reporter(Plugin, ABC):
    """A reporter, selected by `harness run --reporter NAME`.

    A reporter reads the finished run, its verdicts and its outcome, and changes none of them.

    Attributes:
        argument: The text after the name in `--reporter NAME=TEXT`; empty without one.
        takes_argument: Whether a text after the name has a meaning; it is refused otherwise.
        package: A package of an extra that it imports; empty if it needs none.
    """

    plugin_kind: ClassVar[str] = "reporter"
    takes_argument: ClassVar[bool] = True
    package: ClassVar[str] = ""

    argument: str = ""

    def check(self, reports: Path | None) -> None:
        """Refuse, before any case runs, what cannot be written; by default nothing.

        Args:
            reports: The folder of all reports; None where none is written.

        Raises:
            HarnessError: The argument is missing, or is not one of this reporter.
        """

    def hear(self, event: ProgressEvent) -> None:
        """Take note of an event of the running case; by default of none."""

    @abstractmethod
    def write(self, folder: Path, stored: StoredRun) -> None:
        """Write files into a case's report folder, which has `run.json` already.

        Args:
            folder: The folder, under the temporary name that it has until it is complete.
        """


class Reports:
    """The reports of one case."""

    def __init__(self, names: Sequence[str]) -> None:
        """Load reporters, each by `NAME` or `NAME=TEXT`.

        Raises:
            LookupError: There is no reporter of that name.
        """
        self._reporters = [find_reporter(text) for text in names]

    def hear(self, event: ProgressEvent) -> None:
        """Pass an event of the running case on.

        Raises:
            HarnessError: A reporter fails; names it and its package.
        """
        for reporter in self._reporters:
            with _blames(reporter.name):
                reporter.hear(event)

    def write(self, folder: Path, stored: StoredRun, activity: Activity = unobserved) -> None:
        """Let all reporters write into a folder.

        Raises:
            HarnessError: A reporter fails; names it and its package.
        """
        for reporter in self._reporters:
            activity(f"writing the report `{reporter.name}`", 0, 0)
            with _blames(reporter.name):
                reporter.write(folder, stored)


def find_reporter(text: str) -> Reporter:
    """The reporter of `NAME` or `NAME=TEXT`, with its argument.

    Raises:
        LookupError: There is no reporter of that name; the message has the nearest one.
    """
    name, _, argument = text.partition("=")
    reporter: Reporter = registry(Reporter.plugin_kind).find(name)()
    reporter.argument = argument
    return reporter


def check_reporters(names: Iterable[str], reports: Path | None) -> None:
    """Refuse reporters that do not exist or cannot write, before any case runs.

    Args:
        names: Each `NAME` or `NAME=TEXT`.
        reports: The folder of all reports; None where none is written.

    Raises:
        HarnessError: There is no such reporter, or what it is given does not suffice.
        ModuleNotFoundError: A package that a reporter needs is not installed.
    """
    for text in names:
        try:
            reporter = find_reporter(text)
        except LookupError as error:
            raise HarnessError(str(error.args[0])) from error
        if reporter.argument and not reporter.takes_argument:
            raise HarnessError(f"the reporter `{reporter.name}` takes no text after its name")
        reporter.check(reports)
        if reporter.package:
            import_module(reporter.package)


@contextmanager
def _blames(name: str) -> Generator[None]:
    """Names the reporter that fails."""
    try:
        yield
    except HarnessError:
        raise
    except Exception as error:
        who = described(Reporter.plugin_kind, name)
        raise HarnessError(f"{who} raised {raised(error)}") from error
