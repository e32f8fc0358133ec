"""What a plug-in adds to the page of a suite."""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path
from typing import Any, ClassVar

from harness.core.registry import Plugin, registry
from harness.reporting.suite.columns import Columns
from harness.reporting.suite.record import SuiteRecord


class SuiteSection(Plugin, ABC):
    """A section of the page, which the template knows by its name."""

    plugin_kind: ClassVar[str] = "suite_section"

    @abstractmethod
    def content(self, record: SuiteRecord, columns: Columns, folder: Path) -> Any:
        """What the template shows; None leaves the section out.

        Args:
            folder: Where the page will stand; links are relative to it.
        """


def sections(record: SuiteRecord, columns: Columns, folder: Path) -> dict[str, Any]:
    """The content of each built-in section by its name."""
    known = registry(SuiteSection.plugin_kind)
    return {name: known[name]().content(record, columns, folder) for name in known.built_in_modules}
