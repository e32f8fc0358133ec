"""Pictures of the cameras of a scene that a caller poses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache, partial

import numpy as np

from harness.core.camera import Camera
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.plugins.cameras.camera_scene import CameraScene
from harness.plugins.cameras.renderer import make_renderer
from harness.plugins.cameras.sensor import as_delivered
from harness.robot.description import RobotDescription


class PosedCameras:
    """The robot and the simulated objects, with a renderer for each size of picture."""

    def __init__(
        self,
        description: RobotDescription,
        objects: Sequence[WorldObject],
        cameras: Sequence[Camera],
        backend: str,
    ) -> None:
        self._scene = CameraScene(description, objects, cameras)
        self._renderer = cache(partial(make_renderer, self._scene.picture, backend=backend))

    def picture(
        self,
        camera: Camera,
        joint_positions: FloatArray,
        objects: Mapping[str, SE3],
        noise: tuple[int, int] | None = None,
    ) -> np.ndarray | None:
        """A picture as the camera delivers it; None while its carrier is not in the scene."""
        view = self._scene.view(camera, self._scene.pose_robot(joint_positions, objects))
        if view is None:
            return None
        ideal = self._renderer(camera.width, camera.height).render(view)
        return ideal if noise is None else as_delivered(ideal, camera, *noise)
