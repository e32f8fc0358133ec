"""Moves two arms by their names, grips with one, and moves both with MoveIt; fails at a mistake."""

import threading
import time

import rclpy
from builtin_interfaces.msg import Duration
from control_msgs.action import FollowJointTrajectory, GripperCommand
from moveit_msgs.action import MoveGroup
from moveit_msgs.msg import Constraints, JointConstraint
from rclpy.action import ActionClient
from rclpy.node import Node
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectoryPoint

rclpy.init()
node = Node("student")
states = {}
for arm in ("left", "right"):
    heard = states.setdefault(arm, [])
    node.create_subscription(JointState, f"/{arm}/joint_states", heard.append, 10)
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()


def until(holds, seconds=60.0):
    end = time.monotonic() + seconds
    while not holds() and time.monotonic() < end:
        time.sleep(0.002)
    assert holds()


def send(kind, name, goal):
    client = ActionClient(node, kind, name)
    assert client.wait_for_server(60.0)
    sent = client.send_goal_async(goal)
    until(sent.done)
    return sent.result().get_result_async()


def follow(arm, turn):
    goal = FollowJointTrajectory.Goal()
    goal.trajectory.joint_names = [f"{arm}_joint{number}" for number in (1, 2, 3, 4)]
    point = JointTrajectoryPoint(positions=[turn, 0.0, 0.0, 0.0], time_from_start=Duration(sec=1))
    goal.trajectory.points = [point]
    return send(FollowJointTrajectory, f"/{arm}/arm_controller/follow_joint_trajectory", goal)


both = [follow("left", 0.4), follow("right", -0.3)]
until(lambda: all(each.done() for each in both))
assert [each.result().result.error_code for each in both] == [0, 0]
grip = GripperCommand.Goal()
grip.command.position = 0.019
gripped = send(GripperCommand, "/right/gripper_controller/gripper_cmd", grip)
until(gripped.done)
assert gripped.result().result.reached_goal
goal = MoveGroup.Goal()
goal.request.group_name = "arms"
goal.request.allowed_planning_time = 5.0
positions = {"left_joint1": 0.1, "right_joint1": 0.2}
constraints = [JointConstraint(joint_name=n, position=p) for n, p in positions.items()]
goal.request.goal_constraints = [Constraints(joint_constraints=constraints)]
planned = send(MoveGroup, "/move_action", goal)
until(planned.done)
assert planned.result().result.error_code.val == 1
assert [states[arm][-1].name[0] for arm in states] == [*positions]
until(lambda: abs(states["right"][-1].position[0] - 0.2) < 0.01)
