"""Live pictures of the scenario's cameras, drawn by a process of their own."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess

import numpy as np

from harness.cell.program import Program
from harness.core.camera import Camera
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.reporting.rosbag.cameras import camera_info, compressed_image, image
from harness.reporting.rosbag.frames import optical_frames
from harness.reporting.rosbag.topics import topic_word
from harness.robot.description import RobotDescription
from harness.ros.graph import Graph, Qos
from harness.ros.interfaces import header

IMAGE, COMPRESSED, INFO = (
    f"sensor_msgs/msg/{name}" for name in ("Image", "CompressedImage", "CameraInfo")
)


class _Topics:
    """What one camera publishes, named as the course's Gazebo does."""

    def __init__(self, graph: Graph, camera: Camera, frame: str) -> None:
        base, self.camera, self._frame, self.due = f"/{topic_word(camera.name)}", camera, frame, 0.0
        self._raw = graph.advertise(f"{base}/image", IMAGE, Qos(depth=1))
        self._compressed = graph.advertise(f"{base}/image/compressed", COMPRESSED, Qos(depth=1))
        names = f"{base}/camera_info", f"{base}/image/camera_info"
        self._infos = [graph.advertise(name, INFO) for name in names]

    @property
    def are_watched(self) -> bool:
        return bool(self._raw.subscribers or self._compressed.subscribers)

    def publish_info(self, time: float) -> None:
        content = camera_info(self.camera, header(time, self._frame))
        for info in self._infos:
            info.publish(content)

    def publish(self, time: float, picture: np.ndarray, compressed: bytes) -> None:
        head = header(time, self._frame)
        self._raw.publish(image(picture, head))
        self._compressed.publish(compressed_image(compressed, self.camera, head))


class CameraTopics:
    """Publishes pictures while someone subscribes to them; a slow machine sends fewer."""

    def __init__(self, graph: Graph, program: Program) -> None:
        cameras, objects = tuple(program.cameras.values()), program.all_objects()
        frames = optical_frames(cameras, [each.name for each in objects])
        self._topics = [_Topics(graph, camera, frames[camera.name]) for camera in cameras]
        self._scene = cameras, program.description, objects, program.seed
        self._painter: tuple[BaseProcess, Connection] | None = None
        self._pending: tuple[_Topics, float] | None = None

    def publish(
        self,
        time: float,
        sample: int,
        positions: FloatArray,
        poses: Callable[[], Mapping[str, FloatArray]],
    ) -> None:
        """Publish what is due at a simulated time [s].

        Args:
            sample: Index of the physics sample, from which the noise is drawn.
            positions: Joint positions in description order, shape (n,).
            poses: Returns T_world_object of the objects that are there, shape (7,) each.
        """
        self._send_finished()
        for topics in self._topics:
            if time < topics.due - 1e-9:
                continue
            topics.due = time + 1.0 / topics.camera.update_rate
            topics.publish_info(time)
            if topics.are_watched and self._pending is None:
                self._pending = topics, time
                _, connection = self._painter = self._painter or _start_painter(*self._scene)
                connection.send((topics.camera.name, sample, positions, poses()))

    def close(self) -> None:
        """End the process that draws."""
        if self._painter is not None:
            process, connection = self._painter
            connection.close()
            process.terminate()
            process.join(5)
            self._painter = self._pending = None

    def _send_finished(self) -> None:
        if self._painter is None or self._pending is None or not self._painter[1].poll():
            return
        (topics, time), self._pending = self._pending, None
        try:
            drawn = self._painter[1].recv()
        except EOFError:  # it could not draw; the run does not depend on it
            self._topics.clear()
            return
        if drawn is not None:
            topics.publish(time, *drawn)


def _start_painter(*scene: object) -> tuple[BaseProcess, Connection]:
    """A process that draws a scene; a fork would inherit locks and OpenGL.

    A worker of an executor would outlive a parent that is killed.
    """
    ours, theirs = multiprocessing.Pipe()
    context = multiprocessing.get_context("spawn")
    process = context.Process(target=_paint, args=(theirs, ours, *scene), daemon=True)
    process.start()
    theirs.close()
    return process, ours


def _paint(
    requests: Connection,
    parent: Connection,
    cameras: Sequence[Camera],
    description: RobotDescription,
    objects: Sequence[WorldObject],
    seed: int,
) -> None:
    """Draw what is requested, one picture after the other, until the pipe closes.

    The answer is a picture as the camera delivers it, and as a JPEG; None while the camera's
    carrier is not in the scene.
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
        if view is None:
            requests.send(None)
            continue
        ideal = make(camera.width, camera.height).render(view)
        picture = as_delivered(ideal, camera, seed, sample)
        requests.send((picture, jpeg(picture, camera)))
