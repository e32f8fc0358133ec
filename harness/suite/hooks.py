"""What a plug-in can change in how a suite is planned, run and written."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterator

    from harness.reporting.result import CaseResult
    from harness.reporting.suite.columns import Columns
    from harness.reporting.suite.write import History
    from harness.session.run_request import RunRequest
    from harness.suite.cases import Chooser
    from harness.suite.plan import FileCases, Plan
    from harness.suite.request import SuiteRequest
    from harness.suite.suite_run import SuiteRun

Execute: TypeAlias = (
    "Callable[[Sequence[RunRequest], Sequence[Path], Chooser], Iterator[tuple[int, CaseResult]]]"
)
"""Runs the cases of files elsewhere: requests, files, and which indices are not needed -> index and
result of each case as it ends."""


@dataclass(frozen=True)
class SuiteHooks:
    """Changes of a suite; None leaves a part of it as it is.

    Attributes:
        live: The Unix socket to which the cases send their poses; empty sends none.
        cases: Replaces the cases of the files before some are selected.
        part: Chooses the part of the selected cases that this command runs; no rate of samples is
            decided then.
        planned: Called with the files and the request of the whole suite before a case runs.
        begun: Called with the suite before a case runs; returns what is called with the index of
            each result as it comes.
        execute: Runs the cases in place of this machine's processes.
        writes_single_case: Whether a suite of a single case gets the files of a suite too.
        write: Writes the files of the suite into a folder in place of `write_suite`.
    """

    live: str = ""
    cases: Callable[[Sequence[FileCases]], Sequence[FileCases]] | None = None
    part: Callable[[Plan], Plan] | None = None
    planned: Callable[[Sequence[Path], SuiteRequest], None] | None = None
    begun: Callable[[SuiteRun], Callable[[int], None]] | None = None
    execute: Execute | None = None
    writes_single_case: bool = False
    write: Callable[[SuiteRun, Path, History], tuple[Path, Columns]] | None = None


NO_HOOKS = SuiteHooks()
