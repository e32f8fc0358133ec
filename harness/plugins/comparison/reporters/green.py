"""The reporter `green`."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from harness.core.errors import HarnessError
from harness.core.files import path_exists
from harness.recording.stored_run import StoredRun
from harness.reporting.reporter import Reporter


class GreenReporter(Reporter):
    """Keep the last passed run of each case in DIR (`green=DIR`), and compare failed ones with it.

    The report of a run that failed gets a page of both runs.
    """

    name: ClassVar[str] = "green"

    def check(self, reports: Path | None) -> None:
        """Refuse an argument that is no folder of its own."""
        kept = Path(self.argument)
        if not self.argument:
            raise HarnessError("the reporter `green` needs a folder: green=DIR")
        if any(path_exists(each) and not each.is_dir() for each in (kept, *kept.parents)):
            raise HarnessError(f"green={self.argument} is no folder; choose another one")
        if reports is not None and kept.resolve() == reports.resolve():
            raise HarnessError(
                f"green={self.argument} is the folder of the reports, where each run replaces the"
                " last one; choose another folder"
            )

    def write(self, folder: Path, stored: StoredRun) -> None:
        """Write the page of a run that failed, and keep one that passed."""
        from harness.plugins.comparison.green import against_green, green_folder
        from harness.recording.write_run import write_run

        green = green_folder(Path(self.argument), stored.run)
        if stored.outcome == "passed":
            write_run(green, stored)
        else:
            against_green(green, folder, stored)
