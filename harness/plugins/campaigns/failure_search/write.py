"""The files of a search: a scenario for each failure with its report, a page, and the numbers."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from harness.core.files import replaced, write_whole, writing
from harness.core.printable import counted, printable
from harness.language.reading.load import load_scenario
from harness.language.reading.resolve import resolved_text
from harness.language.reading.written import as_written
from harness.plugins.campaigns.failure_search.evaluator import Sample
from harness.plugins.campaigns.failure_search.failing_change import FailingChange
from harness.plugins.campaigns.failure_search.search import Failure, SearchResult
from harness.plugins.campaigns.failure_search.space import Parameter
from harness.reporting.json_text import json_text
from harness.reporting.result import CaseResult
from harness.reporting.suite.cause import cause_of
from harness.reporting.suite.record import SuiteCase, SuiteRecord
from harness.reporting.suite.write import write_suite_page
from harness.session.run_request import RunRequest
from harness.suite.cases import run_isolated
from harness.suite.discovery import SUFFIX
from harness.suite.folders import place_of
from harness.suite.warm import WarmServer

FORMAT = "armharness-search/1"
FOLDER = "search"
NUMBERS = "search.json"


@dataclass(frozen=True)
class Written:
    """The runs of a search that have a report.

    Attributes:
        failures: The shrunk failures, those with the smallest changes first.
        nominal: The run of the file as it is; without a report where nothing failed.
    """

    failures: Sequence[WrittenFailure]
    nominal: CaseResult


@dataclass(frozen=True)
class WrittenFailure:
    """A failure as a scenario file, which was run.

    Attributes:
        result: The result of running that file, with its report.
    """

    failure: Failure
    file: Path
    result: CaseResult

    @property
    def is_same(self) -> bool:
        """Whether the file's run has the digest of the run that was found."""
        return self.result.digest == self.failure.nearest.result.digest


def search_folder(root: Path, file: Path) -> Path:
    """Where the files of a search go."""
    return root / FOLDER / place_of(file)


def write_failures(found: SearchResult, folder: Path, server: WarmServer) -> Written:
    """Write each shrunk failure as a scenario file, run that file, and report the run.

    The file as it is runs once more, with a report to compare the failures with.

    Raises:
        HarnessError: A file cannot be written.
    """
    failures = sorted(found.failures, key=lambda each: found.space.size(each.nearest.point))
    files = [folder / f"failure{i}{SUFFIX}" for i in range(1, len(failures) + 1)]
    with writing(folder):
        for stale in folder.glob(f"failure*{SUFFIX}"):
            stale.unlink()
        for file, failure in zip(files, failures, strict=True):
            write_whole(file, scenario_text(found, failure, folder))
    if not failures:
        return Written((), found.nominal.result)
    jobs = [RunRequest(file, report_dir=folder / file.name.removesuffix(SUFFIX)) for file in files]
    overrides = {**found.overrides, **found.space.overrides(found.nominal.point)}
    seed = found.request.settings.seed
    jobs.append(RunRequest(found.request.file, overrides, seed=seed, report_dir=folder / "nominal"))
    cap = found.request.hard_cap
    results = dict(run_isolated(jobs, server, workers=found.request.workers, hard_cap=cap))
    pairs = enumerate(zip(failures, files, strict=True))
    written = [WrittenFailure(failure, file, results[index]) for index, (failure, file) in pairs]
    return Written(written, results[len(files)])


def scenario_text(found: SearchResult, failure: Failure, folder: Path) -> str:
    """A scenario file that fails as the shrunk failure does, without anything that varies."""
    sample = failure.nearest
    overrides = {**found.overrides, **found.space.overrides(sample.point)}
    loaded = load_scenario(found.request.file, overrides, found.request.settings.seed)
    lines = [
        f"The smallest change of '{found.request.file}' that was found to fail in this way:",
        failure.text,
        *changes(found, sample),
        f"digest: {sample.result.digest}",
    ]
    comments = "".join(f"# {printable(line)}\n" for line in lines)
    return comments + resolved_text(loaded, folder=folder)


def changed(found: SearchResult, sample: Sample) -> list[tuple[Parameter, Any]]:
    """Each parameter that is not nominal, with its value."""
    indices = found.space.changed(sample.point)
    return [(found.space.parameters[i], sample.point[i]) for i in indices]


def changes(found: SearchResult, sample: Sample) -> list[str]:
    """`friction: 1.0 -> 0.42` for each parameter that is not nominal."""
    return [f"{each.path}: {each.nominal} -> {value}" for each, value in changed(found, sample)]


def tried(found: SearchResult) -> list[str]:
    """What the search did, a sentence each."""
    runs, start = len(found.exploration.samples), len(found.exploration.start)
    ranges = ", ".join(f"{each.path} ({each.range})" for each in found.space.parameters)
    shrunk = sum(each.shrink_runs for each in found.failures)
    where = "spread evenly over the ranges"
    if runs > start:
        where = f"{start} {where} and {runs - start} where margins are small"
    more = [f"{counted(shrunk, 'more run')} found the smallest changes."] if shrunk else []
    return [f"Varied: {ranges}.", f"{counted(runs, 'run')}, listed below: {where}.", *more]


def write_search(found: SearchResult, written: Written, folder: Path) -> Path:
    """Write the page and the numbers of a search.

    Returns:
        The path of the page.

    Raises:
        HarnessError: A file cannot be written.
    """
    values = found.space.values
    unchanged = SuiteCase(written.nominal, values(found.nominal.point))
    failing = [
        SuiteCase(_reported(each), values(each.failure.nearest.point)) for each in written.failures
    ]
    repeated = {
        each.result.case: ("run", str(failure.file))
        for failure in written.failures
        for each in failure.failure.samples
    }
    cases = [
        SuiteCase(each.result, values(each.point), again=repeated.get(each.result.case, ()))
        for each in found.exploration.samples
    ]
    changes = [
        FailingChange(
            [
                (parameter.path, parameter.nominal, value, parameter.places(value))
                for parameter, value in changed(found, each.failure.nearest)
            ],
            cause.text if (cause := cause_of(each.result)) else each.failure.text,
            shlex.join(["harness", "run", str(each.file)]),
            len(each.failure.samples),
            (("the file as it is", unchanged), ("with the change", case)),
        )
        for each, case in zip(written.failures, failing, strict=True)
    ]
    outcome = "failed" if is_failing(found) else "passed"
    with writing(folder), replaced(folder / NUMBERS) as file:
        file.write(json_text(search_document(found, written)).encode())
    record = SuiteRecord(outcome, cases, (), False, (), _title(found), changes, tried(found))
    return write_suite_page(folder, record)


def _title(found: SearchResult) -> str:
    """What the search found, in a few words."""
    name, runs = found.request.file.name.removesuffix(SUFFIX), len(found.exploration.samples)
    if found.nominal.result.outcome != "passed":
        return f"{name} fails unchanged"
    if not found.failures:
        return f"{name}: no failure in {counted(runs, 'run')}"
    failed = sum(each.result.outcome != "passed" for each in found.exploration.samples)
    kinds = len(found.failures)
    places = f"{kinds} steps or expectations" if kinds > 1 else "1 step or expectation"
    return f"{name}: {failed} of {counted(runs, 'run')} failed, in {places}"


def is_failing(found: SearchResult) -> bool:
    """Whether the scenario fails somewhere."""
    return found.nominal.result.outcome != "passed" or bool(found.failures)


def _reported(written: WrittenFailure) -> CaseResult:
    """The run of a shrunk failure, with the name and the report of its scenario file."""
    name = written.file.name.removesuffix(SUFFIX)
    own, result = written.result, written.failure.nearest.result
    return replace(result, case=name, report_dir=own.report_dir, page=own.page)


def search_document(found: SearchResult, written: Written) -> dict[str, object]:
    """The content of `search.json` and `--json`."""
    exploration = found.exploration
    return {
        "format": FORMAT,
        "file": str(found.request.file),
        "outcome": "failed" if is_failing(found) else "passed",
        "nominal": {"outcome": found.nominal.result.outcome, "digest": found.nominal.result.digest},
        "parameters": {
            each.path: {"nominal": each.nominal, **as_written(each.distribution)}
            for each in found.space.parameters
        },
        "runs": len(exploration.samples),
        "uncounted": found.uncounted,
        "first_failure": exploration.first_failure or None,
        "rate": exploration.rate,
        "failures": [
            {
                "kind": each.failure.text,
                "cause": cause.text if (cause := cause_of(each.result)) else "",
                "runs": len(each.failure.samples),
                "shrink_runs": each.failure.shrink_runs,
                "values": found.space.values(each.failure.nearest.point),
                "changed": [each.path for each, _ in changed(found, each.failure.nearest)],
                "distance": found.space.distance(each.failure.nearest.point),
                "scenario": str(each.file),
                "report": each.result.report_dir,
                "digest": each.result.digest,
                "is_same_digest": each.is_same,
            }
            for each in written.failures
        ],
    }
