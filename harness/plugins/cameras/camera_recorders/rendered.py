"""The camera recorder `rendered`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
from harness.plugins.cameras.failure_pictures import draw_failure
from harness.plugins.cameras.live import PosedCameras
from harness.plugins.cameras.overview import draw_overview
from harness.plugins.cameras.stills import StepRenderer
from harness.recording.looks import Look
from harness.recording.run import Run
from harness.recording.step_record import StepRecord


class RenderedCameras(CameraRecorder):
    """Pictures and videos that are rendered from the recorded states."""

    name: ClassVar[str] = "rendered"

    def pictures(self, run: Run, looks: Sequence[Look], activity: Activity) -> Captures:
        """Pictures of the ray renderer, which are the same on every machine."""
        from harness.plugins.cameras.captures import take_pictures

        return take_pictures(self.description, self.objects, run, looks, activity)

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
