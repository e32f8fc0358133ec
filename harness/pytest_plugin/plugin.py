"""pytest collects `*.scenario.yaml` files: one item per scenario, run in its own process.

pytest loads this module in every run of an environment, so it imports nothing else of the harness
until a scenario file is collected.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from fnmatch import fnmatch
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from harness.pytest_plugin.session_options import MARGIN, RECORD, report_root

if TYPE_CHECKING:
    from harness.pytest_plugin.item import ScenarioFile
    from harness.suite.api import ScenarioResult

PATTERNS = ["*.scenario.yaml"]


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options and ini keys."""
    group = parser.getgroup("armharness", "scenarios of robot arms")
    group.addoption(
        "--harness-report-dir",
        metavar="DIR",
        help="folder for scenario reports (default: the ini key harness_report_dir, else reports)",
    )
    group.addoption("--harness-no-report", action="store_true", help="do not write reports")
    group.addoption(
        "--harness-reporter",
        metavar="NAME",
        action="append",
        default=[],
        help="let a reporter write into the reports too, such as green=DIR, which compares runs"
        " that fail with the last one that passed; repeatable",
    )
    group.addoption(
        "--harness-history",
        metavar="DIR",
        help="folder of earlier results.json files; the suite page shows their margins",
    )
    group.addoption(
        "--harness-in-process",
        action="store_true",
        help="run scenarios inside the pytest process, so that a debugger can attach",
    )
    group.addoption(
        "--harness-strict",
        action="store_true",
        help="fail scenarios where a verdict has a warning, such as `already true at the start`",
    )
    group.addoption(
        "--harness-plugin",
        metavar="MODULE",
        action="append",
        default=[],
        help="load the plug-ins of a Python module (a module name or a .py file)",
    )
    group.addoption(
        "--harness-node",
        metavar="[NAME=]COMMAND",
        action="append",
        default=[],
        help="a command that scenarios may start as a ROS 2 node (see the ini key harness_nodes)",
    )
    parser.addini("harness_nodes", "commands of ROS 2 nodes in scenarios", type="linelist")
    parser.addini("harness_plugins", "modules that provide plug-ins for scenarios", type="args")
    parser.addini(
        "harness_files",
        "file name patterns of scenario files; an empty value collects none",
        type="args",
        default=PATTERNS,
    )
    parser.addini(
        "harness_report_dir", "folder for reports, relative to the root folder", default="reports"
    )
    parser.addini(
        "harness_hard_cap", "wall time [s] after which a scenario ends as an error", default=""
    )


def pytest_configure(config: pytest.Config) -> None:
    """Load plug-ins; collect results in the main process only, not in xdist's workers."""
    modules = [*config.getini("harness_plugins"), *(config.getoption("--harness-plugin") or [])]
    if modules:
        from harness.core.registry import load_plugin

        with _usage_errors():
            for module in modules:
                load_plugin(module)
    if reporters := config.getoption("--harness-reporter"):
        from harness.reporting.reporter import check_reporters

        with _usage_errors("--harness-reporter: "):
            check_reporters(reporters, report_root(config))
    if config.getoption("--harness-report-dir") and (folder := report_root(config)):
        from harness.suite.folders import refuse_unwritable

        with _usage_errors():
            refuse_unwritable(folder, "--harness-report-dir: ")
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(SessionResults(config), "armharness-session")


@contextmanager
def _usage_errors(option: str = "") -> Generator[None]:
    """Report what an option cannot mean as pytest's wrong usage."""
    from harness.core.error_text import error_text
    from harness.core.errors import HarnessError

    try:
        yield
    except (HarnessError, ModuleNotFoundError) as error:
        text = str(error) if isinstance(error, HarnessError) else error_text(error)
        raise pytest.UsageError(f"{option}{text}") from None


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Attach a scenario's record to the report of its test."""
    report = yield
    record = getattr(item, RECORD, None)
    if record is not None and call.when == "call":
        setattr(report, RECORD, record)
        if item.config.pluginmanager.hasplugin("html"):
            from harness.pytest_plugin.html_report import add_to_html
            from harness.pytest_plugin.session_files import from_plains

            [kept] = from_plains([record])
            add_to_html(report, item.config, kept.cases)
    return report


@pytest.hookimpl(optionalhook=True)
def pytest_html_results_table_header(cells: list[str]) -> None:
    """Add a column to the table of pytest-html."""
    cells.insert(2, "<th>Worst margin</th>")


@pytest.hookimpl(optionalhook=True)
def pytest_html_results_table_row(report: pytest.TestReport, cells: list[str]) -> None:
    """Fill that column, which is empty of tests that are no scenarios."""
    cells.insert(2, f"<td>{escape(getattr(report, MARGIN, ''))}</td>")


@pytest.fixture
def harness_scenario(request: pytest.FixtureRequest) -> Callable[..., ScenarioResult]:
    """Run a scenario in its own process: `harness_scenario("pick.scenario.yaml")`.

    The function takes the arguments of `harness.run`. Reports go to the session's report folder,
    under the test's name.
    """
    from harness.pytest_plugin.fixture import runner_of

    return runner_of(request)


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> ScenarioFile | None:
    """Collect scenario files."""
    if not any(fnmatch(file_path.name, name) for name in parent.config.getini("harness_files")):
        return None
    from harness.pytest_plugin.item import ScenarioFile

    return ScenarioFile.from_parent(parent, path=file_path)


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
        from harness.reporting.suite.result_format import result_formats

        records = from_plains(list(self.records.values()))
        self._lines = small_margins(records, getattr(self._config, "cache", None))
        folder, suite = report_root(self._config), suite_of(records)
        earlier = self._config.getoption("--harness-history")
        history = Path(earlier) if earlier else None
        if folder is not None and (line := write_session_files(folder, suite, history)):
            self._lines.append(line)
        remarks: list[str] = []
        for each in result_formats():
            remarks += each.remarks(case.result for case in suite.cases)
            try:
                each.write_summary(suite)
            except HarnessError as error:
                self._lines.append(str(error))
        self._lines = [*map(terminal_text, self._lines), *map(printable, remarks)]

    @pytest.hookimpl(optionalhook=True)
    def pytest_html_results_summary(self, prefix: list[str]) -> None:
        """Let the report of pytest-html begin with what failed, in colours that can be read."""
        if self.records:
            from harness.pytest_plugin.html_report import head
            from harness.pytest_plugin.session_files import from_plains

            cases = [case for each in from_plains([*self.records.values()]) for case in each.cases]
            page = Path(report_root(self._config) or "", "index.html")
            target = Path(self._config.getoption("htmlpath") or "").resolve()
            prefix.append(head(cases, target.parent, page))

    def pytest_terminal_summary(self, terminalreporter: Any) -> None:
        if self._lines:
            terminalreporter.section("scenarios")
            for line in self._lines:
                terminalreporter.write_line(line)
