"""A reporter: the verdicts as a table of comma-separated values."""

import csv
from pathlib import Path

from harness.reporting.reporter import Reporter, StoredRun


class VerdictTable(Reporter):
    """The verdicts of a run, a line for each: status and margin."""

    name = "verdict_table"

    def write(self, folder: Path, stored: StoredRun) -> None:
        """Write verdicts.csv."""
        with (folder / "verdicts.csv").open("w", newline="", encoding="utf-8") as file:
            rows = csv.writer(file)
            rows.writerows([verdict.status, verdict.margin] for verdict in stored.verdicts)
