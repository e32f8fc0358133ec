"""The files of a suite in its folder."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from harness.core.files import replaced, writing
from harness.core.registry import registry
from harness.reporting.suite.columns import Columns
from harness.reporting.suite.history import History
from harness.reporting.suite.page import MOST_ROWS, suite_html
from harness.reporting.suite.record import SuiteCase, SuiteRecord, results_json
from harness.reporting.suite.suite_reporter import SuiteReporter

PAGE = "index.html"
RESULTS = "results.json"


def write_suite(
    folder: Path,
    record: SuiteRecord,
    exit_code: int,
    history: History | None = None,
    *,
    on_case: Callable[[int, SuiteCase], None] | None = None,
) -> tuple[Path, Columns]:
    """Write page, results and the files of reporters; each is whole or as it was.

    The cases are read once, and not kept.

    Args:
        folder: Made where it is missing.
        on_case: Called with the number of each case, and the case; None: nothing is.

    Returns:
        The page's path in the folder, and what varies in the cases.

    Raises:
        HarnessError: A file cannot be written.
    """
    columns = Columns(most_listed=MOST_ROWS)
    kinds: list[type[SuiteReporter]] = [*registry(SuiteReporter.plugin_kind).values()]
    reporters = [kind(record) for kind in kinds]

    def read() -> Iterator[SuiteCase]:
        for number, case in enumerate(record.cases):
            for reporter in reporters:
                reporter.add(case)
            columns.add(case)
            if on_case is not None:
                on_case(number, case)
            yield case

    with writing(folder):
        with replaced(folder / RESULTS) as file:
            for part in results_json(record, exit_code, read()):
                file.write(part.encode())
        for reporter in reporters:
            with replaced(folder / reporter.file) as file:
                reporter.write(file)
    return write_suite_page(folder, record, columns, history), columns


def write_suite_page(
    folder: Path,
    record: SuiteRecord,
    columns: Columns | None = None,
    history: History | None = None,
) -> Path:
    """Write the page of many runs; it is whole or as it was.

    Args:
        folder: Made where it is missing.
        columns: What varies in its cases, with at most `MOST_ROWS` listed; None reads the cases.

    Returns:
        The page's path in the folder.

    Raises:
        HarnessError: A file cannot be written.
    """
    columns = columns or Columns(record.cases, most_listed=MOST_ROWS)
    with writing(folder), replaced(folder / PAGE) as file:
        file.write(suite_html(record, columns, folder, history).encode())
    return folder / PAGE
