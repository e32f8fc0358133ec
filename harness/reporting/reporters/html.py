"""The reporter `html`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from harness.recording.stored_run import StoredRun
from harness.reporting.progress_events import Drawing, ProgressEvent
from harness.reporting.reporter import Reporter

if TYPE_CHECKING:
    from harness.reporting.html.write import Page


class HtmlReporter(Reporter):
    """The page of a run, report.html; written unless `--no-page` is given."""

    name: ClassVar[str] = "html"
    takes_argument: ClassVar[bool] = False

    _page: Page | None = None

    def hear(self, event: ProgressEvent) -> None:
        """Pack what the page shows of the motion, while pictures are being drawn."""
        if isinstance(event, Drawing):
            from harness.reporting.html.write import Page

            self._page = Page(event.run, event.verdicts)

    def write(self, folder: Path, stored: StoredRun) -> None:
        from harness.reporting.html.write import write_page

        write_page(folder, stored, self._page)
