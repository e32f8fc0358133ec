"""A scenario as a pytest item."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

from harness.pytest_plugin.session import TOLD
from harness.pytest_plugin.session_files import ItemRecord, as_plain
from harness.reporting.result import CaseResult
from harness.reporting.sampled import SampledRate, rate_line
from harness.reporting.suite.junit import case_properties, sample_properties
from harness.reporting.suite.record import SuiteCase
from harness.reporting.terminal import causes
from harness.suite.cases import run_here, run_isolated
from harness.suite.header import Header, read_header, source_lines
from harness.suite.plan import PlannedCase, Wanted, planned
from harness.suite.sampling import Sampling
from harness.suite.warm import ServerStartError, WarmServer

TOLD_SAMPLES = 3
SERVER = pytest.StashKey[WarmServer]()
PYTEST_MARKS = frozenset(
    ("skip", "skipif", "xfail", "parametrize", "parameterize", "parametrise", "parameterise",
     "usefixtures", "filterwarnings", "tryfirst", "trylast")
)  # fmt: skip
"""Marks that change what a verdict means, or that pytest refuses: no tag becomes one of them."""


class ScenarioNotPassed(Exception):
    """A scenario failed, is invalid, or broke; says why, with every number."""

    def __init__(self, result: CaseResult) -> None:
        told = causes(result, source_lines(Path(result.file)))
        if result.report_dir:
            told.append(f"report: {result.report_dir}")
        super().__init__("\n".join(told))


class RateNotShown(Exception):
    """Samples of a scenario do not show the rate that was asked for; says which failed, and why."""

    def __init__(self, rate: str, failed: Sequence[CaseResult]) -> None:
        told = [rate]
        for result in failed[:TOLD_SAMPLES]:
            told += ["", f"{result.case}:", *causes(result, source_lines(Path(result.file)))]
            told.append(f"again: harness run {result.file} --case {result.case}")
        if len(failed) > TOLD_SAMPLES:
            told += ["", f"... and {len(failed) - TOLD_SAMPLES} more samples that failed"]
        super().__init__("\n".join(told))


class ScenarioFile(pytest.File):
    """A scenario file with its cases; the random samples of one are one item."""

    def collect(self) -> Iterable[ScenarioItem]:
        header = read_header(self.path)
        title = header.title.replace("::", ":")
        for number, case in enumerate(header.variation.parametrized()):
            name = f"{title}[{case.name}]" if case.name else title
            yield ScenarioItem.from_parent(
                self, name=name, header=header, case=case.name, number=number
            )


class ScenarioItem(pytest.Item):
    """One case of a scenario, or all samples of it."""

    def __init__(self, *, header: Header, case: str, number: int, **keywords: Any) -> None:
        super().__init__(**keywords)
        self._header = header
        self._case = case
        self._number = number
        self.extra_keyword_matches.add(self.path.name)
        for tag in header.tags:
            self.extra_keyword_matches.add(tag)
            if tag not in PYTEST_MARKS and not tag.startswith("_"):
                self.config.addinivalue_line("markers", f"{tag}: a scenario's tag")
                self.add_marker(getattr(pytest.mark, tag))

    def runtest(self) -> None:
        plan = [
            each
            for each in planned([shown(self.path)], Wanted(report_root=report_root(self.config)))
            if self._case == (each.case.name if each.case.sample is None else each.case.group)
        ]
        sampling = Sampling(plan)
        results = self._run(plan, sampling)
        if self._header.variation.samples:
            self._judge_samples(plan, sampling, results)
            return
        [(index, result)] = results.items()
        case = _suite_case(plan[index], result)
        self._keep([case])
        self._tell(case)
        if result.outcome != "passed":
            raise ScenarioNotPassed(result)

    def _judge_samples(
        self, plan: Sequence[PlannedCase], sampling: Sampling, results: Mapping[int, CaseResult]
    ) -> None:
        counted = dict(sorted(sampling.counted(results).items()))
        cases = [_suite_case(plan[index], result) for index, result in counted.items()]
        self._keep(cases, sampling.groups())
        self.user_properties += sample_properties(cases)
        broken = [each for each in counted.values() if each.outcome in ("invalid", "error")]
        if broken:
            raise ScenarioNotPassed(broken[0])
        [group] = sampling.groups()
        rate = group.rate
        line = rate_line(self.name, rate)
        self.user_properties += [("passed", rate.passed), ("samples", rate.total)]
        self.add_report_section("call", "samples", line)
        if group.outcome != "passed":
            raise RateNotShown(line, [r for r in counted.values() if r.outcome != "passed"])

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        if isinstance(excinfo.value, ScenarioNotPassed | RateNotShown | ServerStartError):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int, str]:
        return self.path, self._header.line - 1, self.name

    def _run(self, plan: Sequence[PlannedCase], sampling: Sampling) -> dict[int, CaseResult]:
        jobs = [each.job for each in plan]
        if self.config.getoption("--harness-in-process"):
            arriving = run_here(jobs, is_needless=sampling.is_needless)
        else:
            cap = self.config.getini("harness_hard_cap")
            arriving = run_isolated(
                jobs,
                server_of(self.config),
                hard_cap=float(cap) if cap else None,
                is_needless=sampling.is_needless,
            )
        results: dict[int, CaseResult] = {}
        for index, result in arriving:
            results[index] = result
            sampling.note(index, result.outcome)
        return results

    def _keep(self, cases: Sequence[SuiteCase], rates: Sequence[SampledRate] = ()) -> None:
        """Have the test's report carry what this came to, to the files of the session."""
        record = ItemRecord(self.nodeid, self._number, tuple(cases), tuple(rates))
        setattr(self, TOLD, as_plain(record))

    def _tell(self, case: SuiteCase) -> None:
        """Put what a later reader needs beside the test's outcome."""
        result = case.result
        self.user_properties += case_properties(case)
        if result.report_dir:
            self.user_properties.append(("report", result.report_dir))
        for note in result.notes:
            self.add_report_section("call", "scenario", note)


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
