"""A node without ROS for tests: it sends what rclpy's action clients and publishers send."""

import time

import numpy as np

from harness.plugins.ros.actions import ActionClient
from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.interfaces import FOLLOW, GRIPPER, TRAJECTORY
from harness.plugins.ros.rtps.graph import Graph
from tests.waiting import HANG

ARM = ("joint1", "joint2", "joint3", "joint4")


class Node:
    """A graph with action clients for the OpenMANIPULATOR-X, or another robot."""

    def __init__(self, domain, arm="arm_controller", gripper="gripper_controller"):
        self.graph = Graph(domain, node="student")
        self.arm = ActionClient(self.graph, f"/{arm}/follow_joint_trajectory", FOLLOW)
        self.gripper = ActionClient(self.graph, f"/{gripper}/gripper_cmd", GRIPPER)
        self.received = {}

    def listen(self, topic, kind, *qos):
        messages = self.received.setdefault(topic, [])
        self.graph.subscribe(topic, kind, messages.append, *qos)
        return messages

    def wait(self, holds):
        assert self.graph.spin_until(holds, HANG), "nothing happened"

    def ready(self):
        self.wait(lambda: self.arm.is_ready and self.gripper.is_ready)

    def send(self, goal, client=None):
        """Send a goal and wait for its end."""
        sent = (client or self.arm).send(goal)
        self.wait(lambda: sent.result is not None)
        return sent

    def sleep(self, seconds):
        self.graph.spin(time.monotonic() + seconds)


def duration(seconds):
    whole = int(seconds)
    kind = "builtin_interfaces/msg/Duration"
    return message(kind, sec=whole, nanosec=round((seconds - whole) * 1e9))


def point(time_from_start, positions, velocities=None):
    speeds = np.zeros(len(positions)) if velocities is None else np.array(velocities, float)
    return message(
        "trajectory_msgs/msg/JointTrajectoryPoint",
        positions=np.array(positions, float),
        velocities=speeds,
        time_from_start=duration(time_from_start),
    )


def trajectory(*points, joints=ARM):
    return message(TRAJECTORY, joint_names=list(joints), points=list(points))


def follow(*points, joints=ARM, **fields):
    return message(f"{FOLLOW}_Goal", trajectory=trajectory(*points, joints=joints), **fields)


def grip(position, max_effort=10.0):
    command = message("control_msgs/msg/GripperCommand", position=position, max_effort=max_effort)
    return message(f"{GRIPPER}_Goal", command=command)


def tolerance(name, position):
    return message("control_msgs/msg/JointTolerance", name=name, position=position)
