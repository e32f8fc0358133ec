"""Live pictures of the scenario's cameras, drawn by a process of their own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from multiprocessing import Pipe
from multiprocessing.context import SpawnProcess
from typing import Any

import numpy as np

from harness.cell.program import Program
from harness.core.camera import Camera
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.plugins.ros.bag.cameras import camera_info, compressed_image, image
from harness.plugins.ros.bag.frames import optical_frames
from harness.plugins.ros.bag.topics import camera_topics
from harness.plugins.ros.endpoints import Qos
from harness.plugins.ros.interfaces import header
from harness.plugins.ros.rtps.graph import Graph

Poses = Callable[[], Mapping[str, FloatArray]]  # T_world_object of those that are there


class _Topics:
    """What one camera publishes, named as the course's Gazebo does.

    Attributes:
        due: Simulated time of the next picture [s].
        requested: Pictures that were due while a node subscribed.
        sent: Pictures that were published.
        late: The largest delay between a picture's simulated time and its publication [s].
    """

    def __init__(self, graph: Graph, camera: Camera, frame: str) -> None:
        topics, self.camera, self._frame, self.due = camera_topics(camera.name), camera, frame, 0.0
        self.requested, self.sent, self.late = 0, 0, 0.0
        self._raw, self._compressed = (
            graph.advertise(each.name, each.msgtype, Qos(depth=1))
            for each in (topics.image, topics.compressed)
        )
        names = topics.info.name, f"{topics.image.name}/camera_info"
        self._infos = [graph.advertise(name, topics.info.msgtype) for name in names]

    @property
    def are_watched(self) -> bool:
        return bool(self._raw.subscribers or self._compressed.subscribers)

    def publish_info(self, time: float) -> None:
        content = camera_info(self.camera, header(time, self._frame))
        for info in self._infos:
            info.publish(content)

    def publish(self, time: float, picture: np.ndarray, compressed: bytes) -> None:
        self.sent += 1
        head = header(time, self._frame)
        self._raw.publish(image(picture, head))
        self._compressed.publish(compressed_image(compressed, self.camera, head))


class CameraTopics:
    """Publishes pictures while someone subscribes to them; a slow machine sends fewer."""

    def __init__(self, graph: Graph, program: Program) -> None:
        cameras, objects = tuple(program.cameras.values()), program.all_objects()
        frames = optical_frames(cameras, [each.name for each in objects])
        self._topics = [_Topics(graph, camera, frames[camera.name]) for camera in cameras]
        self._make_painter = partial(_Painter, program.seed, program.description, objects, cameras)
        self._painter: _Painter | None = None
        self._pending: tuple[_Topics, float] | None = None

    def publish(self, time: float, sample: int, positions: FloatArray, poses: Poses) -> None:
        """Publish what is due at a simulated time [s].

        Args:
            sample: Index of the physics sample, from which the noise is drawn.
            positions: Joint positions in description order, shape (n,).
        """
        self._send_finished(time)
        for topics in self._topics:
            if time < topics.due - 1e-9:
                continue
            topics.due = time + 1.0 / topics.camera.update_rate
            topics.publish_info(time)
            topics.requested += topics.are_watched
            if topics.are_watched and self._pending is None:
                self._pending = topics, time
                self._painter = self._painter or self._make_painter()
                self._painter.pictures.send((topics.camera, sample, positions, poses()))

    def close(self) -> None:
        """End the process that draws."""
        if self._painter is not None:
            self._painter.pictures.close()
            self._painter.terminate()
            self._painter.join(5)
            self._painter = self._pending = None

    def remarks(self) -> list[str]:
        """A sentence on each camera of which fewer pictures were sent than its rate requires."""
        return [
            f"{topics.sent} of {topics.requested} pictures of '{topics.camera.name}' were sent, at"
            f" most {topics.late:.2f} s late in simulated time: this machine draws no more; lower"
            " the camera's update_rate or its size, or --pace"
            for topics in self._topics
            if topics.requested - topics.sent > 1
        ]

    def _send_finished(self, now: float) -> None:
        if self._painter is None or self._pending is None or not self._painter.pictures.poll():
            return
        (topics, time), self._pending = self._pending, None
        try:
            drawn = self._painter.pictures.recv()
        except EOFError:  # it could not draw; the run does not depend on it
            self._topics.clear()
            return
        if drawn is not None:
            topics.late = max(topics.late, now - time)
            topics.publish(time, *drawn)


class _Painter(SpawnProcess):
    """Draws what is requested through `pictures`, one picture after the other, until that closes.

    The answer is a picture as the camera delivers it, and as a JPEG; None while the camera's
    carrier is not in the scene. A fork would inherit locks and OpenGL, and a worker of an executor
    would outlive a parent that is killed.
    """

    def __init__(self, seed: int, *scene: Any) -> None:
        """Start the process for a scene: its robot, its objects and its cameras."""
        super().__init__(daemon=True)
        self._seed, self._scene = seed, scene
        self.pictures, self._requests = Pipe()
        self.start()
        self._requests.close()

    def run(self) -> None:
        from harness.cameras.camera_recorder import camera_recorder
        from harness.core.picture_files import jpeg

        self.pictures.close()
        description, objects, of_scene = self._scene
        cameras = camera_recorder(description, objects).live(of_scene)
        while True:
            try:
                camera, sample, positions, rows = self._requests.recv()
            except (EOFError, KeyboardInterrupt):
                return
            objects = {name: SE3.from_vector(row) for name, row in rows.items()}
            picture = cameras.picture(camera, positions, objects, (self._seed, sample))
            drawn = None if picture is None else (picture, jpeg(picture, camera.jpeg_quality))
            self._requests.send(drawn)
