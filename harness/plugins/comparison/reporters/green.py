"""The reporter `green`."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from harness.core.errors import HarnessError
from harness.recording.stored_run import StoredRun
from harness.reporting.reporter import Reporter


class GreenReporter(Reporter):
    """Keep the last passed run of each case in DIR (`green=DIR`), and compare failed ones with it.

    The report of a run that failed gets a page of both runs.
    """

    name: ClassVar[str] = "green"

    def write(self, folder: Path, stored: StoredRun) -> None:
        """Write the page of a run that failed, and keep one that passed.

        Raises:
            HarnessError: No folder is given, or it is the one of the reports.
        """
        from harness.plugins.comparison.green import against_green, green_folder
        from harness.recording.write_run import write_run

        if not self.argument:
            raise HarnessError("the reporter `green` needs a folder: --reporter green=DIR")
        green = green_folder(Path(self.argument), stored.run)
        if green.parent.resolve() == folder.parent.resolve():
            raise HarnessError(
                f"--reporter green={self.argument} is the folder of the reports, where each run"
                " replaces the last one; choose another folder"
            )
        if stored.outcome == "passed":
            write_run(green, stored)
        else:
            against_green(green, folder, stored)
