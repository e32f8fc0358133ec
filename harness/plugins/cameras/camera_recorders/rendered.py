"""The camera recorder `rendered`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import ClassVar

import numpy as np

from harness.cameras.camera_recorder import (
    CameraRecorder,
    Captures,
    LiveCameras,
    Overview,
    Videos,
)
from harness.core.activity import Activity
from harness.core.camera import Camera
from harness.judging.placed import PlacedExpectation
from harness.plugins.cameras.failure_pictures import draw_failure
from harness.plugins.cameras.live import PosedCameras
from harness.plugins.cameras.looks import looks_of_steps, merged_looks
from harness.plugins.cameras.overview import draw_overview
from harness.plugins.cameras.stills import StepRenderer
from harness.plugins.cameras.watched import looks_of_expectations
from harness.recording.run import Run
from harness.recording.step_record import StepRecord


class RenderedCameras(CameraRecorder):
    """Pictures and videos that are rendered from the recorded states."""

    name: ClassVar[str] = "rendered"

    def pictures(
        self, run: Run, expectations: Sequence[PlacedExpectation], *, is_kept: bool
    ) -> Callable[[Activity], Captures] | None:
        """Pictures of the ray renderer, which are the same on every machine."""
        from harness.plugins.cameras.captures import take_pictures

        looked = looks_of_expectations(run, expectations)
        seen = {(look.camera, look.sample) for look in looked}
        taken = looks_of_steps(run.steps)
        if not is_kept:
            taken = [look for look in taken if (look.camera, look.sample) in seen]
        looks = merged_looks([*taken, *looked])
        return partial(take_pictures, self.description, self.objects, run, looks) if looks else None

    def videos(self, run: Run, rates: Mapping[str, float], activity: Activity) -> Videos:
        """Videos of the fastest renderer of the machine."""
        from harness.plugins.cameras.videos import record_videos  # loads a video library

        return record_videos(self.description, self.objects, run, rates, activity=activity)

    def step_pictures(self) -> StepRenderer:
        """Pictures of the fastest renderer of the machine."""
        return StepRenderer(self.description, self.objects)

    def failure_picture(self, run: Run, step: StepRecord) -> bytes:
        """A picture of the fastest renderer of the machine, with the goal's frame."""
        return draw_failure(self.description, self.objects, run, step)

    def live(self, cameras: Sequence[Camera], *, in_a_thread: bool = False) -> LiveCameras:
        """Cameras of the fastest renderer, or in a thread of the ray renderer."""
        backend = "rays" if in_a_thread else "auto"
        return PosedCameras(self.description, self.objects, cameras, backend)

    def overview(self, request: Overview) -> np.ndarray:
        """A picture of the fastest renderer of the machine."""
        return draw_overview(self.description, self.objects, request)
