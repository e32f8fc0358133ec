"""Pictures of a run: what its cameras saw, its steps, and the states that explain failures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from harness.assertions.looks import looks_of_expectations
from harness.core.activity import Activity
from harness.core.details import Details
from harness.recording.explanation import Explanation, recorded_explanation
from harness.recording.looks import Look, looks_of_steps, merged_looks
from harness.recording.robot_record import MeshRecord
from harness.recording.run import Finding, Run
from harness.recording.signals import CaptureRecord, VideoRecord
from harness.recording.step_record import StepRecord
from harness.session.background import Background
from harness.session.prepare import Prepared
from harness.session.run_request import RunRequest

FOLDER = "images"
Files = Mapping[str, bytes]
"""Content of files by path in the run's folder."""

Captures = tuple[tuple[CaptureRecord, ...], Files]
"""Pictures that the scenario's cameras took, and their files."""


@dataclass(frozen=True)
class Drawings:
    """What only people look at.

    Attributes:
        videos: The videos of the scenario's cameras.
        findings: Notes on the videos.
        files: The files of the videos.
        meshes: The triangles that the page shows.
        images: Pictures of the steps, and of the states that explain failures.
        note: A line on limitations of the pictures; empty without limitations.
    """

    videos: tuple[VideoRecord, ...] = ()
    findings: tuple[Finding, ...] = ()
    files: Files = field(default_factory=dict[str, bytes])
    meshes: tuple[MeshRecord, ...] = ()
    images: Files = field(default_factory=dict[str, bytes])
    note: str = ""


class Pictures:
    """The pictures of an executed run, drawn in other processes while this one observes it."""

    def __init__(self, request: RunRequest, prepared: Prepared, run: Run) -> None:
        """Begin to draw what the verdicts read, and what is certain to be kept.

        Args:
            request: The request of the case.
            prepared: The scenario: its expectations, its videos, and the visuals of its bodies.
            run: What was executed and recorded.
        """
        self._request, self._prepared, self._run = request, prepared, run
        is_kept = request.report_dir is not None and not request.only_failed
        self._captures = self._begin_captures(is_kept=is_kept)
        self._drawings = self._begin_drawings() if is_kept else None

    def close(self) -> None:
        """End the processes that are at work."""
        for background in (self._captures, self._drawings):
            if background is not None:
                background.close()

    def captured(self, run: Run, activity: Activity) -> Run:
        """The run with the pictures that verdicts read."""
        return _with_captures(run, self._captures, activity)

    def begin(self) -> None:
        """Begin to draw what is kept, before this process has threads: then it is not forked."""
        if self._request.only_failed:
            self._captures = self._begin_captures(is_kept=True)
        if self._drawings is None:
            self._drawings = self._begin_drawings()

    def drawn(self, run: Run, activity: Activity) -> tuple[Run, Drawings]:
        """The run as it is kept, with all pictures of its cameras; and its drawings."""
        if self._request.only_failed:
            run = _with_captures(run, self._captures, activity)
        assert self._drawings is not None, "begin() begins it"
        drawings = self._drawings.result(activity)
        run = replace(
            run,
            steps=_with_picture_names(run.steps) if self._request.stills else run.steps,
            findings=(*run.findings, *drawings.findings),
            meshes=drawings.meshes,
            videos=drawings.videos,
            files={**run.files, **drawings.files},
        )
        return run, drawings

    def _begin_captures(self, *, is_kept: bool) -> Background[Captures] | None:
        """The pictures that verdicts read; where the run is kept, those of steps too."""
        run = self._run
        looked = looks_of_expectations(run, self._prepared.expectations)
        seen = {(look.camera, look.sample) for look in looked}
        taken = looks_of_steps(run.steps)
        taken = [look for look in taken if is_kept or (look.camera, look.sample) in seen]
        looks = merged_looks([*taken, *looked])
        return Background(partial(_captures, self._prepared, run, looks)) if looks else None

    def _begin_drawings(self) -> Background[Drawings]:
        request, prepared = self._request, self._prepared
        return Background(partial(_drawings, prepared, self._run, are_steps_drawn=request.stills))


def _with_captures(run: Run, captures: Background[Captures] | None, activity: Activity) -> Run:
    if captures is None:
        return run
    records, files = captures.result(activity)
    return replace(run, captures=records, files=files)


def _captures(prepared: Prepared, run: Run, looks: Sequence[Look], activity: Activity) -> Captures:
    from harness.cameras.captures import take_pictures

    program = prepared.program
    return take_pictures(program.description, program.all_objects(), run, looks, activity)


def _drawings(
    prepared: Prepared, run: Run, activity: Activity, *, are_steps_drawn: bool
) -> Drawings:
    from harness.cameras.stills import Stills, draw_stills
    from harness.observation.visuals import mesh_records

    program = prepared.program
    description, objects = program.description, program.all_objects()
    stills, images = Stills(), {}
    if are_steps_drawn:
        stills = draw_stills(description, objects, run, activity=activity)
        images = {f"{FOLDER}/{name}": content for name, content in stills.files.items()}
        images |= _failures(prepared, run, activity)
    drawings = Drawings(meshes=mesh_records(run), images=images, note=stills.note)
    if not program.videos:
        return drawings
    from harness.cameras.videos import record_videos  # loads a video library

    videos, files, findings = record_videos(
        description, objects, run, program.videos, activity=activity
    )
    return replace(drawings, videos=videos, files=files, findings=findings)


def _failures(prepared: Prepared, run: Run, activity: Activity) -> dict[str, bytes]:
    """The pictures that `_with_picture_names` names."""
    steps = [
        (step, picture)
        for step in _with_picture_names(run.steps)
        if (picture := recorded_explanation(step.explanation).picture) is not None
    ]
    if not steps:
        return {}
    from harness.cameras.failure_pictures import draw_failure

    program = prepared.program
    files: dict[str, bytes] = {}
    for number, (step, picture) in enumerate(steps):
        activity("drawing why steps failed", number, len(steps))
        files[picture] = draw_failure(program.description, program.all_objects(), run, step)
    return files


def _with_picture_names(steps: Sequence[StepRecord]) -> tuple[StepRecord, ...]:
    """The steps with the file of its picture in each explanation that has a state to draw."""
    return tuple(_with_picture_name(step, number) for number, step in enumerate(steps, start=1))


def _with_picture_name(step: StepRecord, number: int) -> StepRecord:
    if recorded_explanation(step.explanation).nearest is None:
        return step
    from harness.cameras.stills import step_slug

    name = f"{FOLDER}/{number:02d}-{step_slug(step.id)}-why.jpg"
    return replace(step, explanation=step.explanation + Details.of(Explanation(picture=name)))
