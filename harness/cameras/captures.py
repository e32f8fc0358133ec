"""Pictures that cameras took, drawn after the run from what was recorded.

Always by rays, whatever the machine has: the same pixels everywhere, so that a verdict that reads
them is the same with a graphics card, without one, and in a container.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np

from harness.cameras.camera_scene import CameraScene
from harness.cameras.encoding import depth_colours, jpeg, label_colours, npz, png
from harness.cameras.outlines import outline_pixels
from harness.cameras.ray_renderer import RayRenderer
from harness.cameras.sensor import as_delivered
from harness.cameras.viewpoint import FLIP, View
from harness.core.activity import Activity, unobserved
from harness.core.camera import Camera
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.recording.looks import Look
from harness.recording.run import CaptureRecord, Run
from harness.robot.description import RobotDescription

FOLDER = "cameras"
SUFFIXES = {
    "color": ".color.png",
    "depth": ".depth.npz",
    "depth_preview": ".depth.png",
    "segmentation": ".labels.png",
    "segmentation_preview": ".segmentation.png",
}


def take_pictures(
    description: RobotDescription,
    objects: Sequence[WorldObject],
    run: Run,
    looks: Sequence[Look],
    activity: Activity = unobserved,
) -> tuple[tuple[CaptureRecord, ...], dict[str, bytes]]:
    """The wanted pictures, and their files by path in the run's folder.

    What a `capture` step took is lossless; what an expectation looks at is a JPEG of the camera's
    quality, as its compressed stream would bring it. A camera whose carrier is not in the scene
    takes no picture.

    Args:
        description: The robot.
        objects: Everything that takes part.
        run: What happened, its cameras included.
        looks: What is wanted, in order of time.
        activity: Called for each picture.
    """
    if not looks:
        return (), {}
    cameras = {camera.name: camera for camera in run.cameras}
    folders = camera_folders(run.cameras)
    scene = CameraScene(description, objects, run)
    renderers: dict[str, RayRenderer] = {}
    captures: list[CaptureRecord] = []
    files: dict[str, bytes] = {}
    for number, look in enumerate(looks):
        activity("taking camera pictures", number, len(looks))
        camera = cameras[look.camera]
        poses = scene.pose(look.sample)
        view = scene.view(camera, poses)
        if view is None:
            continue
        renderer = renderers.setdefault(
            camera.name, RayRenderer(scene.picture, camera.width, camera.height)
        )
        time = float(run.signals.times[look.sample])
        stem = f"{folders[camera.name]}/{time:08.3f}s-{slug(look.step) if look.step else 'look'}"
        taken = _Shot(scene, camera, view, renderer, run.seed, look)
        encoded = taken.encoded()
        suffixes = SUFFIXES if look.step else {**SUFFIXES, "color": ".color.jpg"}
        names = {kind: stem + suffixes[kind] for kind in encoded}
        files |= {names[kind]: content for kind, content in encoded.items()}
        captures.append(
            CaptureRecord(
                camera=camera.name,
                time=time,
                sample=look.sample,
                step=look.step,
                backend=renderer.backend,
                files=names,
                pose=tuple(float(x) for x in (view.pose @ FLIP).as_vector()),
                labels=scene.labels if "segmentation" in look.kinds else {},
                outlines=taken.outlines(poses) if "segmentation" in look.kinds else {},
            )
        )
    return tuple(captures), files


class _Shot:
    """One camera's pictures of one posed scene."""

    def __init__(
        self,
        scene: CameraScene,
        camera: Camera,
        view: View,
        renderer: RayRenderer,
        seed: int,
        look: Look,
    ) -> None:
        self._scene, self._camera, self._view = scene, camera, view
        self._renderer, self._seed, self._look = renderer, seed, look

    @cached_property
    def _measured(self) -> tuple[np.ndarray, np.ndarray]:
        return self._renderer.measure(self._view)

    def encoded(self) -> dict[str, bytes]:
        """The content of each file by kind; previews are for what people took."""
        content: dict[str, bytes] = {}
        kinds, camera = self._look.kinds, self._camera
        if "color" in kinds:
            ideal = self._renderer.render(self._view)
            picture = as_delivered(ideal, camera, self._seed, self._look.sample)
            content["color"] = png(picture) if self._look.step else jpeg(picture, camera)
        if "depth" in kinds:
            depth, _ = self._measured
            content["depth"] = npz(depth)
            if self._look.step:
                content["depth_preview"] = png(depth_colours(depth))
        if "segmentation" in kinds:
            _, geoms = self._measured
            labels = np.where(geoms >= 0, self._scene.geom_labels[geoms], 0).astype(np.uint16)
            content["segmentation"] = png(labels)
            if self._look.step:
                content["segmentation_preview"] = png(label_colours(labels))
        return content

    def outlines(self, poses: Mapping[str, SE3]) -> dict[str, int]:
        """Pixels of each object that is in front of the camera, were it alone."""
        counts = {
            name: outline_pixels(
                self._scene.picture, name, self._view, self._camera.width, self._camera.height
            )
            for name in self._scene.object_names
            if name in poses and name in self._scene.picture.geoms
        }
        return {name: count for name, count in counts.items() if count}


def camera_folders(cameras: Sequence[Camera]) -> dict[str, str]:
    """A folder of its own for each camera, by its name."""
    folders: dict[str, str] = {}
    for camera in cameras:
        folder = f"{FOLDER}/{slug(camera.name)}"
        while folder in folders.values():
            folder += "_"
        folders[camera.name] = folder
    return folders


def slug(name: str) -> str:
    """A name as part of a file's name."""
    return re.sub(r"[^A-Za-z0-9_-]+", "-", name).strip("-")[:48] or "camera"
