"""What writes a file about a suite next to its results, as a plug-in."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import IO, ClassVar

from harness.core.registry import Plugin
from harness.reporting.suite.record import SuiteCase, SuiteRecord


class SuiteReporter(Plugin, ABC):
    """Writes one file of a suite, case by case; every suite with files of its own has it."""

    plugin_kind: ClassVar[str] = "suite_reporter"
    file: ClassVar[str] = ""

    @abstractmethod
    def __init__(self, record: SuiteRecord) -> None:
        """Begin a document; the cases of the record are not read."""

    @abstractmethod
    def add(self, case: SuiteCase) -> None:
        """Take the next case."""

    @abstractmethod
    def write(self, file: IO[bytes]) -> None:
        """Write the document, and let go of what was kept of it."""
