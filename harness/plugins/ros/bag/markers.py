"""What stands in the scene, as markers: fixed objects in the world, moving ones in their frames."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Plane, Rgba, Shape, Sphere
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.plugins.ros.bag.frames import WORLD, moving_objects
from harness.plugins.ros.bag.messages import TYPES, header, message, point, pose_message, vector
from harness.plugins.ros.bag.samples import Message
from harness.plugins.ros.bag.topics import SCENE_MARKERS
from harness.recording.drawings import Drawings, MeshRecord
from harness.recording.link_poses import planned_tcp_poses
from harness.recording.run import ObjectRecord, Run
from harness.recording.step_record import StepRecord
from harness.recording.stored_run import StoredRun

MARKER = "visualization_msgs/msg/Marker"
Marker: Any = TYPES[MARKER]
PLANE_SIZE = 4.0  # of the square that stands for an endless plane [m]
PLANNED = "planned_tcp"
PLANNED_COLOUR: Rgba = (0.5, 0.2, 0.9, 1.0)
LINE_WIDTH = 0.004  # [m]

Solid = tuple[int, tuple[float, float, float], SE3]
"""A marker's type, its scale, and T_shape_marker."""


def scene_markers(stored: StoredRun) -> Iterator[Message]:
    """Every object and planned path there is, anew each time that this changes."""
    run = stored.run
    first, last = float(run.signals.times[0]), float(run.signals.times[-1])
    planned = ((step.start_time, _planned(run, step)) for step in run.steps)
    lines = [(time, line) for time, line in planned if line is not None]
    changes = {first, *(time for time, _ in lines)}
    changes |= {time for obj in run.objects for span in obj.present for time in span}
    for time in sorted(time for time in changes if first <= time < last or time == first):
        yield Message(time, SCENE_MARKERS, _array(stored, time, lines))


def _array(stored: StoredRun, time: float, lines: Sequence[tuple[float, FloatArray]]) -> Any:
    """All that is there at a time; what was there before is taken away first."""
    markers = [_marker(time, WORLD, "", 0, action=Marker.DELETEALL)]
    moving = set(moving_objects(stored.run))
    for obj in stored.run.objects:
        if any(begin <= time < end for begin, end in obj.present):
            markers += _of_object(stored, obj, time, is_moving=obj.name in moving)
    for number, (begin, points) in enumerate(lines):
        if begin <= time:
            line = _marker(time, WORLD, PLANNED, number, kind=Marker.LINE_STRIP)
            line.scale = vector((LINE_WIDTH, 0.0, 0.0))
            line.color = _colour(PLANNED_COLOUR)
            line.points = _points(points)
            markers.append(line)
    return message(SCENE_MARKERS.msgtype, markers=markers)


def _of_object(stored: StoredRun, obj: ObjectRecord, time: float, *, is_moving: bool) -> list[Any]:
    known = stored.run.signals.object_poses.get(obj.name)
    pose = np.array(obj.pose) if known is None else known[0]
    if not is_moving and not pose.size:
        return []
    base, frame = (SE3.identity(), obj.name) if is_moving else (SE3.from_vector(pose), WORLD)
    markers: list[Any] = []
    for shape in obj.looks:
        for kind, scale, offset in _solids(shape):
            marker = _marker(time, frame, obj.name, len(markers), kind=kind)
            marker.pose = pose_message((base @ shape.pose @ offset).as_vector().tolist())
            marker.scale = vector(scale)
            marker.color = _colour(shape.rgba)
            markers.append(marker)
        for mesh in _meshes(stored.drawings, shape):
            marker = _marker(time, frame, obj.name, len(markers), kind=Marker.TRIANGLE_LIST)
            marker.pose = pose_message((base @ shape.pose).as_vector().tolist())
            marker.scale = vector((1.0, 1.0, 1.0))
            marker.color = _colour(mesh.rgba or shape.rgba)
            marker.points = _points(mesh.vertices[mesh.faces].reshape(-1, 3))
            markers.append(marker)
    return markers


def _solids(shape: Shape) -> list[Solid]:
    """The markers that make up a shape; none of a mesh."""
    match shape.geometry:
        case Box(size=size):
            return [(Marker.CUBE, size, SE3.identity())]
        case Sphere(radius=radius):
            return [_ball(radius, SE3.identity())]
        case Cylinder(radius=radius, length=length):
            return [(Marker.CYLINDER, (2 * radius, 2 * radius, length), SE3.identity())]
        case Capsule(radius=radius, length=length):
            ends = [SE3.from_xyz_rpy((0, 0, z)) for z in (-0.5 * length, 0.5 * length)]
            body = (Marker.CYLINDER, (2 * radius, 2 * radius, length), SE3.identity())
            return [body, *(_ball(radius, end) for end in ends)]
        case Plane():
            below = SE3.from_xyz_rpy((0, 0, -0.0005))
            return [(Marker.CUBE, (PLANE_SIZE, PLANE_SIZE, 0.001), below)]
        case Mesh():
            return []


def _ball(radius: float, pose: SE3) -> Solid:
    return Marker.SPHERE, (2 * radius, 2 * radius, 2 * radius), pose


def _meshes(drawings: Drawings, shape: Shape) -> Iterator[MeshRecord]:
    geometry = shape.geometry
    for record in drawings.meshes:
        if isinstance(geometry, Mesh) and (record.path, record.scale) == (
            geometry.path,
            geometry.scale,
        ):
            yield record


def _planned(run: Run, step: StepRecord) -> FloatArray | None:
    """Where a step's trajectory was to take the TCP, shape (points, 3) [m]."""
    if step.trajectory is None or step.start_index >= len(run.signals.times):
        return None
    names, positions = step.trajectory.joint_names, step.trajectory.positions
    poses = planned_tcp_poses(run, step, names, positions)
    return None if poses is None else poses[:, :3]


def _marker(
    time: float, frame: str, ns: str, number: int, *, kind: int = 0, action: int = 0
) -> Any:
    head, picture = header(time, frame), "sensor_msgs/msg/CompressedImage"
    return message(
        MARKER, header=head, ns=ns, id=number, type=kind, action=action, frame_locked=True,
        pose=pose_message([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]),
        texture=message(picture, header=header(time)),
    )  # fmt: skip


def _colour(rgba: Rgba) -> Any:
    r, g, b, a = map(float, rgba)
    return message("std_msgs/msg/ColorRGBA", r=r, g=g, b=b, a=a)


def _points(points: FloatArray) -> list[Any]:
    return [point(each) for each in points.tolist()]
