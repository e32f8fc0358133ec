"""Videos of the cameras over a whole run; verdicts do not depend on them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from harness.core.activity import Activity, unobserved
from harness.core.camera import Camera
from harness.core.world import WorldObject
from harness.plugins.cameras.camera_scene import CameraScene
from harness.plugins.cameras.captures import camera_folders
from harness.plugins.cameras.renderer import Renderer, make_renderer
from harness.plugins.cameras.sensor import as_delivered
from harness.recording.film import SUFFIX, encoded_film, film_size
from harness.recording.run import Run
from harness.recording.signals import VideoRecord
from harness.robot.description import RobotDescription


def record_videos(
    description: RobotDescription,
    objects: Sequence[WorldObject],
    run: Run,
    rates: Mapping[str, float],
    *,
    backend: str = "auto",
    activity: Activity = unobserved,
) -> tuple[tuple[VideoRecord, ...], dict[str, bytes]]:
    """A video of each camera, and the files by path.

    Args:
        rates: Frames per second of simulated time, by camera.
        backend: `auto`, `egl`, `osmesa` or `rays`.
    """
    if not rates:
        return (), {}
    scene = CameraScene(description, objects, run.cameras)
    cameras = {camera.name: camera for camera in run.cameras}
    folders = camera_folders(run.cameras)
    videos: list[VideoRecord] = []
    files: dict[str, bytes] = {}
    for name, requested in rates.items():
        camera = cameras[name]
        rate = min(requested, camera.most_frames / max(run.duration, 1e-9))
        renderer = make_renderer(scene.picture, camera.width, camera.height, backend)
        try:
            video, content = _record(scene, camera, run, rate, renderer, folders[name], activity)
        finally:
            renderer.close()
        if video is not None:
            videos.append(video)
            files |= content
    return tuple(videos), files


def _record(
    scene: CameraScene,
    camera: Camera,
    run: Run,
    rate: float,
    renderer: Renderer,
    folder: str,
    activity: Activity,
) -> tuple[VideoRecord | None, dict[str, bytes]]:
    times: list[float] = []

    def pictures() -> Iterator[np.ndarray]:
        for time, frame in _frames(scene, camera, run, rate, renderer, activity):
            times.append(time)
            yield frame

    size = film_size(camera.width, camera.height)
    content = encoded_film(pictures(), rate, size)
    if not times:
        return None, {}
    file = f"{folder}/video{SUFFIX}"
    video = VideoRecord(
        camera=camera.name,
        file=file,
        times=tuple(times),
        rate=rate,
        width=size[0],
        height=size[1],
        backend=renderer.backend,
    )
    return video, {file: content}


def _frames(
    scene: CameraScene,
    camera: Camera,
    run: Run,
    rate: float,
    renderer: Renderer,
    activity: Activity,
) -> Iterator[tuple[float, np.ndarray]]:
    """Simulated time and picture of every frame; the last picture repeats while there is none."""
    times = run.signals.times
    previous: np.ndarray | None = None
    count = int(np.floor(float(times[-1]) * rate + 1e-6)) + 1
    for number in range(count):
        activity(f"recording the video of camera {camera.name}", number, count)
        sample = min(int(np.searchsorted(times, number / rate - 1e-9)), len(times) - 1)
        view = scene.view(camera, scene.pose(run, sample))
        if view is not None:
            previous = as_delivered(renderer.render(view), camera, run.seed, sample)
        if previous is not None:
            yield number / rate, previous
