"""The scene of a recorded run for its cameras: the robot and the simulated objects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from harness.core.camera import Camera
from harness.core.geometry import Plane
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.plugins.cameras.picture_model import PictureModel, build_picture_model
from harness.plugins.cameras.viewpoint import View, view_of
from harness.recording.run import Run
from harness.recording.step_record import StepRecord, is_nested
from harness.recording.step_results import SceneChange
from harness.robot.description import RobotDescription


def scene_poses(
    description: RobotDescription,
    world_objects: Sequence[WorldObject],
    run: Run,
    sample: int,
    step: StepRecord | None = None,
) -> dict[str, SE3]:
    """T_world_body of every link and of every object in the scene.

    Simulated objects have their pose in the physics, others their pose in the planning scene.

    Args:
        step: Selects one of several steps that share the sample. Changes by steps without duration
            at the moment a motion ends are not part of the motion's end.
    """
    poses = description.link_poses(run.signals.joint_positions[sample])
    present = _present_after(run, step)
    seen = sample if step is None or step.end_time > step.start_time else sample + 1
    later = _moved_later(run, step)
    for obj in world_objects:
        recorded = run.signals.object_poses.get(obj.name)
        if recorded is None or (present is not None and obj.name not in present):
            continue
        # changes by a step without duration are in the next sample, if there is one
        indices = [min(seen, len(recorded) - 1), sample]
        if obj.name in later:  # the planning scene shows a change one sample before the physics
            indices.insert(0, sample if obj.in_simulation else max(0, sample - 1))
        rows = recorded[indices]
        finite = np.flatnonzero(np.isfinite(rows).all(axis=1))
        if len(finite):
            poses[obj.name] = SE3.from_vector(rows[finite[0]])
    return poses


def _moved_later(run: Run, step: StepRecord | None) -> set[str]:
    """Objects that later steps put somewhere else at the moment a step ended, and it did not."""
    if step is None:
        return set()
    place = _place(run, step)
    moves = [
        (index > place and not is_nested(each.path, step.path), change.moved or ())
        for index, each in enumerate(run.steps)
        if each.end_index == step.end_index and (change := each.result.find(SceneChange))
    ]
    later = {name for is_later, names in moves if is_later for name in names}
    return later - {name for is_later, names in moves if not is_later for name in names}


def _place(run: Run, step: StepRecord) -> int:
    """Index in the run of a step; its record may have been completed since."""
    return [each.path for each in run.steps].index(step.path)


def floor_height(description: RobotDescription, world_objects: Sequence[WorldObject]) -> float:
    """Height of the floor in pictures [m]: the first plane's, else the base's, at most 0."""
    for obj in world_objects:
        for shape in obj.shapes:
            if isinstance(shape.geometry, Plane):
                return float((obj.pose @ shape.pose).translation[2])
    base = description.link_poses(description.start_positions())[description.base_link]
    return min(0.0, float(base.translation[2]))


def _present_after(run: Run, step: StepRecord | None) -> set[str] | None:
    """Objects in the scene after a step; None without a step.

    Steps may end at the same time, so this follows the order of the steps and not their times.
    """
    if step is None:
        return None
    last = _place(run, step)
    changes = [
        (place, kind, name)
        for place, each in enumerate(run.steps)
        if (change := each.result.find(SceneChange)) is not None
        for kind, names in (("added", change.added), ("removed", change.removed))
        for name in names or ()
    ]
    first = {name: kind for _, kind, name in reversed(changes)}
    present = {name for name in run.signals.object_poses if first.get(name) != "added"}
    for place, kind, name in changes:
        if place <= last:
            (present.add if kind == "added" else present.discard)(name)
    return present


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

    def pose_robot(self, joint_positions: FloatArray, objects: Mapping[str, SE3]) -> dict[str, SE3]:
        """Pose the robot and some objects; returns T_world_body of all of them and of `world`."""
        poses = {**self._description.link_poses(joint_positions), **objects}
        self.picture.pose(poses)
        return poses

    def view(self, camera: Camera, poses: Mapping[str, SE3]) -> View | None:
        """The view of a camera; None while its carrier is not in the scene."""
        carrier = poses.get(camera.frame)
        return None if carrier is None else view_of(camera, carrier)
