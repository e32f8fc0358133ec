"""Run an item: its processes, its verdicts and the data that pytest's reports carry."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib import import_module
from io import StringIO
from pathlib import Path
from typing import Any

import pytest

from harness.core.printable import printable, terminal_text
from harness.pytest_plugin.session_files import ItemRecord, as_plain
from harness.pytest_plugin.session_options import (
    RECORD,
    hard_cap,
    nodes_of,
    report_root,
    server_of,
    shown,
)
from harness.recording.verdict import Verdict
from harness.reporting.result import CaseResult
from harness.reporting.sampled import SampledRate, rate_text
from harness.reporting.suite.failure_picture import picture_of
from harness.reporting.suite.properties import case_properties, sample_properties
from harness.reporting.suite.record import SuiteCase
from harness.reporting.terminal import causes
from harness.suite.cases import run_here, run_isolated
from harness.suite.header import ScenarioHeader, source_lines
from harness.suite.plan import PlannedCase, planned_cases
from harness.suite.request import SuiteRequest
from harness.suite.sampling import Sampling
from harness.suite.warm import ServerStartError

LISTED_SAMPLES = 3  # in full in pytest's output; the rest is counted


class ScenarioNotPassed(Exception):
    """A scenario failed, is invalid, or ended in an error; the text gives every cause."""

    def __init__(self, result: CaseResult) -> None:
        lines = causes(result, source_lines(Path(result.file)))
        if result.report_dir:
            lines.append(printable(f"report: {result.report_dir}"))
        lines += [printable(f"page: {page}") for page in result.further_pages]
        super().__init__("\n".join(lines))


class RateNotShown(Exception):
    """The samples do not show the required success rate; the text lists the first failed ones."""

    def __init__(self, rate: str, failed: Sequence[CaseResult]) -> None:
        lines = [rate]
        for result in failed[:LISTED_SAMPLES]:
            lines += ["", printable(f"{result.case}:")]
            lines += causes(result, source_lines(Path(result.file)))
            lines.append(printable(f"again: harness run {result.file} --case {result.case}"))
        if len(failed) > LISTED_SAMPLES:
            lines += ["", f"... and {len(failed) - LISTED_SAMPLES} more samples that failed"]
        super().__init__("\n".join(lines))


SELF_EXPLANATORY_ERRORS = (ScenarioNotPassed, RateNotShown, ServerStartError)
"""Errors that pytest prints without a traceback, because their text is complete."""


def run_item(item: pytest.Item, header: ScenarioHeader, case: str, number: int) -> None:
    """Run a case, or all samples of a case.

    Raises:
        ScenarioNotPassed: The case, or one of the samples, is invalid or did not pass.
        RateNotShown: The samples do not show the required success rate.
    """
    root = report_root(item.config)
    request = SuiteRequest(
        report_root=root,
        strict=bool(item.config.getoption("--harness-strict")),
        reporters=tuple(item.config.getoption("--harness-reporter") or ()),
        nodes=nodes_of(item.config),
    )
    plan = [
        each
        for each in planned_cases([shown(item.path)], request)
        if case == (each.name if each.rate_key is None else each.rate_key[1])
    ]
    sampling = Sampling(plan)
    results = _run(item, plan, sampling)
    if header.variation.samples:
        _judge_samples(item, number, plan, sampling, results)
        return
    [(index, result)] = results.items()
    suite_case = _suite_case(plan[index], result)
    _keep(item, number, [suite_case])
    _add_properties(item, suite_case)
    if result.outcome != "passed":
        raise ScenarioNotPassed(result)


def _judge_samples(
    item: pytest.Item,
    number: int,
    plan: Sequence[PlannedCase],
    sampling: Sampling,
    results: Mapping[int, CaseResult],
) -> None:
    counted = {i: each for i, each in sorted(results.items()) if not sampling.is_needless(i)}
    cases = [_suite_case(plan[index], result) for index, result in counted.items()]
    _keep(item, number, cases, sampling.groups())
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
    item: pytest.Item, plan: Sequence[PlannedCase], sampling: Sampling
) -> dict[int, CaseResult]:
    jobs = [each.job for each in plan]
    if item.config.getoption("--harness-in-process"):
        arriving = run_here(jobs, is_needless=sampling.is_needless)
    else:
        arriving = run_isolated(
            jobs,
            server_of(item.config),
            hard_cap=hard_cap(item.config),
            is_needless=sampling.is_needless,
        )
    results: dict[int, CaseResult] = {}
    for index, result in arriving:
        results[index] = replace(result, inputs={})
        sampling.note(index, result.outcome, result.digest)
    return results


def _keep(
    item: pytest.Item, number: int, cases: Sequence[SuiteCase], rates: Sequence[SampledRate] = ()
) -> None:
    """Attach the record to the item, from which the test's report carries it to the session."""
    record = ItemRecord(item.nodeid, number, tuple(cases), tuple(rates))
    setattr(item, RECORD, as_plain(record))
    if item.config.getoption("--alluredir", default=None):
        _attach_to_allure(cases)


def _attach_to_allure(cases: Sequence[SuiteCase]) -> None:
    """Attach page, picture and margins to the test; of samples those of the first that failed."""
    allure: Any = import_module("allure")  # of allure-pytest, whose option is in use
    kinds = allure.attachment_type
    if len(cases) > 1:
        cases = [each for each in cases if each.result.outcome != "passed"][:LISTED_SAMPLES]
    for case in cases:
        name = case.result.name
        if case.result.verdicts:
            text = _margins(case.result.verdicts)
            allure.attach(text, name=f"{name}: margins", attachment_type=kinds.CSV)
        if picture := picture_of(case):
            allure.attach.file(picture, name=f"{name}: picture", attachment_type=kinds.JPG)
        if page := case.result.page:
            allure.attach.file(page, name=f"{name}: report", attachment_type=kinds.HTML)


def _margins(verdicts: Sequence[Verdict]) -> str:
    text = StringIO()
    table = csv.writer(text)
    table.writerow(("expectation", "step", "status", "margin", "unit", "reason"))
    for each in verdicts:
        margin = f"{each.margin:.6g}" if math.isfinite(each.margin) else ""
        table.writerow((each.expectation, each.step, each.status, margin, each.unit, each.reason))
    return text.getvalue()


def _add_properties(item: pytest.Item, case: SuiteCase) -> None:
    """Add the case's properties, report path and notes to the test's report."""
    result = case.result
    item.user_properties += case_properties(case)
    if result.report_dir:
        item.user_properties.append(("report", result.report_dir))
    for note in result.notes:
        item.add_report_section("call", "scenario", terminal_text(note))


def _suite_case(planned_case: PlannedCase, result: CaseResult) -> SuiteCase:
    header = planned_case.header
    return SuiteCase(result, planned_case.values, header.tags, header.verifies)
