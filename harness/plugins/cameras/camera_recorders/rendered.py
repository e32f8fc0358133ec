"""The camera recorder `rendered`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

from harness.cameras.camera_recorder import CameraRecorder
from harness.core.activity import Activity
from harness.core.world import WorldObject
from harness.recording.looks import Look
from harness.recording.run import Run
from harness.recording.signals import CaptureRecord, VideoRecord
from harness.robot.description import RobotDescription


class RenderedCameras(CameraRecorder):
    """Pictures and videos that are rendered from the recorded states."""

    name: ClassVar[str] = "rendered"

    def pictures(
        self,
        description: RobotDescription,
        objects: Sequence[WorldObject],
        run: Run,
        looks: Sequence[Look],
        activity: Activity,
    ) -> tuple[tuple[CaptureRecord, ...], Mapping[str, bytes]]:
        """Pictures of the ray renderer, which are the same on every machine."""
        from harness.plugins.cameras.captures import take_pictures

        return take_pictures(description, objects, run, looks, activity)

    def videos(
        self,
        description: RobotDescription,
        objects: Sequence[WorldObject],
        run: Run,
        rates: Mapping[str, float],
        activity: Activity,
    ) -> tuple[tuple[VideoRecord, ...], Mapping[str, bytes]]:
        """Videos of the fastest renderer of the machine."""
        from harness.plugins.cameras.videos import record_videos  # loads a video library

        return record_videos(description, objects, run, rates, activity=activity)
