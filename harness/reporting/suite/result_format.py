"""What other programs read of results on standard output, as a plug-in."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, ClassVar

from harness.core.registry import Plugin, registry

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from harness.core.errors import Problem
    from harness.reporting.result import CaseResult
    from harness.reporting.suite.record import SuiteRecord


class ResultFormat(Plugin, ABC):
    """A value of `--format`; its module is imported with the options of a command.

    Attributes:
        text: What is printed, for the help of the option.
        is_of_runs: Whether `harness run` has the format too, and not only `harness check`.
    """

    plugin_kind: ClassVar[str] = "result_format"
    text: ClassVar[str] = ""
    is_of_runs: ClassVar[bool] = True

    @abstractmethod
    def problems(self, invalid: Sequence[Problem], predicted: Sequence[Problem]) -> str:
        """The text for mistakes in files, and for steps that will fail."""

    def failures(self, results: Iterable[CaseResult]) -> Iterator[str]:
        """Lines for results that did not pass."""
        del results
        yield from ()

    def write_summary(self, record: SuiteRecord) -> None:
        """Write what the service shows of a suite, where it runs the command; by default nothing.

        Raises:
            HarnessError: It cannot be written.
        """

    def remarks(self, results: Iterable[CaseResult]) -> Iterator[str]:
        """Lines to print in any case where the service runs the command; by default none."""
        del results
        yield from ()


def result_formats() -> list[ResultFormat]:
    """The built-in formats."""
    return [kind() for kind in registry(ResultFormat.plugin_kind).built_in()]
