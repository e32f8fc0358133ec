"""The camera recorder `rendered`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

from harness.cameras.camera_recorder import CameraRecorder, Captures, Videos
from harness.core.activity import Activity
from harness.recording.looks import Look


class RenderedCameras(CameraRecorder):
    """Pictures and videos that are rendered from the recorded states."""

    name: ClassVar[str] = "rendered"

    def pictures(self, looks: Sequence[Look], activity: Activity) -> Captures:
        """Pictures of the ray renderer, which are the same on every machine."""
        from harness.plugins.cameras.captures import take_pictures

        return take_pictures(self.description, self.objects, self.run, looks, activity)

    def videos(self, rates: Mapping[str, float], activity: Activity) -> Videos:
        """Videos of the fastest renderer of the machine."""
        from harness.plugins.cameras.videos import record_videos  # loads a video library

        return record_videos(self.description, self.objects, self.run, rates, activity=activity)
