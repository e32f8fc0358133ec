"""What takes the pictures and videos of a scenario's cameras, as a plug-in."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import ClassVar

from harness.core.activity import Activity
from harness.core.registry import Plugin
from harness.core.world import WorldObject
from harness.recording.looks import Look
from harness.recording.run import Run
from harness.recording.signals import CaptureRecord, VideoRecord
from harness.robot.description import RobotDescription


class CameraRecorder(Plugin, ABC):
    """Draws what the cameras of a finished run saw."""

    plugin_kind: ClassVar[str] = "camera_recorder"

    @abstractmethod
    def pictures(
        self,
        description: RobotDescription,
        objects: Sequence[WorldObject],
        run: Run,
        looks: Sequence[Look],
        activity: Activity,
    ) -> tuple[tuple[CaptureRecord, ...], Mapping[str, bytes]]:
        """The requested pictures, and their files by path in the run's folder.

        Args:
            description: The robot of the run.
            objects: All objects of the run.
            run: The finished run, with all its recorded signals.
            looks: The requested pictures, in order of time.
            activity: Hears how many of them are taken.
        """

    @abstractmethod
    def videos(
        self,
        description: RobotDescription,
        objects: Sequence[WorldObject],
        run: Run,
        rates: Mapping[str, float],
        activity: Activity,
    ) -> tuple[tuple[VideoRecord, ...], Mapping[str, bytes]]:
        """A video of each camera, and the files by path in the run's folder.

        Args:
            description: The robot of the run.
            objects: All objects of the run.
            run: The finished run, with all its recorded signals.
            rates: Frames per second of simulated time, by camera.
            activity: Hears how many frames are recorded.
        """
