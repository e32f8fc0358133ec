"""Pictures of a run: what its cameras saw, and the states that explain its failed steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from harness.assertions.looks import looks_of_expectations
from harness.core.activity import Activity
from harness.core.world import WorldObject
from harness.recording.explanation import recorded_explanation
from harness.recording.looks import looks_of_steps, merged_looks
from harness.recording.run import CaptureRecord, Finding, Run, StepRecord, VideoRecord
from harness.robot.description import RobotDescription
from harness.session.prepare import Prepared

FOLDER = "images"


@dataclass(frozen=True)
class CameraPictures:
    """What the cameras of a run saw.

    Attributes:
        files: Content of the pictures and videos by path in the run's folder.
        findings: Notes on the videos.
    """

    captures: tuple[CaptureRecord, ...] = ()
    videos: tuple[VideoRecord, ...] = ()
    files: Mapping[str, bytes] = field(default_factory=dict[str, bytes])
    findings: tuple[Finding, ...] = ()


def camera_pictures(
    run: Run, prepared: Prepared, *, is_kept: bool, activity: Activity
) -> CameraPictures:
    """Every picture that a verdict reads, and those that only people look at.

    Args:
        run: What was executed, its cameras included.
        prepared: The scenario: its expectations, its videos, and the visuals of its bodies.
        is_kept: Whether the run is written; otherwise only what a verdict reads is drawn.
        activity: Called for each picture and frame.
    """
    program = prepared.program
    looked = looks_of_expectations(run, prepared.expectations)
    taken = looks_of_steps(run.steps)
    seen = {(look.camera, look.sample) for look in looked}
    taken = tuple(look for look in taken if is_kept or (look.camera, look.sample) in seen)
    looks = merged_looks([*taken, *looked])
    videos = program.videos if is_kept else {}
    if not looks and not videos:
        return CameraPictures()
    from harness.cameras.captures import take_pictures  # drawing: few scenarios have cameras
    from harness.cameras.videos import record_videos

    objects = program.all_objects()
    captures, files = take_pictures(program.description, objects, run, looks, activity)
    films, film_files, notes = record_videos(
        program.description, objects, run, videos, activity=activity
    )
    return CameraPictures(captures, films, {**files, **film_files}, tuple(notes))


def with_picture_names(steps: Sequence[StepRecord]) -> tuple[StepRecord, ...]:
    """The steps with the file of its picture in each explanation that has a state to draw."""
    return tuple(_with_picture_name(step, number) for number, step in enumerate(steps, start=1))


def draw_failures(
    description: RobotDescription,
    objects: Sequence[WorldObject],
    run: Run,
    folder: Path,
    activity: Activity,
) -> None:
    """Draw the pictures that `with_picture_names` has named, into a report's folder."""
    explained = ((step, recorded_explanation(step.explanation)) for step in run.steps)
    drawn = [(step, found.picture) for step, found in explained if found.picture is not None]
    if not drawn:
        return
    from harness.cameras.failure_pictures import draw_failure

    (folder / FOLDER).mkdir(parents=True, exist_ok=True)
    for number, (step, picture) in enumerate(drawn):
        activity("drawing why steps failed", number, len(drawn))
        draw_failure(description, objects, run, step, folder / picture)


def _with_picture_name(step: StepRecord, number: int) -> StepRecord:
    if recorded_explanation(step.explanation).nearest is None:
        return step
    from harness.cameras.stills import step_slug

    name = f"{FOLDER}/{number:02d}-{step_slug(step.id)}-why.jpg"
    return replace(step, explanation={**step.explanation, "picture": name})
