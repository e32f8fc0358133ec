"""Runs of the same case side by side: kept until they are known to be the same."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from harness.core.errors import HarnessError
from harness.recording.first_difference import first_difference
from harness.recording.read_run import read_run
from harness.reporting.result import CaseResult
from harness.session.run_request import RunRequest


class Repetitions:
    """Keeps the record of every run, and finds the first difference between two runs.

    Attributes:
        jobs: Each case's runs, one after the other; only the first may be reported for good.
        differences: Index of a run -> how it first differs from the first run of its case.
    """

    def __init__(self, jobs: Sequence[RunRequest], repeat: int) -> None:
        self._folder = TemporaryDirectory(prefix="harness-repeat-")
        self._repeat = repeat
        self._results: dict[int, CaseResult] = {}
        self.differences: dict[int, str] = {}
        self.jobs = [
            self._run_of(job, first + number)
            for first, job in zip(range(0, len(jobs) * repeat, repeat), jobs, strict=True)
            for number in range(repeat)
        ]

    def __enter__(self) -> Repetitions:
        return self

    def __exit__(self, *_: object) -> None:
        self._folder.cleanup()

    def _run_of(self, job: RunRequest, index: int) -> RunRequest:
        if index % self._repeat == 0 and job.report_dir is not None:
            return job
        kept = Path(self._folder.name) / str(index)
        return replace(job, report_dir=kept, stills=False, page=False, bag=False, reporters=())

    def take(self, index: int, result: CaseResult) -> CaseResult:
        """Note a run's result, and compare it as soon as the first of its case is there.

        Returns:
            The result, without a report that will not stay.
        """
        self._results[index] = result
        first = index - index % self._repeat
        if first in self._results:
            mine = range(first + 1, first + self._repeat) if index == first else (index,)
            for other in mine:
                if other in self._results:
                    self._compare(first, other)
        is_kept = Path(self._folder.name) not in Path(result.report_dir or "/").parents
        return result if is_kept else replace(result, report_dir="")

    def _compare(self, first: int, other: int) -> None:
        ours, theirs = self._results[first], self._results[other]
        if (ours.outcome, ours.digest) != (theirs.outcome, theirs.digest):
            self.differences[other] = _difference(ours, theirs)
        if theirs.report_dir:
            shutil.rmtree(theirs.report_dir, ignore_errors=True)


def _difference(ours: CaseResult, theirs: CaseResult) -> str:
    try:
        one, two = (read_run(Path(each.report_dir)).run for each in (ours, theirs))
    except (HarnessError, OSError):
        return f"it ended as {theirs.outcome}, the first as {ours.outcome}; one left no record"
    found = first_difference(one, two)
    if found is None:
        return "every sample is the same; plans or verdicts are not"
    where = f"in step '{found.step}', " if found.step else ""
    return (
        f"first {where}{found.signal} at t={found.time:.3f} s: {found.before!r} in the first run, "
        f"{found.after!r} in this one"
    )
