"""The reporter `html`."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from harness.recording.stored_run import StoredRun
from harness.reporting.reporter import Reporter


class HtmlReporter(Reporter):
    """The page of a run, report.html; written unless `--no-page` is given."""

    name: ClassVar[str] = "html"

    def write(self, folder: Path, stored: StoredRun) -> None:
        """Write the page."""
        from harness.reporting.html.write import write_page

        write_page(folder, stored)
