"""The tree of frames: one parent each, links along the URDF, objects and cameras next to them."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.camera import Camera
from harness.core.pose_arrays import IDENTITY
from harness.core.types import BoolArray, FloatArray, IntArray
from harness.plugins.ros.bag.messages import header, message, transform
from harness.plugins.ros.bag.samples import Message, blocks
from harness.plugins.ros.bag.topics import TF, TF_STATIC
from harness.recording.run import Run
from harness.robot.description import RobotDescription

WORLD = "world"


@dataclass(frozen=True, eq=False)
class Edge:
    """Where frames hang that do not move.

    Attributes:
        pose: T_parent_child (xyz, quat wxyz), shape (7,).
    """

    parent: str
    child: str
    pose: FloatArray


def static_edges(run: Run) -> list[Edge]:
    """The root in the world, fixed joints, objects that stayed where they were, cameras."""
    objects = run.signals.object_poses
    return [
        *robot_edges(run.robot),
        *(Edge(WORLD, name, poses[0]) for name, poses in sorted(objects.items()) if _stays(poses)),
        *camera_edges(run.cameras, run.robot, objects),
    ]


def robot_edges(robot: RobotDescription) -> list[Edge]:
    """The root in the world, the fixed joints, and the frames of sensors that are no links."""
    children = {joint.child for joint in robot.joints}
    roots = dict.fromkeys(each.parent for each in robot.joints if each.parent not in children)
    fixed = [joint for joint in robot.joints if not joint.is_movable]
    return [
        *(Edge(WORLD, root, IDENTITY) for root in roots if root != WORLD),
        *(Edge(joint.parent, joint.child, joint.pose.as_vector()) for joint in fixed),
        *(
            Edge(sensor.link, sensor.frame_id, sensor.pose.as_vector())
            for sensor in robot.wrench_sensors.values()
            if sensor.frame_id != sensor.link
        ),
    ]


def camera_edges(
    cameras: Sequence[Camera], robot: RobotDescription, objects: Collection[str]
) -> Iterator[Edge]:
    """Optical frames that are no link of the robot already."""
    known = {WORLD, *robot.link_names, *objects}
    for camera, frame in zip(cameras, optical_frames(cameras, objects).values(), strict=True):
        if frame not in known and camera.frame in known:
            yield Edge(camera.frame, frame, camera.optical_pose.as_vector())


def moving_objects(run: Run) -> list[str]:
    """Objects with a transform of their own at every sample at which they are there."""
    return [name for name, poses in sorted(run.signals.object_poses.items()) if not _stays(poses)]


def optical_frames(cameras: Sequence[Camera], objects: Collection[str]) -> dict[str, str]:
    """The optical frame of each camera, by the camera's name; no two share one."""
    taken = {WORLD, *objects}
    frames: dict[str, str] = {}
    for camera in cameras:
        frame = camera.optical_frame_id or f"{camera.name}_optical_frame"
        frames[camera.name] = frame if frame not in taken else f"{camera.name}/{frame}"
        taken.add(frames[camera.name])
    return frames


def static_tf(run: Run) -> Message:
    """All that never moves, once."""
    start = float(run.signals.times[0])
    transforms = [
        transform_stamped(header(start, edge.parent), edge.child, edge.pose)
        for edge in static_edges(run)
    ]
    return Message(start, TF_STATIC, message(TF.msgtype, transforms=transforms))


def moving_tf(run: Run, indices: IntArray) -> Iterator[Message]:
    """Every moving joint and every free object that is there, at each sample."""
    moved = run.robot.movable_joints
    objects = moving_objects(run)
    for block in blocks(indices):
        positions = run.signals.joint_positions[block]
        edges = [(joint.parent, joint.child) for joint in moved] + [
            (WORLD, name) for name in objects
        ]
        poses = [joint.poses(positions[:, column]) for column, joint in enumerate(moved)]
        poses += [run.signals.object_poses[name][block] for name in objects]
        if not poses:
            return
        rows = np.stack(poses, axis=1)
        there: BoolArray = ~np.any(np.isnan(rows), axis=2)
        for number, index in enumerate(block):
            time = float(run.signals.times[index])
            transforms = [
                transform_stamped(header(time, parent), child, rows[number, place])
                for place, (parent, child) in enumerate(edges)
                if there[number, place]
            ]
            yield Message(time, TF, message(TF.msgtype, transforms=transforms))


def _stays(poses: FloatArray) -> bool:
    return bool((poses == poses[0]).all())


def transform_stamped(head: Any, child: str, pose: FloatArray) -> Any:
    """The transform of a child frame in the frame of a header, shape (7,)."""
    kind, content = "geometry_msgs/msg/TransformStamped", transform(pose.tolist())
    return message(kind, header=head, child_frame_id=child, transform=content)
