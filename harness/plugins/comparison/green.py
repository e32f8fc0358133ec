"""The last run of a case that passed, and the page of a failed run next to it."""

from __future__ import annotations

from pathlib import Path

from harness.core.files import path_exists, write_whole
from harness.plugins.comparison.compare import compare
from harness.plugins.comparison.html import comparison_page
from harness.recording.read_run import read_run
from harness.recording.run import Run
from harness.recording.stored_run import RUN, StoredRun
from harness.suite.folders import folder_name, report_folders

PAGE = "against_last_green.html"


def green_folder(root: Path, run: Run) -> Path:
    """Where the last passed run of a case is kept: at the place of its report below the root."""
    [folder] = report_folders([Path(run.file)], root)
    return folder / folder_name(run.case) if run.case else folder


def against_green(green: Path, folder: Path, failed: StoredRun) -> None:
    """Write the page of a failed run next to the last passed one; nothing where there is none.

    Args:
        green: The folder of the passed run.
        folder: The report of the failed one, which gets the page.
        failed: The run that failed, with its pictures.

    Raises:
        HarnessError: The passed run is damaged.
    """
    if not path_exists(green / RUN):
        return
    passed = read_run(green)
    names = "last green run", "this run"
    page = comparison_page(passed, failed, compare(passed, failed), names)
    write_whole(folder / PAGE, page)
