"""The scene of a recorded run for its cameras: the robot and the simulated objects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from harness.cameras.picture_model import PictureModel, build_picture_model
from harness.cameras.recorded_scene import floor_height, scene_poses
from harness.cameras.viewpoint import View, view_of
from harness.core.camera import Camera
from harness.core.geometry import Plane
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.recording.run import Run
from harness.robot.description import RobotDescription


class CameraScene:
    """The robot and the simulated objects, posed as in a recorded sample or by the caller.

    Attributes:
        labels: Label of every link and object in segmentations.
        geom_labels: Label of each geom of `picture`.
    """

    def __init__(
        self,
        description: RobotDescription,
        objects: Sequence[WorldObject],
        cameras: Sequence[Camera],
    ) -> None:
        self._description = description
        self._objects = [obj for obj in objects if obj.in_simulation]
        self.object_names = tuple(obj.name for obj in self._objects)
        self.picture: PictureModel = build_picture_model(
            description,
            self._objects,
            floor_height=floor_height(description, self._objects),
            width=max(camera.width for camera in cameras),
            height=max(camera.height for camera in cameras),
        )
        # a third of the time without a graphics card; rays have shadows of their own
        self.picture.model.vis.quality.offsamples = 0
        self.picture.model.light_castshadow[:] = False
        names = (*description.link_names, *self.object_names)
        self.labels = {name: number for number, name in enumerate(names, start=1)}
        self.geom_labels = np.zeros(self.picture.model.ngeom, dtype=np.uint16)
        for obj in self._objects:  # the floor is drawn for the first plane
            if any(isinstance(shape.geometry, Plane) for shape in obj.shapes):
                self.geom_labels[0] = self.labels[obj.name]
                break
        for name, geoms in self.picture.geoms.items():
            self.geom_labels[geoms] = self.labels[name]

    def pose(self, run: Run, sample: int) -> dict[str, SE3]:
        """Pose all bodies as in a sample; returns T_world_body of those present and of `world`."""
        poses = scene_poses(self._description, self._objects, run, sample)
        self.picture.pose(poses)
        return poses

    def view(self, camera: Camera, poses: Mapping[str, SE3]) -> View | None:
        """The view of a camera; None while its carrier is not in the scene."""
        carrier = poses.get(camera.frame)
        return None if carrier is None else view_of(camera, carrier)
