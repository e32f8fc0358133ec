"""pytest collects `*.scenario.yaml`: one item a scenario, run in a process of its own.

Loaded in every pytest run of an environment, so it imports nothing of the harness until a
scenario file is met.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from fnmatch import fnmatch
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from harness.pytest_plugin.session import TOLD, SessionResults

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
        default=None,
        help="where reports of scenarios go (default: the ini key, or reports)",
    )
    group.addoption(
        "--harness-no-report", action="store_true", default=False, help="write no reports"
    )
    group.addoption(
        "--harness-history",
        metavar="DIR",
        default=None,
        help="a folder of earlier results.json files, whose margins the session's page shows",
    )
    group.addoption(
        "--harness-in-process",
        action="store_true",
        default=False,
        help="run scenarios in pytest's own process, for debuggers",
    )
    group.addoption(
        "--harness-plugin",
        metavar="MODULE",
        action="append",
        default=[],
        help="load the plug-ins of a Python module (its name, or a .py file)",
    )
    parser.addini("harness_plugins", "modules whose plug-ins scenarios may use", type="args")
    parser.addini(
        "harness_files",
        "names of scenario files; empty: none are collected",
        type="args",
        default=PATTERNS,
    )
    parser.addini("harness_report_dir", "where reports go, from the root folder", default="reports")
    parser.addini("harness_hard_cap", "wall seconds after which a scenario is an error", default="")


def pytest_configure(config: pytest.Config) -> None:
    """Load plug-ins; gather results where a person sees them, which is not in xdist's workers."""
    modules = [*config.getini("harness_plugins"), *(config.getoption("--harness-plugin") or [])]
    if modules:
        _load_plugins(modules)
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(SessionResults(config), "armharness-session")


def _load_plugins(modules: list[str]) -> None:
    from harness.core.registry import PluginError, load_plugin

    try:
        for module in modules:
            load_plugin(module)
    except PluginError as error:
        raise pytest.UsageError(str(error)) from error


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Send what a scenario came to with the report of its test."""
    report = yield
    told = getattr(item, TOLD, None)
    if told is not None and call.when == "call":
        setattr(report, TOLD, told)
    return report


@pytest.fixture
def harness_scenario(request: pytest.FixtureRequest) -> Callable[..., ScenarioResult]:
    """Runs a scenario in a process of its own: `harness_scenario("pick.scenario.yaml")`.

    Takes what `harness.run` takes; reports go below the session's, under the test's name.
    """
    from harness.pytest_plugin.fixture import runner_of

    return runner_of(request)


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> ScenarioFile | None:
    """Collect scenario files."""
    if not any(fnmatch(file_path.name, name) for name in parent.config.getini("harness_files")):
        return None
    from harness.pytest_plugin.item import ScenarioFile

    return ScenarioFile.from_parent(parent, path=file_path)
