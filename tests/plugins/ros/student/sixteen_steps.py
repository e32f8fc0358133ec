"""A student's node: sends trajectories from a file to the controllers of a UR3e and its gripper."""

import json
import sys
from pathlib import Path

import rclpy
from control_msgs.action import FollowJointTrajectory, GripperCommand
from rclpy.action import ActionClient
from rclpy.duration import Duration
from rclpy.node import Node
from trajectory_msgs.msg import JointTrajectoryPoint


class SixteenSteps(Node):
    def __init__(self):
        super().__init__("sixteen_steps")
        arm = "/joint_trajectory_controller/follow_joint_trajectory"
        self.arm = ActionClient(self, FollowJointTrajectory, arm)
        self.gripper = ActionClient(self, GripperCommand, "/gripper_controller/gripper_cmd")
        for client in (self.arm, self.gripper):
            assert client.wait_for_server(timeout_sec=30)

    def send(self, client, goal):
        sent = client.send_goal_async(goal)
        rclpy.spin_until_future_complete(self, sent)
        assert sent.result().accepted
        result = sent.result().get_result_async()
        rclpy.spin_until_future_complete(self, result)
        return result.result().result

    def move(self, joint_names, points):
        goal = FollowJointTrajectory.Goal()
        goal.trajectory.joint_names = joint_names
        goal.trajectory.points = [
            JointTrajectoryPoint(
                positions=positions,
                velocities=velocities,
                time_from_start=Duration(seconds=time).to_msg(),
            )
            for time, positions, velocities in points
        ]
        result = self.send(self.arm, goal)
        assert result.error_code == 0, result.error_string

    def grip(self, position):
        goal = GripperCommand.Goal()
        goal.command.position = position
        self.send(self.gripper, goal)


rclpy.init()
node = SixteenSteps()
for motion in json.loads(Path(sys.argv[1]).read_text()):
    if "gripper" in motion:
        node.grip(motion["gripper"])
    else:
        node.move(motion["joint_names"], motion["points"])
rclpy.spin(node)
