"""Running an item: processes, verdicts, what pytest's reports carry."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest

from harness.core.printable import printable, terminal_text
from harness.pytest_plugin.item import ScenarioItem
from harness.pytest_plugin.session import TOLD
from harness.pytest_plugin.session_files import ItemRecord, as_plain
from harness.reporting.result import CaseResult
from harness.reporting.sampled import SampledRate, rate_text
from harness.reporting.suite.junit import case_properties, sample_properties
from harness.reporting.suite.record import SuiteCase
from harness.reporting.terminal import causes
from harness.suite.cases import run_here, run_isolated
from harness.suite.header import source_lines
from harness.suite.leftovers import clean_report_folder
from harness.suite.plan import PlannedCase, Wanted, planned
from harness.suite.sampling import Sampling
from harness.suite.warm import ServerStartError, WarmServer

TOLD_SAMPLES = 3
SERVER = pytest.StashKey[WarmServer]()
CLEANED = pytest.StashKey[bool]()


class ScenarioNotPassed(Exception):
    """A scenario failed, is invalid, or broke; says why, with every number."""

    def __init__(self, result: CaseResult) -> None:
        told = causes(result, source_lines(Path(result.file)))
        if result.report_dir:
            told.append(printable(f"report: {result.report_dir}"))
        super().__init__("\n".join(told))


class RateNotShown(Exception):
    """Samples of a scenario do not show the rate that was asked for; says which failed, and why."""

    def __init__(self, rate: str, failed: Sequence[CaseResult]) -> None:
        told = [rate]
        for result in failed[:TOLD_SAMPLES]:
            told += ["", printable(f"{result.case}:")]
            told += causes(result, source_lines(Path(result.file)))
            told.append(printable(f"again: harness run {result.file} --case {result.case}"))
        if len(failed) > TOLD_SAMPLES:
            told += ["", f"... and {len(failed) - TOLD_SAMPLES} more samples that failed"]
        super().__init__("\n".join(told))


TOLD_AS_THEY_ARE = (ScenarioNotPassed, RateNotShown, ServerStartError)
"""Failures whose text says everything, without a traceback."""


def run_item(item: ScenarioItem) -> None:
    """Run a case, or all samples of one; raises what tells why it did not pass."""
    root = report_root(item.config)
    if root is not None and not item.config.stash.get(CLEANED, False):
        item.config.stash[CLEANED] = True
        clean_report_folder(root)
    plan = [
        each
        for each in planned([shown(item.path)], Wanted(report_root=root))
        if item.case == (each.case.name if each.case.sample is None else each.case.group)
    ]
    sampling = Sampling(plan)
    results = _run(item, plan, sampling)
    if item.header.variation.samples:
        _judge_samples(item, plan, sampling, results)
        return
    [(index, result)] = results.items()
    case = _suite_case(plan[index], result)
    _keep(item, [case])
    _tell(item, case)
    if result.outcome != "passed":
        raise ScenarioNotPassed(result)


def _judge_samples(
    item: ScenarioItem,
    plan: Sequence[PlannedCase],
    sampling: Sampling,
    results: Mapping[int, CaseResult],
) -> None:
    counted = dict(sorted(sampling.counted(results).items()))
    cases = [_suite_case(plan[index], result) for index, result in counted.items()]
    _keep(item, cases, sampling.groups())
    item.user_properties += sample_properties(cases)
    broken = [each for each in counted.values() if each.outcome in ("invalid", "error")]
    if broken:
        raise ScenarioNotPassed(broken[0])
    [group] = sampling.groups()
    rate = group.rate
    line = printable(rate_text(item.name, rate))
    item.user_properties += [("passed", rate.passed), ("samples", rate.total)]
    item.add_report_section("call", "samples", line)
    if group.outcome != "passed":
        raise RateNotShown(line, [r for r in counted.values() if r.outcome != "passed"])


def _run(
    item: ScenarioItem, plan: Sequence[PlannedCase], sampling: Sampling
) -> dict[int, CaseResult]:
    jobs = [each.job for each in plan]
    if item.config.getoption("--harness-in-process"):
        arriving = run_here(jobs, is_needless=sampling.is_needless)
    else:
        cap = item.config.getini("harness_hard_cap")
        arriving = run_isolated(
            jobs,
            server_of(item.config),
            hard_cap=float(cap) if cap else None,
            is_needless=sampling.is_needless,
        )
    results: dict[int, CaseResult] = {}
    for index, result in arriving:
        results[index] = result
        sampling.note(index, result.outcome)
    return results


def _keep(
    item: ScenarioItem, cases: Sequence[SuiteCase], rates: Sequence[SampledRate] = ()
) -> None:
    """Have the test's report carry what this came to, to the files of the session."""
    record = ItemRecord(item.nodeid, item.number, tuple(cases), tuple(rates))
    setattr(item, TOLD, as_plain(record))


def _tell(item: ScenarioItem, case: SuiteCase) -> None:
    """Put what a later reader needs beside the test's outcome."""
    result = case.result
    item.user_properties += case_properties(case)
    if result.report_dir:
        item.user_properties.append(("report", result.report_dir))
    for note in result.notes:
        item.add_report_section("call", "scenario", terminal_text(note))


def _suite_case(planned_case: PlannedCase, result: CaseResult) -> SuiteCase:
    header = planned_case.header
    return SuiteCase(result, planned_case.values, header.tags, header.verifies)


def report_root(config: pytest.Config) -> Path | None:
    """Where the session's reports go; None where none are written."""
    if config.getoption("--harness-no-report"):
        return None
    asked = config.getoption("--harness-report-dir")
    return Path(asked) if asked else config.rootpath / config.getini("harness_report_dir")


def server_of(config: pytest.Config) -> WarmServer:
    """The fork server of this pytest process; it ends with pytest."""
    if SERVER not in config.stash:
        config.stash[SERVER] = server = WarmServer()
        config.add_cleanup(server.close)
    return config.stash[SERVER]


def shown(path: Path) -> Path:
    """A path as a person would write it."""
    here = Path.cwd()
    return path.relative_to(here) if path.is_relative_to(here) else path
