"""Gathers what scenarios came to in a pytest session; imports nothing until there is one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

TOLD = "harness_told"
"""Attribute of a test report with an item's record as plain data."""


class SessionResults:
    """A plugin of the process that talks to the person: under xdist the one without workers' work.

    Attributes:
        told: Records as plain data by the item's name; a test that runs again counts once.
    """

    def __init__(self, config: pytest.Config) -> None:
        self._config = config
        self.told: dict[str, Any] = {}
        self._lines: list[str] = []

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        told = getattr(report, TOLD, None)
        if told is not None:
            self.told[report.nodeid] = told

    def pytest_sessionfinish(self) -> None:
        if not self.told:
            return
        from harness.core.errors import HarnessError
        from harness.core.printable import printable, terminal_text
        from harness.pytest_plugin.running import report_root
        from harness.pytest_plugin.session_files import (
            from_plains,
            small_margins,
            suite_of,
            write_files,
        )
        from harness.reporting.suite.github import annotations_for_action, append_summary

        records = from_plains(list(self.told.values()))
        self._lines = small_margins(records, getattr(self._config, "cache", None))
        folder, suite = report_root(self._config), suite_of(records)
        asked = self._config.getoption("--harness-history")
        history = Path(asked) if asked else None
        if folder is not None and (line := write_files(folder, suite, history)):
            self._lines.append(line)
        try:
            append_summary(suite)
        except HarnessError as error:
            self._lines.append(str(error))
        self._lines = [terminal_text(line) for line in self._lines]
        self._lines += map(printable, annotations_for_action(suite))

    def pytest_terminal_summary(self, terminalreporter: Any) -> None:
        if self._lines:
            terminalreporter.section("scenarios")
            for line in self._lines:
                terminalreporter.write_line(line)
