"""What takes the pictures and videos of a scenario's cameras, as a plug-in."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

from harness.core.activity import Activity
from harness.core.registry import Plugin
from harness.core.world import WorldObject
from harness.recording.looks import Look
from harness.recording.run import Run
from harness.recording.signals import CaptureRecord, VideoRecord
from harness.robot.description import RobotDescription

Captures = tuple[tuple[CaptureRecord, ...], Mapping[str, bytes]]
Videos = tuple[tuple[VideoRecord, ...], Mapping[str, bytes]]
"""Both with the files by path in the run's folder."""


@dataclass(frozen=True, eq=False)
class CameraRecorder(Plugin, ABC):
    """Draws what the cameras of a finished run saw, of the robot and of all objects."""

    plugin_kind: ClassVar[str] = "camera_recorder"

    description: RobotDescription
    objects: Sequence[WorldObject]
    run: Run

    @abstractmethod
    def pictures(self, looks: Sequence[Look], activity: Activity) -> Captures:
        """The requested pictures, in order of time; `activity` hears how many are taken."""

    @abstractmethod
    def videos(self, rates: Mapping[str, float], activity: Activity) -> Videos:
        """A video of each camera, by its frames per second of simulated time."""
