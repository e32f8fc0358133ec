"""Pictures of a run: what its cameras saw, its steps, and the states that explain failures."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
from dataclasses import replace
from functools import partial

from harness.cameras.camera_recorder import (
    CameraRecorder,
    Captures,
    Stills,
    camera_recorder,
    has_recorder,
)
from harness.core.activity import Activity
from harness.core.details import Details
from harness.recording.drawings import Drawings
from harness.recording.explanation import Explanation, recorded_explanation
from harness.recording.run import Run
from harness.recording.step_record import StepRecord
from harness.session.background import Background
from harness.session.prepare import Prepared
from harness.session.run_request import RunRequest

FOLDER = "images"
NOT_DRAWN = "no pictures of steps: this installation has no plug-in that draws them"
MOST_EXPLAINED = 100  # most failed steps of which the state that explains them is drawn, 0.2 s each


class Pictures:
    """The pictures of a run, drawn in other processes while this one observes and judges it."""

    _run: Run

    def __init__(self, request: RunRequest, prepared: Prepared) -> None:
        self._request, self._prepared = request, prepared
        self._captures: Background[Captures] | None = None
        self._drawings: Background[Drawings] | None = None

    def executed(self, run: Run) -> None:
        """Begin to draw what the verdicts read, and what is certain to be kept."""
        self._run = run
        self._captures = self._begin_captures()
        if self._request.report_dir is not None and not self._request.only_failed:
            self.begin()

    def close(self) -> None:
        """End the processes that are at work."""
        for background in (self._captures, self._drawings):
            if background is not None:
                background.close()

    def captured(self, activity: Activity) -> Captures:
        return ((), {}) if self._captures is None else self._captures.result(activity)

    def begin(self) -> None:
        """Begin to draw what is kept, before this process has threads: then it is not forked."""
        if self._drawings is None:
            draw = partial(_drawings, self._prepared, self._run)
            self._drawings = Background(partial(draw, are_steps_drawn=self._request.stills))

    def drawn(self, activity: Activity) -> Drawings:
        """What is drawn of a run that is kept."""
        assert self._drawings is not None, "begin() begins it"
        return self._drawings.result(activity)

    def _begin_captures(self) -> Background[Captures] | None:
        """The pictures that verdicts read; where the run may be kept, those of steps too."""
        run, prepared = self._run, self._prepared
        if not run.cameras or not has_recorder():
            return None
        is_kept = self._request.report_dir is not None
        take = _recorder(prepared).pictures(run, prepared.expectations, is_kept=is_kept)
        return None if take is None else Background(take)


def _recorder(prepared: Prepared) -> CameraRecorder:
    return camera_recorder(prepared.program.description, prepared.program.all_objects())


def _drawings(
    prepared: Prepared, run: Run, activity: Activity, *, are_steps_drawn: bool
) -> Drawings:
    """Draw what people look at."""
    from harness.session.observation.visuals import mesh_records

    files: dict[str, bytes] = {}
    note, videos = "", ()
    if are_steps_drawn:
        stills = Stills(note=NOT_DRAWN)
        if has_recorder():
            with closing(_recorder(prepared).step_pictures()) as pictures:
                stills = pictures.draw(run, activity)
        note = stills.note
        files = {f"{FOLDER}/{name}": content for name, content in stills.files.items()}
        files |= _failures(prepared, run, activity)
    if rates := prepared.program.parts.get("videos"):
        videos, films = _recorder(prepared).videos(run, rates, activity)
        files |= films
    return Drawings(mesh_records(run), videos, files, note)


def _failures(prepared: Prepared, run: Run, activity: Activity) -> dict[str, bytes]:
    """The pictures that `with_picture_names` has named."""
    steps = [
        (step, picture)
        for step in run.steps
        if (picture := recorded_explanation(step.explanation).picture) is not None
    ]
    if not steps:
        return {}
    recorder = _recorder(prepared)
    files: dict[str, bytes] = {}
    for number, (step, picture) in enumerate(steps):
        activity("drawing why steps failed", number, len(steps))
        files[picture] = recorder.failure_picture(run, step)
    return files


def with_picture_names(steps: Sequence[StepRecord]) -> tuple[StepRecord, ...]:
    """The steps with the file of its picture in each explanation that has a state to draw.

    Only the first `MOST_EXPLAINED` of them have one.
    """
    named: list[StepRecord] = []
    left = MOST_EXPLAINED if has_recorder() else 0
    for number, step in enumerate(steps, start=1):
        has_picture = left > 0 and recorded_explanation(step.explanation).nearest is not None
        left -= has_picture
        name = Explanation(picture=f"{FOLDER}/{number:02d}-{step.slug}-why.jpg")
        explanation = step.explanation + Details.of(name if has_picture else None)
        named.append(replace(step, explanation=explanation))
    return tuple(named)
