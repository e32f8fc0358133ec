"""The reporter `html`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from harness.recording.stored_run import StoredRun
from harness.reporting.reporter import Reporter

if TYPE_CHECKING:
    from harness.reporting.html.write import Page


class HtmlReporter(Reporter):
    """The page of a run, report.html; written unless `--no-page` is given."""

    name: ClassVar[str] = "html"
    takes_argument: ClassVar[bool] = False

    _page: Page | None = None

    def begin(self, stored: StoredRun) -> None:
        """Pack what the page shows of the motion."""
        from harness.reporting.html.write import Page

        self._page = Page(stored)

    def write(self, folder: Path, stored: StoredRun) -> None:
        """Write the page."""
        from harness.reporting.html.write import write_page

        write_page(folder, stored, self._page)
