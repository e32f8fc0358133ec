"""What draws the pictures of a run, and of a robot in a scene, as a plug-in."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Protocol

import numpy as np

from harness.core.activity import Activity
from harness.core.camera import Camera
from harness.core.errors import HarnessError
from harness.core.registry import Plugin, registry
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.judging.placed import PlacedExpectation
from harness.recording.run import Run
from harness.recording.signals import CaptureRecord, VideoRecord
from harness.recording.step_record import StepRecord
from harness.robot.description import RobotDescription

Captures = tuple[tuple[CaptureRecord, ...], Mapping[str, bytes]]
Videos = tuple[tuple[VideoRecord, ...], Mapping[str, bytes]]
"""Both with the files by path in the run's folder."""


@dataclass(frozen=True)
class Stills:
    """The pictures of a run's steps.

    Attributes:
        backend: What drew them, such as `egl`, `osmesa` or `rays`; empty without pictures.
        files: The content of the JPEG files by name, in order of the steps.
        note: A line on limitations of the pictures; empty without limitations.
    """

    backend: str = ""
    files: Mapping[str, bytes] = field(default_factory=dict[str, bytes])
    note: str = ""


class StepPictures(Protocol):
    """Draws the state at the end of every executed step."""

    def draw(self, run: Run, activity: Activity = ...) -> Stills:
        """Draw a JPEG of every executed step."""
        ...

    def close(self) -> None:
        """Free what the drawing holds."""
        ...


class LiveCameras(Protocol):
    """Cameras of a scene that a caller poses."""

    def picture(
        self,
        camera: Camera,
        joint_positions: FloatArray,
        objects: Mapping[str, SE3],
        noise: tuple[int, int] | None = None,
    ) -> np.ndarray | None:
        """A picture, RGB or grey, uint8; None while the camera's carrier is not in the scene.

        Args:
            joint_positions: The joint positions in description order, shape (n,).
            objects: T_world_object of the simulated objects that are there.
            noise: The run's seed and the sample that the camera's noise follows from; None draws
                in colour, without noise.
        """
        ...


@dataclass(frozen=True, eq=False)
class Overview:
    """A picture of the robot and the objects, in a view that contains all given spheres.

    Attributes:
        poses: T_world_body of every link and object that is drawn.
        points: Centres of the spheres, shape (N, 3) [m].
        radii: Radii of the spheres, shape (N,) [m].
        size: Width and height [pixels].
        tints: Colours of objects in place of their own, RGB from 0 to 1.
        caption: A line of text below the picture, which is that much less high; empty for none.
    """

    poses: Mapping[str, SE3]
    points: FloatArray
    radii: FloatArray
    size: tuple[int, int] = (640, 480)
    tints: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    caption: str = ""


@dataclass(frozen=True, eq=False)
class CameraRecorder(Plugin, ABC):
    """Draws a robot and all objects: a finished run, or states that a caller gives."""

    plugin_kind: ClassVar[str] = "camera_recorder"

    description: RobotDescription
    objects: Sequence[WorldObject]

    @abstractmethod
    def pictures(
        self, run: Run, expectations: Sequence[PlacedExpectation], *, is_kept: bool
    ) -> Callable[[Activity], Captures] | None:
        """What takes the pictures that expectations read, and those of steps where a run is kept.

        None where there are no pictures; an `Activity` hears how many are taken.
        """

    @abstractmethod
    def videos(self, run: Run, rates: Mapping[str, float], activity: Activity) -> Videos:
        """A video of each camera, by its frames per second of simulated time."""

    @abstractmethod
    def step_pictures(self) -> StepPictures:
        """What draws a run's steps; objects that only the planning scene has are translucent."""

    @abstractmethod
    def failure_picture(self, run: Run, step: StepRecord) -> bytes:
        """A JPEG file of the state that explains a failed step, with the goal."""

    @abstractmethod
    def live(self, cameras: Sequence[Camera], *, in_a_thread: bool = False) -> LiveCameras:
        """Cameras of the scene; those that draw in a thread use no graphics library."""

    @abstractmethod
    def overview(self, request: Overview) -> np.ndarray:
        """A picture from the outside, RGB, shape (height, width, 3), uint8."""


def has_recorder() -> bool:
    """Whether this installation can draw."""
    return "rendered" in registry(CameraRecorder.plugin_kind)


def camera_recorder(
    description: RobotDescription, objects: Sequence[WorldObject]
) -> CameraRecorder:
    """What draws a robot and objects.

    Raises:
        HarnessError: No plug-in of this installation does.
    """
    try:
        kind: type[CameraRecorder] = registry(CameraRecorder.plugin_kind).find("rendered")
    except LookupError as error:
        raise HarnessError(f"no pictures: {error}") from error
    return kind(description, objects)
