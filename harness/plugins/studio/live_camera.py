"""What a camera of the scenario sees, while someone looks."""

from __future__ import annotations

import base64
import time
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from harness.core.camera import Camera
from harness.core.errors import HarnessError
from harness.core.picture_files import jpeg
from harness.plugins.studio.live_cell import LiveCell
from harness.plugins.studio.newest import Newest

PERIOD = 0.35  # time between two pictures [s]
MOST_PIXELS = 240 * 180  # each costs two microseconds; a larger picture is drawn smaller


class LiveCamera:
    """Draws one camera, a few times a second and only after something has moved.

    Attributes:
        name: The name of the camera; empty while no one looks.
    """

    def __init__(self) -> None:
        self.name = ""
        self._picture: Newest[str] = Newest()
        self._drawn: bytes = b""
        self._due = 0.0

    def look(self, name: str) -> None:
        """Look through a camera; through none with an empty name."""
        self._picture.cancel()
        self.name, self._drawn = name, b""

    def draw(self, cell: LiveCell) -> None:
        """Begin to draw, if a picture is due and would be another one."""
        now = time.monotonic()
        camera = cell.prepared.program.cameras.get(self.name)
        if camera is None or self._picture.is_busy or now < self._due:
            return
        self._due = now + PERIOD
        state = np.concatenate(
            [cell.joint_positions(), *(pose.as_vector() for pose in cell.object_poses().values())]
        )
        seen = np.round(state, 4).tobytes()
        if seen != self._drawn:
            self._drawn = seen
            self._picture.begin(partial(camera_picture, cell, camera, MOST_PIXELS))

    def taken(self, *, wait: bool = False) -> dict[str, Any] | None:
        """The message with a picture that is ready; None without one."""
        try:
            image = self._picture.taken(wait=wait)
        except HarnessError as error:
            return {"type": "note", "kind": "failed", "text": f"camera '{self.name}': {error}"}
        return None if image is None else {"type": "camera", "name": self.name, "image": image}


def camera_picture(cell: LiveCell, camera: Camera, most_pixels: int) -> str:
    """A camera's picture of the cell as it is now: JPEG in base64.

    Raises:
        HarnessError: The frame that carries the camera is not in the scene.
    """
    from harness.cameras.camera_recorder import camera_recorder

    program = cell.prepared.program
    shrink = min(1.0, (most_pixels / (camera.width * camera.height)) ** 0.5)
    width, height = max(1, round(shrink * camera.width)), max(1, round(shrink * camera.height))
    camera = replace(camera, width=width, height=height)
    objects = program.all_objects()
    recorder = camera_recorder(program.description, objects)
    cameras = recorder.live([camera], in_a_thread=True)
    picture = cameras.picture(camera, cell.joint_positions(), cell.object_poses())
    if picture is None:
        raise HarnessError(f"'{camera.frame}', which carries it, is not there")
    return base64.b64encode(jpeg(picture)).decode()
