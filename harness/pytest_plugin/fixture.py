"""The fixture that runs scenarios from hand-written tests."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from harness.pytest_plugin.session_options import hard_cap, report_root, server_of, shown
from harness.reporting.result import CaseResult
from harness.session.run_request import RunRequest
from harness.suite.api import ScenarioResult, run_in_process, run_scenario
from harness.suite.cases import run_isolated

if TYPE_CHECKING:
    from harness.language.scenario import Scenario


def runner_of(request: pytest.FixtureRequest) -> Callable[..., ScenarioResult]:
    """A function that runs scenarios for one test and gives each call its own report folder."""
    config = request.config
    count = 0

    def isolated(job: RunRequest) -> CaseResult:
        [(_index, result)] = run_isolated([job], server_of(config), hard_cap=hard_cap(config))
        return result

    def run(
        scenario: str | Path | Scenario,
        *,
        overrides: Mapping[str, Any] | None = None,
        seed: int | None = None,
        case: str = "",
    ) -> ScenarioResult:
        nonlocal count
        count += 1
        root = report_root(config)
        name = re.sub(r"[^\w.-]+", "_", request.node.name)
        folder = None if root is None else root / "tests" / f"{name}-{count}"
        result = run_scenario(
            _found(request, scenario),
            overrides=overrides,
            seed=seed,
            case=case,
            report_dir=folder,
            runner=run_in_process if config.getoption("--harness-in-process") else isolated,
        )
        if not result:  # `assert result` alone says no more than its title
            request.node.add_report_section("call", "scenario", str(result))
        return result

    return run


def _found(request: pytest.FixtureRequest, scenario: str | Path | Scenario) -> Any:
    """The scenario next to the test's file where that file exists; otherwise the name as given."""
    if isinstance(scenario, str | Path):
        sibling = request.path.parent / scenario
        return shown(sibling) if sibling.is_file() else Path(scenario)
    return scenario
