"""Recordings made by hand: joints and the pose of a box as functions of time, at any rates."""

import numpy as np

from harness.plugins.grading.bag.content import BagTopics
from harness.plugins.grading.grade import grade_bag
from tests.plugins.grading.recordings import Recording, header, transform

SCENARIO = """
scenario: a box next to an arm
robot: open_manipulator_x
world: empty
objects:
  - {name: box, box: {size: [0.04, 0.04, 0.04]}, pose: {xyz: [0.3, -0.2, 0.0199]}, mass: 0.1}
steps:
  - wait: 1 s
expect:
"""
POSES = "/poses"
JOINTS = ("joint1", "joint2", "joint3", "joint4", "gripper_left_joint")
FRAMES = "tf2_msgs/msg/TFMessage"


def box_pose(x=0.3, y=-0.2, z=0.02, tilt=0.0):
    """A pose that leans about x [m, rad]."""
    return [x, y, z, np.cos(tilt / 2), np.sin(tilt / 2), 0.0, 0.0]


def state(position, velocity=None):
    """Joint states of which the first joint alone moves."""
    rest = [0.0] * (len(JOINTS) - 1)
    return {
        "header": header(),
        "name": list(JOINTS),
        "position": [float(position), *rest],
        "velocity": [] if velocity is None else [float(velocity), *rest],
        "effort": [],
    }


def times(rate, first=0.0, last=3.0):
    """Of messages at a rate [s]."""
    return first + np.arange(round((last - first) * rate) + 1) / rate


def slow(time):
    """A joint that moves a little, as a robot that stands still earns nothing."""
    return 0.005 * time


def add_joints(recording, at, position=slow, velocity=None):
    """Joint states at some times."""
    for time in at:
        said = state(position(time), None if velocity is None else velocity(time))
        recording.add("/joint_states", "sensor_msgs/msg/JointState", float(time), said)
    return recording


def add_box(recording, at, pose, topic=POSES, parent="world", name="box"):
    """Poses of the box at some times."""
    for time in at:
        content = {"transforms": [transform(parent, name, pose(time))]}
        recording.add(topic, FRAMES, float(time), content)
    return recording


def recorded(pose=lambda _: box_pose(), joints=50, box=50, position=slow, velocity=None):
    """Joint states and poses of three seconds at two rates [Hz]."""
    recording = add_joints(Recording(), times(joints), position, velocity)
    return add_box(recording, times(box), pose)


def grade(recording, folder, *lines, topics=None, allowed=(), scenario=SCENARIO):
    """The grade of a recording by some expectations."""
    file = folder / "made.scenario.yaml"
    file.write_text(scenario + "".join(f"  - {line}\n" for line in lines))
    recording.messages.sort(key=lambda message: message.logged)
    topics = BagTopics(objects=(POSES,)) if topics is None else topics
    return grade_bag(file, recording.write(folder / "made.mcap"), topics, allowed=allowed)


def statuses(found):
    """The status of each expectation."""
    return [row.verdict.status for row in found.rows]


def outcomes(found):
    """The doubts that withhold the points of each expectation, or else its status."""
    return [" ".join(row.withheld) or row.verdict.status for row in found.rows]
