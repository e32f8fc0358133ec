"""Pictures of the scenario's cameras, rendered after the run from the recorded states.

The ray renderer draws them on every machine, with or without a graphics card, so that all machines
get the same pixels and the same verdicts on them.
"""

from __future__ import annotations

import io
import re
from collections.abc import Mapping, Sequence
from colorsys import hsv_to_rgb
from functools import cached_property

import numpy as np

from harness.core.activity import Activity, unobserved
from harness.core.camera import Camera
from harness.core.picture_files import jpeg, png
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.plugins.cameras.camera_scene import CameraScene
from harness.plugins.cameras.looks import Look
from harness.plugins.cameras.outlines import outline_pixels
from harness.plugins.cameras.ray_renderer import RayRenderer
from harness.plugins.cameras.sensor import as_delivered
from harness.plugins.cameras.viewpoint import FLIP, View
from harness.recording.arrays import write_npz
from harness.recording.run import Run
from harness.recording.signals import CaptureRecord
from harness.robot.description import RobotDescription

FOLDER = "cameras"
SUFFIXES = {
    "color": ".color.png",
    "depth": ".depth.npz",
    "depth_preview": ".depth.png",
    "segmentation": ".labels.png",
    "segmentation_preview": ".segmentation.png",
}

VIRIDIS = (
    *((68, 1, 84), (72, 40, 120), (62, 74, 137), (49, 104, 142), (38, 130, 142)),
    *((31, 158, 137), (53, 183, 121), (109, 205, 89), (180, 222, 44), (253, 231, 37)),
)
"""Colours of a scale from dark to bright, RGB, at equal distances."""


def take_pictures(
    description: RobotDescription,
    objects: Sequence[WorldObject],
    run: Run,
    looks: Sequence[Look],
    activity: Activity = unobserved,
) -> tuple[tuple[CaptureRecord, ...], dict[str, bytes]]:
    """The requested pictures, and their files by path in the run's folder.

    Pictures of a `capture` step are lossless; those of an expectation are JPEGs of the camera's
    quality, as in its compressed stream. A camera whose carrier is not in the scene takes none.

    Args:
        looks: The requested pictures, in order of time.
    """
    if not looks:
        return (), {}
    cameras = {camera.name: camera for camera in run.cameras}
    folders = camera_folders(run.cameras)
    scene = CameraScene(description, objects, run.cameras)
    renderers: dict[str, RayRenderer] = {}
    captures: list[CaptureRecord] = []
    files: dict[str, bytes] = {}
    for number, look in enumerate(looks):
        activity("taking camera pictures", number, len(looks))
        camera = cameras[look.camera]
        poses = scene.pose(run, look.sample)
        view = scene.view(camera, poses)
        if view is None:
            continue
        renderer = renderers.setdefault(
            camera.name, RayRenderer(scene.picture, camera.width, camera.height)
        )
        time = float(run.signals.times[look.sample])
        subject = file_stem(look.step) if look.step else "look"
        stem = f"{folders[camera.name]}/{time:08.3f}s-{subject}"
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
        """The content of each file by kind; pictures of a step have previews."""
        content: dict[str, bytes] = {}
        kinds, camera = self._look.kinds, self._camera
        if "color" in kinds:
            ideal = self._renderer.render(self._view)
            picture = as_delivered(ideal, camera, self._seed, self._look.sample)
            content["color"] = (
                png(picture) if self._look.step else jpeg(picture, camera.jpeg_quality)
            )
        if "depth" in kinds:
            depth, _ = self._measured
            content["depth"] = _npz(depth)
            if self._look.step:
                content["depth_preview"] = png(_depth_colours(depth))
        if "segmentation" in kinds:
            _, geoms = self._measured
            labels = np.where(geoms >= 0, self._scene.geom_labels[geoms], 0).astype(np.uint16)
            content["segmentation"] = png(labels)
            if self._look.step:
                content["segmentation_preview"] = png(_label_colours(labels))
        return content

    def outlines(self, poses: Mapping[str, SE3]) -> dict[str, int]:
        """Number of unoccluded pixels of each object in front of the camera."""
        counts = {
            name: outline_pixels(
                self._scene.picture, name, self._view, self._camera.width, self._camera.height
            )
            for name in self._scene.object_names
            if name in poses and name in self._scene.picture.geoms
        }
        return {name: count for name, count in counts.items() if count}


def camera_folders(cameras: Sequence[Camera]) -> dict[str, str]:
    """A separate folder for each camera, by its name."""
    folders: dict[str, str] = {}
    for camera in cameras:
        folder = f"{FOLDER}/{file_stem(camera.name)}"
        while folder in folders.values():
            folder += "_"
        folders[camera.name] = folder
    return folders


def file_stem(name: str) -> str:
    """A name as part of a file's name."""
    return re.sub(r"[^A-Za-z0-9_-]+", "-", name).strip("-")[:48] or "camera"


def _npz(depth: np.ndarray) -> bytes:
    """An .npz file of the array `depth`, float32, with equal bytes for equal depths."""
    stream = io.BytesIO()
    write_npz(stream, {"depth": depth.astype(np.float32)})
    return stream.getvalue()


def _depth_colours(depth: np.ndarray) -> np.ndarray:
    """RGB of a logarithmic scale, from bright (near) to dark (far); black without a hit."""
    seen = np.isfinite(depth)
    ratio = np.log(np.where(seen, np.maximum(depth, 1e-3), 1.0))
    low, high = (ratio[seen].min(), ratio[seen].max()) if seen.any() else (0.0, 1.0)
    share = np.clip((high - ratio) / max(high - low, 1e-9), 0, 1)
    levels = np.where(seen, (30 + 225 * share) / 255, 0)
    places = np.linspace(0, 1, len(VIRIDIS))
    colours = np.stack([np.interp(levels, places, ink) for ink in zip(*VIRIDIS, strict=True)], -1)
    return np.where(seen[:, :, None], colours, 0).astype(np.uint8)


def _label_colours(labels: np.ndarray) -> np.ndarray:
    """RGB with a distinct colour for each label; label 0 is black."""
    hues = (np.arange(int(labels.max()) + 1) * 0.618034) % 1.0
    palette = 255 * np.array([hsv_to_rgb(hue, 0.67, 0.92) for hue in hues])
    palette[0] = 0
    return palette.astype(np.uint8)[labels]
