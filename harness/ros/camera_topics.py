"""Live pictures of the scenario's cameras, drawn by a process of their own."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any

import numpy as np

from harness.core.camera import Camera
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.robot.description import RobotDescription
from harness.ros.graph import Graph, Publisher
from harness.ros.interfaces import message, stamp

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
        self._painter: tuple[BaseProcess, Connection] | None = None
        self._pending: tuple[_Topics, float] | None = None

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
        self._send_finished()
        for number, topics in enumerate(self._topics):
            if time < self._next[number] - 1e-9:
                continue
            self._next[number] = time + 1.0 / topics.camera.update_rate
            topics.publish_info(time)
            if topics.are_watched and self._pending is None:
                self._pending = topics, time
                self._connection.send((topics.camera.name, sample, positions, poses()))

    def close(self) -> None:
        """End the process that draws."""
        if self._painter is not None:
            process, connection = self._painter
            connection.close()
            process.terminate()
            process.join(5)
            self._painter = self._pending = None

    @property
    def _connection(self) -> Connection:
        if self._painter is None:
            ours, theirs = multiprocessing.Pipe()
            # a fork inherits locks and OpenGL, and a worker of an executor outlives a killed parent
            context = multiprocessing.get_context("spawn")
            process = context.Process(target=_paint, args=(theirs, ours, *self._scene), daemon=True)
            process.start()
            theirs.close()
            self._painter = process, ours
        return self._painter[1]

    def _send_finished(self) -> None:
        if self._painter is None or self._pending is None or not self._painter[1].poll():
            return
        (topics, time), self._pending = self._pending, None
        try:
            drawn: Drawn | None = self._painter[1].recv()
        except EOFError:  # it could not draw; the run does not depend on it
            self._topics.clear()
            return
        if drawn is not None:
            topics.publish(time, drawn)


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


def _paint(
    requests: Connection,
    parent: Connection,
    cameras: Sequence[Camera],
    description: RobotDescription,
    objects: Sequence[WorldObject],
    seed: int,
) -> None:
    """Draw what is requested, one picture after the other, until the pipe closes.

    The answer is None while the camera's carrier is not in the scene.
    """
    from harness.cameras.camera_scene import CameraScene
    from harness.cameras.captures import jpeg
    from harness.cameras.renderer import make_renderer
    from harness.cameras.sensor import as_delivered
    from harness.robot.forward_kinematics import robot_poses

    parent.close()
    scene, known = CameraScene(description, objects, cameras), {c.name: c for c in cameras}
    make = cache(partial(make_renderer, scene.picture))
    while True:
        try:
            name, sample, positions, rows = requests.recv()
        except (EOFError, KeyboardInterrupt):
            return
        camera, poses = known[name], robot_poses(description, positions)
        poses |= {each: SE3.from_vector(row) for each, row in rows.items()}
        scene.picture.pose(poses)
        view = scene.view(camera, poses)
        drawn: Drawn | None = None
        if view is not None:
            ideal = make(camera.width, camera.height).render(view)
            picture = as_delivered(ideal, camera, seed, sample)
            drawn = picture, jpeg(picture, camera)
        requests.send(drawn)
