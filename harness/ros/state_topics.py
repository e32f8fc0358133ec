"""What the cell publishes of itself: joints, frames, the clock, the robot's description."""

from __future__ import annotations

from collections.abc import Iterable

from harness.core.types import FloatArray
from harness.recording.link_poses import placement_poses
from harness.recording.robot_record import RobotRecord
from harness.reporting.rosbag.frames import Edge, robot_edges, transform_stamped
from harness.reporting.rosbag.messages import message
from harness.ros.graph import LATCHED, Graph, Qos
from harness.ros.interfaces import header, stamp

TF = "tf2_msgs/msg/TFMessage"
TF_EVERY = 2
"""Ticks between two messages of frames: 50 Hz."""


class StateTopics:
    """Publishes the state of the robot after every tick."""

    def __init__(self, graph: Graph, robot: RobotRecord, cameras: Iterable[Edge]) -> None:
        """Advertise the topics, and publish what does not change, with the frames of cameras."""
        names = [joint.name for joint in robot.joints]
        self._moved = [placement for placement in robot.placements if placement.joint]
        self._columns = [names.index(placement.joint) for placement in self._moved]
        self._clock = graph.advertise("/clock", "rosgraph_msgs/msg/Clock", Qos(depth=1))
        self._joints = graph.advertise("/joint_states", "sensor_msgs/msg/JointState")
        self._state = message("sensor_msgs/msg/JointState", name=names)
        self._tf = graph.advertise("/tf", TF, Qos(depth=100))
        static = graph.advertise("/tf_static", TF, LATCHED)
        fixed = [
            transform_stamped(header(0.0, edge.parent), edge.child, edge.pose)
            for edge in (*robot_edges(robot), *cameras)
        ]
        static.publish(message(TF, transforms=fixed))
        description = graph.advertise("/robot_description", "std_msgs/msg/String", LATCHED)
        description.publish(message("std_msgs/msg/String", data=robot.urdf))
        self._ticks = 0

    def publish(
        self, time: float, positions: FloatArray, velocities: FloatArray, efforts: FloatArray
    ) -> None:
        """Publish the state of the joints, description order, at a simulated time [s]."""
        moment = stamp(time)
        self._clock.publish(message("rosgraph_msgs/msg/Clock", clock=moment))
        state = self._state
        state.header.stamp = moment
        state.position, state.velocity, state.effort = positions, velocities, efforts
        self._joints.publish(state)
        self._ticks += 1
        if self._ticks % TF_EVERY == 0 and self._tf.subscribers:
            moved = zip(self._moved, positions[self._columns, None], strict=True)
            transforms = [
                transform_stamped(
                    header(time, each.parent), each.link, placement_poses(each, position)[0]
                )
                for each, position in moved
            ]
            self._tf.publish(message(TF, transforms=transforms))
