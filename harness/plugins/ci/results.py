"""Results of a suite, read back from its `results.json`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

from harness.plugins.ci.document import read_document
from harness.plugins.ci.suite_reporters.junit import SAMPLE
from harness.recording.run import Outcome
from harness.reporting.suite.record import FORMAT, SuiteCase
from harness.reporting.suite.write import RESULTS
from harness.suite.discovery import UsageError
from harness.suite.stream import result_of

NUMBERS = ("margin", "time", "value", "limit", "ceiling")
"""Keys of verdicts and measures whose null is a number that is not finite."""


@dataclass(frozen=True)
class SavedSuite:
    """What a suite left in its `results.json`.

    Attributes:
        outcome: The gravest outcome; samples count by their success rates.
        sampled: File and group of the cases that are judged by a success rate.
    """

    outcome: Outcome
    cases: list[SuiteCase]
    sampled: frozenset[tuple[str, str]] = frozenset()

    def may_fail(self, case: SuiteCase) -> bool:
        """Whether a case failed as one of samples, which are judged by their success rate."""
        group = SAMPLE.sub("", case.result.case)
        is_sample = group != case.result.case and (case.result.file, group) in self.sampled
        return is_sample and case.result.outcome == "failed"

    def failures(self) -> list[SuiteCase]:
        """The cases that count as failed, the worst first."""
        found = (c for c in self.cases if c.result.outcome != "passed" and not self.may_fail(c))
        return sorted(found, key=lambda case: case.urgency)


def read_results(folder: Path) -> SavedSuite:
    """The results in a report folder.

    Raises:
        UsageError: The folder has no results, or they cannot be read.
    """
    file = folder / RESULTS
    advice = "name the --report-dir of `harness run` with several cases, or of `harness merge`"
    document = read_document(file, FORMAT, advice)
    try:
        rates = ((rate["file"], rate["group"]) for rate in document["rates"])
        cases = [_case(each) for each in document["cases"]]
        known: tuple[Outcome, ...] = get_args(Outcome)
        return SavedSuite(known[known.index(document["outcome"])], cases, frozenset(rates))
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError) as error:
        raise UsageError(f"'{file}' is no file of results: {error}") from error


def _case(plain: dict[str, Any]) -> SuiteCase:
    for verdict in plain["verdicts"]:
        for part in (verdict, *verdict["measures"]):
            part.update({key: math.nan for key in NUMBERS if key in part and part[key] is None})
    if not math.isfinite(sum((result := result_of(plain)).wall_times.values(), result.sim_time)):
        raise ValueError("a time is not finite")
    return SuiteCase(result, plain["values"], tuple(plain["tags"]), tuple(plain["verifies"]))
