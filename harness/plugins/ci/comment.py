"""One comment on a pull request, or a merge request, in Markdown."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from urllib.parse import quote

from harness.core.printable import counted
from harness.plugins.ci.baseline import ShrunkMargin
from harness.plugins.ci.github import SIGNS, markdown_cell
from harness.plugins.ci.results import SavedSuite
from harness.reporting.suite.failure_picture import picture_of
from harness.reporting.suite.record import SuiteCase
from harness.reporting.suite.write import PAGE

MARK = "<!-- armharness -->"
"""The first line, by which a script finds the comment that it updates."""
MOST_ROWS = 20
"""Rows of a table, which keep the comment below the 65,536 characters that GitHub takes."""


def comment_text(
    suite: SavedSuite, shrunk: Sequence[ShrunkMargin], folder: Path, address: str = ""
) -> str:
    """Counts, failures, margins that shrank, and a picture of the worst failure.

    Args:
        suite: The results of a suite.
        shrunk: The margins that shrank since the baseline.
        folder: The report folder of the suite.
        address: Where the report folder is published; empty: the picture is named and not shown.
    """
    failures = suite.failures()
    outcome = "failed" if shrunk and suite.outcome == "passed" else suite.outcome
    passed = sum(case.result.outcome == "passed" for case in suite.cases)
    counts = [f"{passed} of {counted(len(suite.cases), 'case')} passed"]
    gone = sum(each.is_gone for each in shrunk)
    counts += [f"{counted(len(shrunk) - gone, 'margin')} shrank"] if len(shrunk) > gone else []
    counts += [f"{counted(gone, 'expectation')} gone"] if gone else []
    lines = [MARK, f"### {SIGNS[outcome]} armharness: {'; '.join(counts)}"]
    lines += _table(
        ("case", "why it did not pass"),
        [(each.result.name, each.cause.text if each.cause else "") for each in failures],
    )
    lines += shrunk_table(shrunk)
    lines += _picture(failures[0], folder, address) if failures else []
    if address:
        lines += ["", f"[The page of all cases]({_link(address, folder / PAGE, folder)})"]
    return "\n".join(lines) + "\n"


def shrunk_table(shrunk: Sequence[ShrunkMargin]) -> list[str]:
    """The lines of a table of margins; none without margins."""
    rows = [(each.expectation, each.case, each.change) for each in shrunk]
    return _table(("expectation", "case", "margin"), rows)


def _table(titles: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    if not rows:
        return []
    lines = ["", f"| {' | '.join(titles)} |", f"|{'---|' * len(titles)}"]
    lines += [f"| {' | '.join(map(markdown_cell, row))} |" for row in rows[:MOST_ROWS]]
    return [*lines, *(["", f"and {len(rows) - MOST_ROWS} more"] if len(rows) > MOST_ROWS else [])]


def _picture(case: SuiteCase, folder: Path, address: str) -> list[str]:
    picture, name = picture_of(case), markdown_cell(case.result.name)
    if not picture:
        return []
    if address:
        return ["", f"![{name}]({_link(address, Path(picture), folder)})"]
    return ["", f"Picture of {name}: {markdown_cell(_path(Path(picture), folder))} in the reports"]


def _link(address: str, file: Path, folder: Path) -> str:
    return f"{address.rstrip('/')}/{quote(_path(file, folder))}"


def _path(file: Path, folder: Path) -> str:
    return Path(os.path.relpath(file, folder)).as_posix()
