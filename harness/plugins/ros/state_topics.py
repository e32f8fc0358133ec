"""The topics that show the state of the robot: joints, frames, the clock, and the TCP's path."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from harness.core.kinematics import LinkPoses
from harness.core.types import FloatArray, IntArray
from harness.plugins.ros.bag.frames import Edge, robot_edges, transform_stamped
from harness.plugins.ros.bag.messages import message, pose_message
from harness.plugins.ros.bag.wrenches import WRENCH, wrench_message, wrench_topic
from harness.plugins.ros.endpoints import LATCHED, Qos
from harness.plugins.ros.interfaces import header, stamp
from harness.plugins.ros.rtps.graph import Graph
from harness.robot.description import RobotDescription

STATE = "sensor_msgs/msg/JointState"
TF = "tf2_msgs/msg/TFMessage"
TF_EVERY = 2  # ticks between two messages of frames: 50 Hz
PATH = "nav_msgs/msg/Path"
PATH_EVERY, PATH_STEP, MOST_POSES = 20, 0.02, 10_000
"""Of the TCP's path: ticks between two messages (5 Hz), distance between two poses [m], as in the
course's launch files, and poses that are kept."""


class _Joints:
    """Publishes the state of some joints."""

    def __init__(
        self, graph: Graph, topic: str, names: Sequence[str], places: slice | IntArray
    ) -> None:
        """Advertise a topic of the joints at some places in description order."""
        self._publisher, self._places = graph.advertise(topic, STATE), places
        self._state = message(STATE, name=names)

    def publish(
        self, moment: Any, positions: FloatArray, velocities: FloatArray, efforts: FloatArray
    ) -> None:
        state, places = self._state, self._places
        state.header.stamp = moment
        state.position, state.velocity = positions[places], velocities[places]
        state.effort = efforts[places]
        self._publisher.publish(state)


def _joints_of_arms(graph: Graph, robot: RobotDescription) -> Iterator[_Joints]:
    """A topic for each of several arms, with its joints and those of its gripper."""
    for arm in robot.arms:
        owners = (robot.arm_of_link.get(joint.child) for joint in robot.movable_joints)
        places = np.flatnonzero([owner == arm.name for owner in owners])
        names = [robot.joint_names[place] for place in places]
        yield _Joints(graph, f"/{arm.name}/joint_states", names, places)


class _Path:
    """Publishes where a TCP was: a pose for each distance that it moved."""

    def __init__(self, graph: Graph, topic: str, robot: RobotDescription, link: str) -> None:
        self._publisher, self._robot, self._link = graph.advertise(topic, PATH), robot, link
        self._poses: deque[Any] = deque(maxlen=MOST_POSES)
        self._last = np.full(3, np.inf)

    def publish(self, time: float, positions: FloatArray) -> None:
        joints, link = self._robot.joints, self._link
        row, root = LinkPoses(joints, positions, [link]).rows(link)[0], joints[0].parent
        if not np.linalg.norm(row[:3] - self._last) < PATH_STEP:
            self._last = row[:3]
            kind, pose = "geometry_msgs/msg/PoseStamped", pose_message([*row])
            self._poses.append(message(kind, header=header(time, root), pose=pose))
        if self._publisher.subscribers:
            head = header(time, root)
            self._publisher.publish(message(PATH, header=head, poses=[*self._poses]))


class StateTopics:
    """Publishes the state of the robot after every tick."""

    def __init__(self, graph: Graph, robot: RobotDescription, cameras: Iterable[Edge]) -> None:
        """Advertise the topics, and publish what does not change, with the frames of cameras."""
        self._moved = robot.movable_joints
        self._clock = graph.advertise("/clock", "rosgraph_msgs/msg/Clock", Qos(depth=1))
        everything = _Joints(graph, "/joint_states", robot.joint_names, slice(None))
        self._joints = [everything, *_joints_of_arms(graph, robot)]
        self._tf = graph.advertise("/tf", TF, Qos(depth=100))
        static = graph.advertise("/tf_static", TF, LATCHED)
        fixed = [
            transform_stamped(header(0.0, edge.parent), edge.child, edge.pose)
            for edge in (*robot_edges(robot), *cameras)
        ]
        static.publish(message(TF, transforms=fixed))
        description = graph.advertise("/robot_description", "std_msgs/msg/String", LATCHED)
        description.publish(message("std_msgs/msg/String", data=robot.urdf))
        self._ticks, self._robot = 0, robot
        tips = {f"/{arm.name}": arm.tcp_link for arm in robot.arms} or {"": robot.tcp_link}
        self._paths = [_Path(graph, f"{arm}/trajectory", robot, tip) for arm, tip in tips.items()]
        self._wrenches = {
            name: graph.advertise(wrench_topic(name).name, WRENCH) for name in robot.wrench_sensors
        }

    def publish(
        self, time: float, positions: FloatArray, velocities: FloatArray, efforts: FloatArray
    ) -> None:
        """Publish the state of the joints, description order, at a simulated time [s]."""
        moment = stamp(time)
        self._clock.publish(message("rosgraph_msgs/msg/Clock", clock=moment))
        for joints in self._joints:
            joints.publish(moment, positions, velocities, efforts)
        self._ticks += 1
        if self._ticks % PATH_EVERY == 0:
            for path in self._paths:
                path.publish(time, positions)
        if self._ticks % TF_EVERY == 0 and self._tf.subscribers:
            transforms = [
                transform_stamped(
                    header(time, joint.parent), joint.child, joint.at(position).as_vector()
                )
                for joint, position in zip(self._moved, positions, strict=True)
            ]
            self._tf.publish(message(TF, transforms=transforms))

    def publish_wrench(self, time: float, name: str, wrench: FloatArray) -> None:
        """Publish what a sensor of force and torque reads, shape (6,), at a simulated time [s]."""
        head = header(time, self._robot.wrench_sensors[name].frame_id)
        self._wrenches[name].publish(wrench_message(head, wrench))
