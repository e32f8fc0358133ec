"""The files of a suite's results, written while the results are read once."""

from __future__ import annotations

from pathlib import Path

from harness.reporting.suite.columns import Columns
from harness.reporting.suite.record import SuiteCase
from harness.reporting.suite.write import History, replaced, write_suite, writing
from harness.suite.conditions import FILE, ConditionWriter
from harness.suite.suite_run import SuiteRun


def write_results(suite: SuiteRun, folder: Path, history: History) -> tuple[Path, Columns]:
    """Write page, JUnit XML, results, and the conditions of samples.

    A part of a suite has conditions only where they were given to it: those of all parts are
    written by the merge.

    Returns:
        The page, and what varies in the cases.

    Raises:
        HarnessError: A file cannot be written.
    """
    has_samples = any(each.rate_key is not None for each in suite.plan)
    if suite.is_part or not has_samples:
        return write_suite(folder, suite.record, suite.exit_code, history)
    indices = list(suite.results)
    with writing(folder), replaced(folder / FILE) as file:
        conditions = ConditionWriter(file)

        def add(number: int, case: SuiteCase) -> None:
            conditions.add(suite.plan[indices[number]], case)

        return write_suite(folder, suite.record, suite.exit_code, history, on_case=add)
