"""The calls that MoveItSimpleControllerManager makes, in their order, with rclpy; prints JSON.

Its handles check that the action server is ready, send a goal without tolerances and wait for the
goal's response, then request the result and wait with a timeout; stopping means a request to cancel
whose response is awaited. The gripper's goal is the last point of a trajectory, with an effort of 0
where the trajectory has none.
"""

import json
import sys
import time

import rclpy
from control_msgs.action import FollowJointTrajectory, GripperCommand
from rclpy.action import ActionClient
from rclpy.duration import Duration
from rclpy.node import Node
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectoryPoint

rclpy.init()
node = Node("move_group")
states = []
node.create_subscription(JointState, "/joint_states", states.append, 10)


class Handle:
    def __init__(self, action, name):
        self.action, self.client = action, ActionClient(node, action, name)
        self.goal = self.result = None

    def await_(self, future, timeout=None):
        rclpy.spin_until_future_complete(node, future, timeout_sec=timeout)
        return future.result()

    def send_trajectory(self, goal):
        assert self.client.server_is_ready()
        self.goal = self.await_(self.client.send_goal_async(goal))
        return self.goal.accepted

    def wait_for_execution(self, timeout):
        self.result = self.await_(self.goal.get_result_async(), timeout)
        return self.result is not None

    def cancel_execution(self):
        return len(self.await_(self.goal.cancel_goal_async()).goals_canceling)


def trajectory(*points):
    goal = FollowJointTrajectory.Goal()
    goal.trajectory.joint_names = ["joint1", "joint2", "joint3", "joint4"]
    goal.trajectory.points = [
        JointTrajectoryPoint(
            positions=[float(value) for value in positions],
            velocities=[0.0] * 4,
            accelerations=[0.0] * 4,
            time_from_start=Duration(seconds=seconds).to_msg(),
        )
        for seconds, positions in points
    ]
    return goal


arm = Handle(FollowJointTrajectory, "arm_controller/follow_joint_trajectory")
gripper = Handle(GripperCommand, "gripper_controller/gripper_cmd")
end = time.monotonic() + 30
while time.monotonic() < end and not (
    states and arm.client.server_is_ready() and gripper.client.server_is_ready()
):
    rclpy.spin_once(node, timeout_sec=0.1)
start = list(states[-1].position[:4])
there = [0.2, 0.0, 0.0, 0.0]
said = {}
assert arm.send_trajectory(trajectory((0.0, start), (0.5, there)))
assert arm.wait_for_execution(10.0)
said["executed"] = [arm.result.status, arm.result.result.error_code]
assert arm.send_trajectory(trajectory((0.0, there), (8.0, start)))
said["timed out"] = not arm.wait_for_execution(0.3)
said["canceled"] = arm.cancel_execution()
here = list(states[-1].position[:4])
assert arm.send_trajectory(trajectory((0.0, here), (0.5, there)))
assert arm.wait_for_execution(10.0)
said["executed again"] = [arm.result.status, arm.result.result.error_code]
said["rejected"] = not arm.send_trajectory(trajectory((0.5, [9.0, 0.0, 0.0, 0.0])))
command = GripperCommand.Goal()
command.command.position = 0.015
assert gripper.send_trajectory(command)
assert gripper.wait_for_execution(10.0)
said["gripper"] = [gripper.result.status, gripper.result.result.reached_goal]
sys.stdout.write(json.dumps(said) + "\n")
