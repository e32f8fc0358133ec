"""Collect the results of a pytest session; imports the harness only when there are results."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from harness.pytest_plugin.session_options import RECORD, report_root


class SessionResults:
    """A pytest plugin of the main process; under xdist, of the controller.

    Attributes:
        records: Node id -> record as plain data; a test that runs again counts once.
    """

    def __init__(self, config: pytest.Config) -> None:
        self._config = config
        self.records: dict[str, Any] = {}
        self._lines: list[str] = []

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        record = getattr(report, RECORD, None)
        if record is not None:
            self.records[report.nodeid] = record

    def pytest_sessionfinish(self) -> None:
        if not self.records:
            return
        from harness.core.errors import HarnessError
        from harness.core.printable import printable, terminal_text
        from harness.pytest_plugin.session_files import (
            from_plains,
            small_margins,
            suite_of,
            write_session_files,
        )
        from harness.reporting.suite.github import annotations_for_action, append_summary

        records = from_plains(list(self.records.values()))
        self._lines = small_margins(records, getattr(self._config, "cache", None))
        folder, suite = report_root(self._config), suite_of(records)
        earlier = self._config.getoption("--harness-history")
        history = Path(earlier) if earlier else None
        if folder is not None and (line := write_session_files(folder, suite, history)):
            self._lines.append(line)
        try:
            append_summary(suite)
        except HarnessError as error:
            self._lines.append(str(error))
        self._lines = [terminal_text(line) for line in self._lines]
        self._lines += map(printable, annotations_for_action(case.result for case in suite.cases))

    def pytest_terminal_summary(self, terminalreporter: Any) -> None:
        if self._lines:
            terminalreporter.section("scenarios")
            for line in self._lines:
                terminalreporter.write_line(line)
