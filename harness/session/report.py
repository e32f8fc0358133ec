"""The report folder of a run."""

from __future__ import annotations

from pathlib import Path

from harness.core.activity import Activity
from harness.recording.run import Run
from harness.recording.store import StoredRun, write_run
from harness.reporting.reporter import write_with
from harness.session.pictures import FOLDER, draw_failures
from harness.session.prepare import Prepared
from harness.session.run_request import RunRequest


def write_report(
    request: RunRequest, folder: Path, prepared: Prepared, stored: StoredRun, activity: Activity
) -> tuple[str, ...]:
    """Write a judged run with its pictures, page, bag and other reports, as they are requested.

    Returns:
        Notes for the user, such as that no pictures could be drawn.

    Raises:
        HarnessError: The folder cannot be written, or a reporter fails.
    """

    def add(target: Path) -> tuple[str, ...]:
        notes = _draw_stills(prepared, stored.run, target, activity) if request.stills else ()
        reporters = (*["html"] * request.page, *["rosbag"] * request.bag, *request.reporters)
        write_with(reporters, target, stored, activity)
        return notes

    return write_run(folder, stored, extra=add)


def _draw_stills(prepared: Prepared, run: Run, target: Path, activity: Activity) -> tuple[str, ...]:
    from harness.cameras.stills import save_stills

    description, objects = prepared.program.description, prepared.program.all_objects()
    report = save_stills(description, objects, run, target / FOLDER, activity=activity)
    draw_failures(description, objects, run, target, activity)
    return (report.note,) if report.note else ()
