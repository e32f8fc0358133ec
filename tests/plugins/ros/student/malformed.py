"""Goals as no node should send them, and clients that die or compete; prints JSON."""

import json
import os
import signal
import socket
import subprocess
import sys

import rclpy
from builtin_interfaces.msg import Duration, Time
from control_msgs.action import FollowJointTrajectory, GripperCommand
from control_msgs.msg import JointTolerance
from rclpy.action import ActionClient
from rclpy.node import Node
from trajectory_msgs.msg import JointTrajectoryPoint

ARM = ["joint1", "joint2", "joint3", "joint4"]
END = [0.2, 0.0, 0.0, 0.0]
HUGE, NAN = 1e308, float("nan")


def duration(seconds):
    whole = int(seconds // 1)
    return Duration(sec=whole, nanosec=round((seconds - whole) * 1e9))


def point(seconds, positions=END, velocities=(), accelerations=()):
    return JointTrajectoryPoint(
        positions=list(positions),
        velocities=list(velocities),
        accelerations=list(accelerations),
        time_from_start=duration(seconds),
    )


def follow(*points, joints=ARM, stamp=None, **fields):
    goal = FollowJointTrajectory.Goal(**fields)
    goal.trajectory.joint_names, goal.trajectory.points = list(joints), list(points)
    goal.trajectory.header.stamp = stamp or Time()
    return goal


def grip(position, max_effort=0.0):
    goal = GripperCommand.Goal()
    goal.command.position, goal.command.max_effort = position, max_effort
    return goal


def tolerance(name, position):
    return [JointTolerance(name=name, position=position)]


class Client:
    def __init__(self, name):
        self.node = Node(name)
        self.arm = self._client(FollowJointTrajectory, "/arm_controller/follow_joint_trajectory")
        self.gripper = self._client(GripperCommand, "/gripper_controller/gripper_cmd")

    def _client(self, kind, name):
        client = ActionClient(self.node, kind, name)
        assert client.wait_for_server(timeout_sec=30.0)
        return client

    def wait(self, future):
        rclpy.spin_until_future_complete(self.node, future, timeout_sec=60.0)
        assert future.done()
        return future.result()

    def send(self, goal, client=None):
        return self.wait((client or self.arm).send_goal_async(goal))

    def answer(self, handle):
        """Whether a goal was accepted, its status, and the error code or what was reached."""
        ended = self.wait(handle.get_result_async())
        result = ended.result
        code = getattr(result, "error_code", None)
        return [handle.accepted, ended.status, result.reached_goal if code is None else code]


rclpy.init()
if sys.argv[1:] == ["dying"]:
    client = Client("dying")
    assert client.send(follow(point(3.0))).accepted
    os.kill(os.getpid(), signal.SIGKILL)

first = Client("first")
many = [point(1e-4 * number, [0.1, 0.0, 0.0, 0.0]) for number in range(1, 10_001)]
goals = {
    "not a number": follow(point(0.5, [NAN, 0.0, 0.0, 0.0])),
    "infinite": follow(point(0.5, [0.0, float("inf"), 0.0, 0.0])),
    "a joint twice": follow(point(0.5), joints=["joint1", "joint1", "joint3", "joint4"]),
    "five names": follow(point(0.5, [*END, 0.2]), joints=[*ARM, "joint1"]),
    "empty": FollowJointTrajectory.Goal(),
    "no positions": follow(point(0.5, [])),
    "before the start": follow(point(-1.0), point(0.5)),
    "falling": follow(point(0.5), point(0.2)),
    "velocities of three": follow(point(0.5, END, [0.0] * 3)),
    "velocities at one point": follow(point(0.5, END, [0.0] * 4), point(0.6)),
    "accelerations of five": follow(point(0.5, END, [0.0] * 4, [0.0] * 5)),
    "velocities not a number": follow(point(0.3, END, [NAN] * 4), point(0.5, END, [0.0] * 4)),
    "huge velocities": follow(point(0.3, END, [HUGE] * 4), point(0.5, END, [0.0] * 4)),
    "huge accelerations": follow(point(0.5, END, [0.0] * 4, [HUGE] * 4)),
    "tolerance of an unknown joint": follow(point(0.5), goal_tolerance=tolerance("elbow", 0.1)),
    "tolerance not a number": follow(point(0.5), path_tolerance=tolerance("joint1", NAN)),
    "stamp of the last century": follow(point(0.1), stamp=Time(sec=-(2**31), nanosec=1)),
    "stamp of the next century": follow(point(0.1), stamp=Time(sec=2**31 - 1, nanosec=2**32 - 1)),
    "nanoseconds beyond a second": follow(
        JointTrajectoryPoint(positions=END, time_from_start=Duration(nanosec=2**32 - 1))
    ),
    "goal time before the end": follow(point(0.5), goal_time_tolerance=duration(-5.0)),
    "at once": follow(JointTrajectoryPoint(positions=END, time_from_start=Duration(nanosec=1))),
    "ten thousand points": follow(*many),
    "a good one": follow(point(0.5)),
}
said = {name: first.answer(first.send(goal)) for name, goal in goals.items()}
grips = {
    "grip not a number": grip(NAN),
    "grip infinite": grip(float("-inf")),
    "effort not a number": grip(0.0, NAN),
    "effort below zero": grip(0.0, -1.0),
    "effort infinite": grip(0.0, float("inf")),
    "grip too wide": grip(1.0),
    "a good grip": grip(0.01, HUGE),
}
for name, goal in grips.items():
    said[name] = first.answer(first.send(goal, first.gripper))

# garbage on every port that a participant of this domain may have
domain = int(os.environ["ROS_DOMAIN_ID"])
with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
    for port in range(7400 + 250 * domain, 7430 + 250 * domain):
        for size in range(0, 300, 7):
            out.sendto(b"RTPS\2\3" + os.urandom(size), ("127.0.0.1", port))
            out.sendto(os.urandom(size), ("127.0.0.1", port))

died = subprocess.run([sys.executable, __file__, "dying"], check=False)
said["died"] = died.returncode
second = Client("second")
mine = first.send(follow(point(5.0)))
theirs = second.send(follow(point(0.3)))
said["replaced"], said["newer"] = first.answer(mine), second.answer(theirs)
sys.stdout.write(json.dumps(said) + "\n")
