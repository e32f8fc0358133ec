"""Feedback, cancellation, preemption, images and the clock, as rclpy sees them; prints JSON."""

import json
import sys
import threading
import time

import rclpy
from builtin_interfaces.msg import Duration
from control_msgs.action import FollowJointTrajectory
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectoryPoint

CAMERA = "/gripper_camera"
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
rclpy.init()
node = Node("student")
seen = {}
for kind, topic, qos in (
    (Image, f"{CAMERA}/image", 10),
    (CompressedImage, f"{CAMERA}/image/compressed", 10),
    (CameraInfo, f"{CAMERA}/camera_info", 10),
    (CameraInfo, f"{CAMERA}/image/camera_info", 10),
    (Clock, "/clock", 10),
    (String, "/robot_description", LATCHED),
):
    messages = seen.setdefault(topic, [])
    node.create_subscription(kind, topic, messages.append, qos)
client = ActionClient(node, FollowJointTrajectory, "/arm_controller/follow_joint_trajectory")
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()


def until(holds, seconds=30.0):
    end = time.monotonic() + seconds
    while not holds() and time.monotonic() < end:
        time.sleep(0.002)
    assert holds()


def goal(seconds, *positions):
    sent = FollowJointTrajectory.Goal()
    sent.trajectory.joint_names = ["joint1", "joint2", "joint3", "joint4"]
    whole = int(seconds)
    sent.trajectory.points = [
        JointTrajectoryPoint(
            positions=list(positions),
            velocities=[0.0] * 4,
            time_from_start=Duration(sec=whole, nanosec=int((seconds - whole) * 1e9)),
        )
    ]
    return sent


def send(sent, feedback=None):
    future = client.send_goal_async(sent, feedback_callback=feedback)
    until(future.done)
    return future.result()


def result(handle):
    future = handle.get_result_async()
    until(future.done)
    return future.result().status, future.result().result.error_code


until(client.server_is_ready)
said, feedback = {}, []
said["done"] = result(send(goal(1.0, 0.2, 0.0, 0.0, 0.0), feedback.append))
said["feedback"] = [len(feedback), list(feedback[0].feedback.joint_names)]
beyond = send(goal(1.0, 9.0, 0.0, 0.0, 0.0))
said["beyond"] = [beyond.accepted, *result(beyond)]
first, second = send(goal(9.0, 0.0, 0.0, 0.0, 0.0)), send(goal(9.0, 0.1, 0.0, 0.0, 0.0))
said["preempted"] = result(first)
future = second.cancel_goal_async()
until(future.done)
said["cancel"] = [future.result().return_code, len(future.result().goals_canceling)]
said["canceled"] = result(second)
until(lambda: all(seen.values()))
picture = seen[f"{CAMERA}/image"][0]
said["image"] = [picture.width, picture.height, picture.encoding, len(picture.data)]
said["nodes"] = sorted(node.get_node_names())
sys.stdout.write(json.dumps(said) + "\n")
