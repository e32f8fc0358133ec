"""A student's node without ROS: opens the gripper, reaches for the red box, closes, and lifts."""

import os
import sys
import time

from tests.plugins.ros.nodes import Node, follow, grip, point

node = Node(int(os.environ["ROS_DOMAIN_ID"]))
node.ready()
if "--crash" in sys.argv:
    raise SystemExit("no idea how this works")
assert node.send(grip(0.019), node.gripper).result.reached_goal
assert node.send(follow(point(2, [0.0, 0.87, -0.195, -0.67]))).result.error_code == 0
assert node.send(grip(-0.005), node.gripper).result.stalled
assert node.send(follow(point(2, [0.0, 0.2, -0.195, 0.0]))).result.error_code == 0
node.graph.spin(time.monotonic() + 30)
