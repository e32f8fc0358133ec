"""A robot's driver on rclpy, without physics: joint states, and follow_joint_trajectory.

With `--strays`, its feedback says after 0.3 s that the first joint is 0.5 rad off.
"""

import sys
import time

import numpy as np
import rclpy
from control_msgs.action import FollowJointTrajectory
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState

JOINTS = ["gripper_left_joint", "joint4", "joint3", "joint2", "joint1"]
rclpy.init()
node = Node("driver")
group = ReentrantCallbackGroup()
states = node.create_publisher(JointState, "/joint_states", 10)
now = dict.fromkeys(JOINTS, 0.0)


def publish():
    state = JointState(name=JOINTS, position=[now[name] for name in JOINTS])
    state.header.stamp = node.get_clock().now().to_msg()
    states.publish(state)


def execute(handle):
    trajectory = handle.request.trajectory
    times = [p.time_from_start.sec + 1e-9 * p.time_from_start.nanosec for p in trajectory.points]
    positions = np.array([point.positions for point in trajectory.points])
    begin, names = time.monotonic(), list(trajectory.joint_names)
    spent = 0.0
    while spent < times[-1]:
        spent = time.monotonic() - begin
        row = [float(np.interp(spent, times, column)) for column in positions.T]
        now.update(zip(names, row, strict=True))
        feedback = FollowJointTrajectory.Feedback(joint_names=names)
        off = 0.5 * ("--strays" in sys.argv and spent > 0.3)
        feedback.error.positions = [off] + [0.0] * (len(names) - 1)
        handle.publish_feedback(feedback)
        if handle.is_cancel_requested:
            handle.canceled()
            print("canceled", flush=True)  # noqa: T201
            return FollowJointTrajectory.Result()
        time.sleep(0.01)
    handle.succeed()
    print("executed", flush=True)  # noqa: T201
    return FollowJointTrajectory.Result()


node.create_timer(0.01, publish, callback_group=group)
ActionServer(
    node,
    FollowJointTrajectory,
    "/arm_controller/follow_joint_trajectory",
    execute,
    cancel_callback=lambda _: CancelResponse.ACCEPT,
    callback_group=group,
)
executor = MultiThreadedExecutor(3)
executor.add_node(node)
executor.spin()
