"""Pictures and videos of a run, drawn from its record before it is judged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from harness.assertions.looks import looks_of_expectations
from harness.assertions.placed import PlacedExpectation
from harness.cell.program import Program
from harness.core.activity import Activity, unobserved
from harness.recording.looks import looks_of_steps, merged_looks
from harness.recording.run import Run


def with_camera_pictures(
    run: Run,
    program: Program,
    expectations: Sequence[PlacedExpectation],
    *,
    is_kept: bool,
    activity: Activity = unobserved,
) -> Run:
    """The run with every picture that a verdict reads, and with those that only people look at.

    Args:
        run: What happened, its cameras included.
        program: With the robot's and the objects' looks.
        expectations: That will be judged.
        is_kept: Whether the run is written; else what no verdict reads is not drawn.
        activity: Called for each picture and frame.
    """
    looked = looks_of_expectations(run, expectations)
    taken = looks_of_steps(run.steps)
    seen = {(look.camera, look.sample) for look in looked}
    taken = tuple(look for look in taken if is_kept or (look.camera, look.sample) in seen)
    looks = merged_looks([*taken, *looked])
    videos = program.videos if is_kept else {}
    if not looks and not videos:
        return run
    from harness.cameras.captures import take_pictures  # drawing: few scenarios have cameras
    from harness.cameras.videos import record_videos

    objects = program.all_objects()
    captures, files = take_pictures(program.description, objects, run, looks, activity)
    films, film_files, notes = record_videos(
        program.description, objects, run, videos, activity=activity
    )
    return replace(
        run,
        captures=captures,
        videos=films,
        files={**run.files, **files, **film_files},
        findings=(*run.findings, *notes),
    )
