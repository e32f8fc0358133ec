"""A student's node: joint angles on the command topic, again and again as the course does."""

import sys

import rclpy
from builtin_interfaces.msg import Duration
from rclpy.node import Node
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint


class JointAngles(Node):
    def __init__(self, angles):
        super().__init__("joint_angles")
        self.publisher = self.create_publisher(
            JointTrajectory, "/arm_controller/joint_trajectory", 10
        )
        self.angles = angles
        self.create_timer(0.1, self.send)

    def send(self):
        point = JointTrajectoryPoint(
            positions=self.angles, velocities=[0.0] * 4, time_from_start=Duration(sec=2)
        )
        names = ["joint1", "joint2", "joint3", "joint4"]
        self.publisher.publish(JointTrajectory(joint_names=names, points=[point]))


rclpy.init()
rclpy.spin(JointAngles([float(word) for word in sys.argv[1:]]))
