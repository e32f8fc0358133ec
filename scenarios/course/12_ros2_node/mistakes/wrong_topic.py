"""The name of a topic is wrong: the messages reach no controller."""

import time

import rclpy
from builtin_interfaces.msg import Duration
from rclpy.node import Node
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

ARM = "/arm_controller/joint_trajectories"
GRIPPER = "/gripper_controller/joint_trajectory"
ARM_JOINTS = ["joint1", "joint2", "joint3", "joint4"]
GRIPPER_JOINTS = ["gripper_left_joint"]

rclpy.init()
node = Node("student")
publishers = {topic: node.create_publisher(JointTrajectory, topic, 1) for topic in (ARM, GRIPPER)}
stamps: list[float] = []  # of joint states [s]: simulated time, which may be slower than the wall's


def note_stamp(message: JointState) -> None:
    """Keep the time of joint states."""
    stamps.append(message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec)


def wait(seconds: float) -> None:
    """Wait for a simulated time, from the next joint states on."""
    stamps.clear()
    while not stamps or stamps[-1] < stamps[0] + seconds:
        rclpy.spin_once(node)


def move(topic: str, joints: list[str], positions: list[float], seconds: int) -> None:
    """Send a trajectory of one point, and let it happen."""
    point = JointTrajectoryPoint(positions=positions, time_from_start=Duration(sec=seconds))
    publishers[topic].publish(JointTrajectory(joint_names=joints, points=[point]))
    wait(seconds + 1)


node.create_subscription(JointState, "/joint_states", note_stamp, 10)
while not all(node.count_subscribers(topic) for topic in (GRIPPER,)):
    time.sleep(0.1)  # until the controllers are discovered
move(GRIPPER, GRIPPER_JOINTS, [0.015], 1)
move(ARM, ARM_JOINTS, [0.0, 0.87, -0.195, -0.67], 2)
move(GRIPPER, GRIPPER_JOINTS, [-0.005], 1)
move(ARM, ARM_JOINTS, [0.0, 0.2, -0.195, 0.0], 2)
wait(2)  # the box is held for a second
