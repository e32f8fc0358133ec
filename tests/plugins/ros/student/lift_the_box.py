"""A student's nodes in one: gripper, inverse kinematics and joint angles lift the red box."""

import math
import time

import rclpy
from builtin_interfaces.msg import Duration
from control_msgs.action import GripperCommand
from rclpy.action import ActionClient
from rclpy.node import Node
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

UPPER, FORE, HAND = math.hypot(0.024, 0.128), 0.124, 0.126
SHOULDER = (0.012, 0.0595 + 0.017)
BEND = math.atan2(0.024, 0.128)


def inverse_kinematics(x, y, z, pitch=0.0):
    """Joint angles that put the gripper to a point with a pitch; the elbow is up."""
    turn = math.atan2(y, x - SHOULDER[0])
    reach = math.hypot(x - SHOULDER[0], y) - HAND * math.cos(pitch)
    height = z - SHOULDER[1] + HAND * math.sin(pitch)
    distance = math.hypot(reach, height)
    inner = math.acos((UPPER**2 + distance**2 - FORE**2) / (2 * UPPER * distance))
    elbow = math.acos((UPPER**2 + FORE**2 - distance**2) / (2 * UPPER * FORE))
    shoulder = math.pi / 2 - math.atan2(height, reach) - inner - BEND
    bend = math.pi / 2 + BEND - elbow
    return [turn, shoulder, bend, pitch - shoulder - bend]


class Lift(Node):
    def __init__(self):
        super().__init__("lift_the_box")
        self.arm = self.create_publisher(JointTrajectory, "/arm_controller/joint_trajectory", 10)
        self.gripper = ActionClient(self, GripperCommand, "/gripper_controller/gripper_cmd")
        self.positions = {}
        self.create_subscription(JointState, "/joint_states", self.take, 10)

    def take(self, state):
        self.positions = dict(zip(state.name, state.position, strict=True))

    def grip(self, position):
        goal = GripperCommand.Goal()
        goal.command.position, goal.command.max_effort = position, 10.0
        sent = self.gripper.send_goal_async(goal)
        rclpy.spin_until_future_complete(self, sent)
        result = sent.result().get_result_async()
        rclpy.spin_until_future_complete(self, result)
        return result.result().result

    def move(self, angles, seconds=2):
        names = ["joint1", "joint2", "joint3", "joint4"]
        point = JointTrajectoryPoint(
            positions=angles, velocities=[0.0] * 4, time_from_start=Duration(sec=seconds)
        )
        self.arm.publish(JointTrajectory(joint_names=names, points=[point]))
        end = time.monotonic() + 60
        while time.monotonic() < end:
            rclpy.spin_once(self, timeout_sec=0.1)
            here = [self.positions.get(name, 9.0) for name in names]
            errors = [abs(a - b) for a, b in zip(here, angles, strict=True)]
            if max(errors) < 0.01:
                return
        raise TimeoutError(f"the arm does not arrive: {errors}")


rclpy.init()
node = Lift()
assert node.gripper.wait_for_server(timeout_sec=30)
while not node.positions or not node.arm.get_subscription_count():
    rclpy.spin_once(node, timeout_sec=0.1)
node.grip(0.019)
node.move(inverse_kinematics(0.25, 0.0, 0.1))
node.move([0.0, 0.87, -0.195, -0.67])
assert node.grip(0.0).stalled
node.move([0.0, 0.2, -0.195, 0.0])
rclpy.spin(node)
