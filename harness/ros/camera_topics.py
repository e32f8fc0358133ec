"""Live pictures of the scenario's cameras, drawn by a process of their own."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from harness.core.camera import Camera
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.robot.description import RobotDescription
from harness.ros.graph import Graph, Publisher
from harness.ros.interfaces import message, stamp

if TYPE_CHECKING:
    from harness.cameras.renderer import Renderer

Drawn = tuple[np.ndarray, bytes]
"""A picture as the camera delivers it, and as a JPEG."""


@dataclass(frozen=True)
class _Topics:
    """What one camera publishes, named as the course's Gazebo does."""

    camera: Camera
    raw: Publisher
    compressed: Publisher
    infos: tuple[Publisher, ...]

    @classmethod
    def of(cls, graph: Graph, camera: Camera) -> _Topics:
        base, kind = f"/{camera.name}", "sensor_msgs/msg/CameraInfo"
        infos = f"{base}/camera_info", f"{base}/image/camera_info"
        return cls(
            camera,
            graph.advertise(f"{base}/image", "sensor_msgs/msg/Image", depth=1),
            graph.advertise(f"{base}/image/compressed", "sensor_msgs/msg/CompressedImage", depth=1),
            tuple(graph.advertise(info, kind) for info in infos),
        )

    @property
    def are_watched(self) -> bool:
        return bool(self.raw.subscribers or self.compressed.subscribers)

    def publish_info(self, time: float) -> None:
        for info in self.infos:
            if info.subscribers:
                info.publish(camera_info(self.camera, time))

    def publish(self, time: float, drawn: Drawn) -> None:
        picture, jpeg = drawn
        header, is_grey = _header(self.camera, time), self.camera.is_grey
        if self.raw.subscribers:
            height, width = picture.shape[:2]
            self.raw.publish(
                message(
                    "sensor_msgs/msg/Image",
                    header=header,
                    height=height,
                    width=width,
                    encoding="mono8" if is_grey else "rgb8",
                    step=picture.size // height,
                    data=picture.reshape(-1),
                )
            )
        if self.compressed.subscribers:
            kind = "mono8; jpeg compressed mono8" if is_grey else "rgb8; jpeg compressed bgr8"
            data = np.frombuffer(jpeg, np.uint8)
            self.compressed.publish(
                message("sensor_msgs/msg/CompressedImage", header=header, format=kind, data=data)
            )


class CameraTopics:
    """Publishes pictures while someone subscribes to them; a slow machine sends fewer."""

    def __init__(
        self,
        graph: Graph,
        cameras: Sequence[Camera],
        description: RobotDescription,
        objects: Sequence[WorldObject],
        seed: int,
    ) -> None:
        self._topics = [_Topics.of(graph, camera) for camera in cameras]
        self._scene = tuple(cameras), description, tuple(objects), seed
        self._next = [0.0] * len(cameras)
        self._painter: ProcessPoolExecutor | None = None
        self._pending: tuple[_Topics, float, Future[Drawn | None]] | None = None

    def publish(
        self,
        time: float,
        sample: int,
        positions: np.ndarray,
        poses: Callable[[], Mapping[str, np.ndarray]],
    ) -> None:
        """Publish what is due at a simulated time.

        Args:
            time: The present simulated time [s].
            sample: Index of the current physics sample, from which the noise is drawn.
            positions: Joint positions in description order, shape (n,).
            poses: Returns T_world_object of the objects that are there (xyz, quat wxyz), shape
                (7,) each.
        """
        if self._pending is not None and self._pending[2].done():
            topics, drawn_at, future = self._pending
            self._pending = None
            if future.exception() is not None:  # it cannot draw; the run does not depend on it
                self._topics.clear()
            elif (drawn := future.result()) is not None:
                topics.publish(drawn_at, drawn)
        for number, topics in enumerate(self._topics):
            if time < self._next[number] - 1e-9:
                continue
            self._next[number] = time + 1.0 / topics.camera.update_rate
            topics.publish_info(time)
            if topics.are_watched and self._pending is None:
                if self._painter is None:  # a fork inherits locks and OpenGL
                    context = multiprocessing.get_context("spawn")
                    self._painter = ProcessPoolExecutor(1, context, _prepare, self._scene)
                request = topics.camera.name, sample, positions, poses()
                self._pending = topics, time, self._painter.submit(_draw, *request)

    def close(self) -> None:
        """End the process that draws."""
        if self._painter is not None:
            self._painter.shutdown(cancel_futures=True)
            self._painter = self._pending = None


def camera_info(camera: Camera, time: float) -> Any:
    """The calibration of a pinhole without distortion."""
    projection = np.hstack([camera.matrix, np.zeros((3, 1))])
    return message(
        "sensor_msgs/msg/CameraInfo",
        header=_header(camera, time),
        height=camera.height,
        width=camera.width,
        distortion_model="plumb_bob",
        d=np.zeros(5),
        k=camera.matrix.reshape(-1),
        r=np.eye(3).reshape(-1),
        p=projection.reshape(-1),
    )


def _header(camera: Camera, time: float) -> Any:
    frame = camera.optical_frame_id or f"{camera.name}_optical_frame"
    return message("std_msgs/msg/Header", stamp=stamp(time), frame_id=frame)


# -- in the process that draws ------------------------------------------------------------------


class _Painter:
    """The scene and its renderers, by the size of their pictures."""

    def __init__(
        self,
        cameras: Sequence[Camera],
        description: RobotDescription,
        objects: Sequence[WorldObject],
        seed: int,
    ) -> None:
        from harness.cameras.camera_scene import CameraScene

        self._scene = CameraScene(description, objects, cameras)
        self._cameras = {camera.name: camera for camera in cameras}
        self._description, self._seed = description, seed
        self._renderers: dict[tuple[int, int], Renderer] = {}

    def draw(
        self, name: str, sample: int, positions: np.ndarray, rows: Mapping[str, np.ndarray]
    ) -> Drawn | None:
        """A camera's picture; None while its carrier is not in the scene."""
        from harness.cameras.captures import jpeg
        from harness.cameras.renderer import make_renderer
        from harness.cameras.sensor import as_delivered
        from harness.robot.forward_kinematics import robot_poses

        camera = self._cameras[name]
        poses = robot_poses(self._description, positions)
        poses |= {each: SE3.from_vector(row) for each, row in rows.items()}
        self._scene.picture.pose(poses)
        view = self._scene.view(camera, poses)
        if view is None:
            return None
        size = camera.width, camera.height
        if size not in self._renderers:
            self._renderers[size] = make_renderer(self._scene.picture, *size)
        picture = as_delivered(self._renderers[size].render(view), camera, self._seed, sample)
        return picture, jpeg(picture, camera)


_painters: list[_Painter] = []


def _prepare(*scene: Any) -> None:
    _painters.append(_Painter(*scene))


def _draw(*request: Any) -> Drawn | None:
    return _painters[0].draw(*request)
