"""Live pictures of the scenario's cameras, drawn by a process of their own."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from harness.core.camera import Camera
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.robot.description import RobotDescription
from harness.ros.graph import Graph, Publisher
from harness.ros.interfaces import message, stamp


@dataclass(frozen=True)
class _Topics:
    """What one camera publishes, named as the course's Gazebo does."""

    raw: Publisher
    compressed: Publisher
    infos: tuple[Publisher, ...]

    @classmethod
    def of(cls, graph: Graph, camera: Camera) -> _Topics:
        base = f"/{camera.name}"
        kind = "sensor_msgs/msg/CameraInfo"
        return cls(
            graph.advertise(f"{base}/image", "sensor_msgs/msg/Image", depth=1),
            graph.advertise(f"{base}/image/compressed", "sensor_msgs/msg/CompressedImage", depth=1),
            (
                graph.advertise(f"{base}/camera_info", kind),
                graph.advertise(f"{base}/image/camera_info", kind),
            ),
        )

    @property
    def are_watched(self) -> bool:
        return bool(self.raw.subscribers or self.compressed.subscribers)


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
        self._cameras = {camera.name: camera for camera in cameras}
        self._topics = {camera.name: _Topics.of(graph, camera) for camera in cameras}
        self._scene = (
            tuple(cameras),
            description,
            tuple(o for o in objects if o.in_simulation),
            seed,
        )
        self._next = dict.fromkeys(self._cameras, 0.0)
        self._painter: tuple[Any, Connection] | None = None
        self._pending = ""

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
        for name, camera in self._cameras.items():
            if time < self._next[name] - 1e-9:
                continue
            self._next[name] = time + 1.0 / camera.update_rate
            for info in self._topics[name].infos:
                if info.subscribers:
                    info.publish(camera_info(camera, time))
            if self._topics[name].are_watched and not self._pending:
                self._pending = name
                self._connection.send((name, time, sample, positions, poses()))

    def close(self) -> None:
        """End the process that draws."""
        if self._painter is not None:
            process, connection = self._painter
            connection.close()
            process.terminate()
            process.join(5)
            self._painter, self._pending = None, ""

    @property
    def _connection(self) -> Connection:
        if self._painter is None:
            ours, theirs = multiprocessing.Pipe()
            context = multiprocessing.get_context("spawn")  # a fork inherits locks and OpenGL
            process = context.Process(target=_paint, args=(theirs, ours, *self._scene), daemon=True)
            process.start()
            theirs.close()
            self._painter = process, ours
        return self._painter[1]

    def _send_finished(self) -> None:
        if self._painter is None or not self._pending or not self._painter[1].poll():
            return
        name, self._pending = self._pending, ""
        try:
            time, picture, jpeg = self._painter[1].recv()
        except EOFError:  # it could not draw; the run does not depend on it
            self._topics.clear()
            self._cameras.clear()
            return
        camera, topics = self._cameras[name], self._topics[name]
        header = _header(camera, time)
        if topics.raw.subscribers:
            height, width = picture.shape[:2]
            topics.raw.publish(
                message(
                    "sensor_msgs/msg/Image",
                    header=header,
                    height=height,
                    width=width,
                    encoding="mono8" if camera.is_grey else "rgb8",
                    step=picture.size // height,
                    data=picture.reshape(-1),
                )
            )
        if topics.compressed.subscribers:
            kind = (
                "mono8; jpeg compressed mono8" if camera.is_grey else "rgb8; jpeg compressed bgr8"
            )
            topics.compressed.publish(
                message(
                    "sensor_msgs/msg/CompressedImage",
                    header=header,
                    format=kind,
                    data=np.frombuffer(jpeg, np.uint8),
                )
            )


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
    """Draw what is requested, one picture after the other, until the pipe closes."""
    from harness.cameras.captures import jpeg
    from harness.cameras.picture_model import build_picture_model
    from harness.cameras.recorded_scene import floor_height
    from harness.cameras.renderer import Renderer, make_renderer
    from harness.cameras.sensor import as_delivered
    from harness.cameras.viewpoint import view_of
    from harness.robot.forward_kinematics import robot_poses

    parent.close()
    picture = build_picture_model(
        description,
        objects,
        floor_height=floor_height(description, objects),
        width=max(camera.width for camera in cameras),
        height=max(camera.height for camera in cameras),
    )
    picture.model.vis.quality.shadowsize, picture.model.vis.quality.offsamples = 1024, 0
    known = {camera.name: camera for camera in cameras}
    renderers: dict[tuple[int, int], Renderer] = {}
    while True:
        try:
            name, time, sample, positions, rows = requests.recv()
        except (EOFError, KeyboardInterrupt):
            return
        camera = known[name]
        poses = robot_poses(description, positions)
        poses |= {each: SE3.from_vector(row) for each, row in rows.items()}
        picture.pose(poses)
        size = camera.width, camera.height
        if size not in renderers:
            renderers[size] = make_renderer(picture, *size)
        drawn = renderers[size].render(view_of(camera, poses[camera.frame]))
        delivered = as_delivered(drawn, camera, seed, sample)
        requests.send((time, delivered, jpeg(delivered, camera)))
