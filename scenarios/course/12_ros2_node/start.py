"""Course 12: a node opens the gripper, reaches for the red box, closes and lifts it."""

import time

import rclpy
from builtin_interfaces.msg import Duration
from rclpy.node import Node
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

ARM = "/arm_controller/joint_trajectory"
GRIPPER = "/gripper_controller/joint_trajectory"
ARM_JOINTS = ["joint1", "joint2", "joint3", "joint4"]
GRIPPER_JOINTS = ["gripper_left_joint"]

rclpy.init()
node = Node("student")
publishers = {topic: node.create_publisher(JointTrajectory, topic, 1) for topic in (ARM, GRIPPER)}


def move(topic: str, joints: list[str], positions: list[float], seconds: int) -> None:
    """Send a trajectory of one point, and let it happen."""
    point = JointTrajectoryPoint(positions=positions, time_from_start=Duration(sec=seconds))
    publishers[topic].publish(JointTrajectory(joint_names=joints, points=[point]))
    time.sleep(seconds + 1)


while not all(node.count_subscribers(topic) for topic in (ARM, GRIPPER)):
    time.sleep(0.1)  # until the controllers are discovered
move(GRIPPER, GRIPPER_JOINTS, [0.015], 1)
move(ARM, ARM_JOINTS, [0.0, 0.87, -0.195, -0.67], 2)
# To do: close the gripper, and lift the box by 5 cm for a second.
