"""The report folder of a run."""

from __future__ import annotations

from pathlib import Path

from harness.core.activity import Activity
from harness.recording.files import write_files
from harness.recording.store import StoredRun, write_run
from harness.reporting.reporter import write_with
from harness.session.pictures import Files
from harness.session.run_request import RunRequest


def write_report(
    request: RunRequest, folder: Path, stored: StoredRun, images: Files, activity: Activity
) -> None:
    """Write a judged run with its pictures, page, bag and other reports, as they are requested.

    Raises:
        HarnessError: The folder cannot be written, or a reporter fails.
    """

    def add(target: Path) -> None:
        write_files(target, images)
        reporters = (*["html"] * request.page, *["rosbag"] * request.bag, *request.reporters)
        write_with(reporters, target, stored, activity)

    write_run(folder, stored, extra=add)
