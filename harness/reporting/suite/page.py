"""The page of a suite, whose script filters, sorts and groups its rows."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
from datetime import UTC, datetime
from pathlib import Path

from harness.core.versions import library_versions
from harness.reporting.html import bundle
from harness.reporting.html.packing import Packer
from harness.reporting.sampled import missed, rate_text
from harness.reporting.suite.columns import Columns
from harness.reporting.suite.history import History
from harness.reporting.suite.record import SuiteRecord
from harness.reporting.suite.rows import row_facts
from harness.reporting.suite.section import sections
from harness.reporting.terminal import OUTCOMES

FOLDER = Path(__file__).with_name("page")
MOST_ROWS = 10_000  # cases that the page lists
MOST_PLAIN_ROWS = 200  # where scripts are blocked


def suite_html(
    record: SuiteRecord,
    columns: Columns,
    folder: Path,
    history: History | None = None,
) -> str:
    """One self-contained page; links to the cases' pages are relative to its folder.

    Args:
        columns: What varies in its cases, with at most `MOST_ROWS` listed.
    """
    total, outcomes = len(record.cases), columns.outcomes
    packer = Packer()
    urgent = columns.listed  # the first of them get pictures
    rows = {i: row_facts(i, record.cases[i], folder, history or {}, packer) for i in urgent}
    passed = f"{outcomes['passed']} of {total} passed"
    return bundle.rendered(
        FOLDER / "suite.html",
        script=bundle.script(FOLDER / "suite.js"),
        style=bundle.theme() + (FOLDER / "suite.css").read_text(encoding="utf-8"),
        record=record,
        title=record.title or "; ".join(filter(None, (passed, missed(record.rates)))),
        outcomes=[(name, outcomes[name]) for name in reversed(OUTCOMES) if outcomes[name]],
        causes=columns.causes.most_common(),
        rates=[
            (each, each.rate, rate_text("", each.rate).partition(": ")[2])
            for each in sorted(record.rates, key=lambda each: each.outcome == "passed")
        ],
        **{"campaign": None, "failing_changes": (), **sections(record, columns, folder)},
        is_campaign=len(columns.numbers) + outcomes["invalid"] == total,
        plain=[(c := record.cases[i], c.address(folder)) for i in urgent[:MOST_PLAIN_ROWS]],
        data=packer.text({"rows": [rows[i] for i in sorted(rows)], "history": bool(history)}),
        has_history=bool(history),
        wall=record.wall,
        of_cases=sum(each["wall"] for each in rows.values()),
        made=made(),
        unlisted=total - len(rows),
    )


def made() -> list[str]:
    """When, from which commit of this folder, with what and where a page is made."""
    commit = ""
    if shutil.which("git"):
        command = ["git", "rev-parse", "--short=10", "HEAD"]
        commit = subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()
    machine = f"{platform.system()} {platform.machine()}, {os.cpu_count()} processors"
    program = f"armharness {library_versions()['armharness']}, Python {platform.python_version()}"
    made = [f"{datetime.now(UTC):%Y-%m-%d %H:%M} UTC", commit and f"commit {commit}"]
    return [*filter(None, made), program, machine]
