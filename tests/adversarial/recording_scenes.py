"""Recordings that lie: one run as a student's recorder saw it, and what was done to it."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from harness.core.pose_arrays import relative
from harness.plugins.grading.bag.content import BagTopics
from harness.plugins.grading.grade import grade_bag
from harness.recording.link_poses import replayed_link_poses
from harness.recording.read_run import read_run
from tests.plugins.grading.recordings import (
    GAZEBO_STARTED,
    POSES,
    Recording,
    joint_state,
    students_recording,
    transform,
)
from tests.running import run_case

SCENARIO = """
scenario: an arm turns next to a box
robot: {model: open_manipulator_x, base: {xyz: [0, 0, 0.01]}}
world: empty
objects:
  - {name: red_box, box: {size: [0.04, 0.04, 0.04]}, pose: {xyz: [0.3, -0.2, 0.0199]}}
  - {name: blue_box, box: {size: [0.04, 0.04, 0.04]}, pose: {xyz: [0.3, -0.26, 0.0199]}}
steps:
  - {wait: 1 s, id: before}
  - {move_to: {joints: {joint1: 0.6, joint2: 0, joint3: 0, joint4: 0}}, id: swing}
  - {wait: 2 s, id: after}
expect:
"""
GAZEBO = BagTopics(objects=(POSES,))
ARRIVED = "joints: {positions: {joint1: 0.6}}"
ALWAYS_LOW = "formula: always abs(position(joint1)) < 1"
BOX_STANDS = "always: {upright: red_box}"
BOX_LOW = "formula: always z(red_box) < 3 cm"
BOX_MOVED = "displaced: {object: red_box, at_least: 5 cm}"


def arm_positions(recording, name="joint1"):
    """Every recorded position of a joint, in the order of the messages."""
    states = (message.content for message in recording.of("/joint_states"))
    return [s["position"][s["name"].index(name)] for s in states if name in s["name"]]


def box_poses(recording):
    """Every recorded place of the box, shape (n, 3)."""
    moved = [each for m in recording.of(POSES) for each in m.content["transforms"]]
    places = [each["transform"]["translation"] for each in moved if named(each, "red_box")]
    return np.array([[place[axis] for axis in "xyz"] for place in places])


def named(pose, name):
    """Whether a recorded pose is that of an object."""
    return pose["child_frame_id"] == name


def box_moved(recording):
    """The last recorded place of the box is 5 cm from the first, or more."""
    places = box_poses(recording)
    return bool(np.linalg.norm(places[-1] - places[0]) >= 0.05)


def without(topic, first, last, names=()):
    """Drop the messages of a topic between two times; only those that name something."""

    def change(recording, _run):
        def is_kept(message):
            inside = first < message.stamp - GAZEBO_STARTED < last
            is_named = not names or set(names) & set(message.content.get("name", ()))
            return message.topic != topic or not (inside and is_named)

        return Recording([message for message in recording.messages if is_kept(message)])

    return change


def jumped(recording, _run):
    """The clock is set an hour ahead after 1.5 s."""
    for message in recording.messages:
        if message.stamp - GAZEBO_STARTED > 1.5:
            message.stamp += 3600
    return recording


def second_publisher(recording, run):
    """A forgotten node goes on publishing the joints as they were at the start."""
    columns = {joint.name: index for index, joint in enumerate(run.robot.movable_joints)}
    arm = {name: columns[name] for name in run.robot.arm_joints}
    end = float(run.signals.times[-1])
    still = joint_state(run.signals, 0, arm)
    for time in np.arange(0.51, end - 0.1, 0.02):
        recording.add("/joint_states", "sensor_msgs/msg/JointState", float(time), still)
    return recording


def second_box(recording, run):
    """Two programs publish the box at two places."""
    end = float(run.signals.times[-1])
    there = transform("", "red_box", [0.3, 0.2, 0.02, 1, 0, 0, 0])
    for time in np.arange(1.01, end - 0.1, 0.02):
        recording.add(POSES, "tf2_msgs/msg/TFMessage", float(time), {"transforms": [there]})
    return recording


def frames_of(late):
    """/tf shows the first joint as it was some seconds ago."""

    def change(recording, run):
        joint = run.robot.joint_by_name["joint1"]
        names = {joint.parent, joint.child}
        poses = replayed_link_poses(run.robot, run.signals.joint_positions, names)
        count, end = len(run.signals.times), float(run.signals.times[-1])
        parent, child = (
            np.broadcast_to(poses[name], (count, 7)) for name in (joint.parent, joint.child)
        )
        edges = relative(parent, child)
        for time in np.arange(0.6, end, 0.02):
            row = int(np.searchsorted(run.signals.times, time - late))
            content = {"transforms": [transform(joint.parent, joint.child, edges[row])]}
            recording.add("/tf", "tf2_msgs/msg/TFMessage", float(time), content)
        return recording

    return change


def in_map(recording, _run):
    """The box's poses are in a frame that nothing connects to the world."""
    for message in recording.of(POSES):
        for each in message.content["transforms"]:
            each["header"]["frame_id"] = "my_map"
    return recording


def chosen_steps(recording, run):
    """The student's node says that the swing began when the arm was there."""
    end = float(run.signals.times[-1])
    for time, step in ((0.1, "before"), (end - 1, "swing")):
        content = {"data": json.dumps({"event": "step_started", "step": step})}
        recording.add("/armharness/events", "std_msgs/msg/String", time, content)
    return recording


def twice_as_fast(recording, _run):
    """The simulated clock ran at half speed."""
    for message in recording.messages:
        message.stamp = GAZEBO_STARTED + (message.stamp - GAZEBO_STARTED) / 2
    return recording


def second_arm(recording, _run):
    """The arm stood still; another one, with joints of the same names, has its own topic."""
    for message in list(recording.of("/joint_states")):
        time, state = message.stamp - GAZEBO_STARTED, message.content
        recording.add("/arm_b/joint_states", "sensor_msgs/msg/JointState", time, dict(state))
        still = {key: [0.0] * len(state[key]) for key in ("position", "velocity") if key in state}
        message.content = {**state, **still}
    return recording


def any_arm_arrived(recording):
    """Some message of joint states is at the goal, whatever its topic."""
    states = (m.content for m in recording.messages if "joint1" in m.content.get("name", ()))
    return any(abs(s["position"][s["name"].index("joint1")] - 0.6) < 0.01 for s in states)


def stuck_positions(recording, _run):
    """A driver repeats positions from 1.4 s on, and goes on reporting velocities."""
    last = []
    for message in recording.of("/joint_states"):
        if "joint1" in message.content["name"]:
            last = message.content["position"] if message.stamp < GAZEBO_STARTED + 1.4 else last
            message.content["position"] = last
    return recording


def exchanged_names(recording, _run):
    """From 1.4 s on the first two joints have each other's names."""
    other = {"joint1": "joint2", "joint2": "joint1"}
    for message in recording.of("/joint_states"):
        if message.stamp > GAZEBO_STARTED + 1.4:
            message.content["name"] = [other.get(each, each) for each in message.content["name"]]
    return recording


def renamed(names, first=0.0):
    """From some time on objects have other names."""

    def change(recording, _run):
        for message in recording.of(POSES):
            if message.stamp >= GAZEBO_STARTED + first:
                for each in message.content["transforms"]:
                    each["child_frame_id"] = names.get(
                        each["child_frame_id"], each["child_frame_id"]
                    )
        return recording

    return change


def boxes_after(first, place):
    """From some time on the red box is elsewhere: at a function of the time since then."""

    def change(recording, run):
        for message in recording.of(POSES):
            since = message.stamp - GAZEBO_STARTED - first
            for each in message.content["transforms"]:
                if since > 0 and named(each, "red_box"):
                    xyz = place(since, run)
                    each["transform"]["translation"] = dict(zip("xyz", xyz, strict=True))
        return recording

    return change


def with_the_hand(since, run):
    """As far from the hand as when that began, at every moment."""
    rows = np.searchsorted(run.signals.times, (1.0, 1.0 + since))
    start, now = run.signals.tcp_pose[rows.clip(max=len(run.signals.times) - 1), :3]
    return (np.array([0.3, -0.2, 0.0199]) + now - start).tolist()


def slid(since, _run):
    """8 cm within 0.4 s, evenly: an arm pushed it."""
    return [0.3 + 0.08 * min(since / 0.4, 1.0), -0.2, 0.0199]


def smoothed_velocities(recording, _run):
    """Velocities are those of 40 ms before, as a filter makes them."""
    states = [m for m in recording.of("/joint_states") if "joint1" in m.content["name"]]
    velocities = [message.content["velocity"] for message in states]
    for message, late in zip(states[2:], velocities, strict=False):
        message.content["velocity"] = late
    return recording


def hop_between_joint_states(recording, run):
    """Joint states at 5 Hz, and a hop of 6 cm between two of them."""

    def place(since, _):
        return [0.3, -0.2, 0.0199 + max(0.0, 4.9 * since * (0.18 - since))]

    slow = [m for m in recording.of("/joint_states") if fifth_of_second(m) < 0.03]
    for message in boxes_after(1.01, place)(recording.without("/joint_states"), run).of(POSES):
        slow.append(message)
    return Recording(sorted(slow, key=lambda message: message.logged))


def fifth_of_second(message):
    """Time since the last full fifth of a second [s]."""
    return (message.stamp - GAZEBO_STARTED + 1e-6) % 0.2


def is_low_at_joint_states(recording):
    """At every time with joint states the box is lower than 3 cm."""
    states = {round(message.stamp, 3) for message in recording.of("/joint_states")}
    moved = (m for m in recording.of(POSES) if round(m.stamp, 3) in states)
    places = (p["transform"]["translation"] for m in moved for p in m.content["transforms"])
    return all(place["z"] < 0.03 for place in places)


def once_a_second(change):
    """Poses at 1 Hz, changed before."""

    def thinned(recording, run):
        changed = change(recording, run)
        kept = [m for m in changed.messages if m.topic != POSES or full_second(m) < 0.01]
        return Recording(kept)

    return thinned


def full_second(message):
    """Time since the last full second [s]."""
    return (message.stamp - GAZEBO_STARTED + 1e-6) % 1.0


def zero_velocities(recording, _run):
    """The driver does not measure velocities."""
    for message in recording.of("/joint_states"):
        message.content["velocity"] = [0.0] * len(message.content["name"])
    return recording


def no_velocities(recording):
    """The largest recorded velocity is 0."""
    return not any(any(message.content["velocity"]) for message in recording.of("/joint_states"))


def arm_put_elsewhere(recording, _run):
    """The arm stands still, and from 1.4 s on it is at the goal."""
    for message in recording.of("/joint_states"):
        names, late = message.content["name"], message.stamp > GAZEBO_STARTED + 1.4
        if "joint1" in names:
            message.content["position"][names.index("joint1")] = 0.6 if late else 0.0
        message.content["velocity"] = []
    return recording


def lying_in(is_lying):
    """In some messages the box lies on its side."""

    def change(recording, _run):
        for number, message in enumerate(recording.of(POSES)):
            for each in message.content["transforms"]:
                if named(each, "red_box") and is_lying(number):
                    each["transform"]["rotation"] = {"x": 0.5**0.5, "y": 0, "z": 0, "w": 0.5**0.5}
        return recording

    return change


def tipped_over(recording, _run):
    """Within 0.14 s, from 1.4 s on, the box tips over."""
    for message in recording.of(POSES):
        angle = float(np.clip((message.stamp - GAZEBO_STARTED - 1.4) / 0.14, 0, 1)) * np.pi / 2
        for each in message.content["transforms"]:
            if named(each, "red_box"):
                half = {"x": np.sin(angle / 2), "y": 0.0, "z": 0.0, "w": np.cos(angle / 2)}
                each["transform"]["rotation"] = half
    return recording


def other_topic(topic, parent, pose):
    """Another topic has one more pose of the red box in each of its messages."""

    def change(recording, _run):
        poses = recording.of(POSES)
        for message in poses if topic == "/tf" else poses[:1]:
            time = message.stamp - GAZEBO_STARTED
            content = {"transforms": [transform(parent, "red_box", pose)]}
            recording.add(topic, "tf2_msgs/msg/TFMessage", time, content)
        return recording

    return change


def glued_by_tf_static(recording, run):
    """Nothing but /tf_static says where the red box is: 10 cm from the hand."""
    other_topic("/tf_static", run.robot.tcp_link, [0.1, 0, 0, 1, 0, 0, 0])(recording, run)
    return renamed({"red_box": "crate"})(recording, run)


@dataclass(frozen=True)
class RecordingScene:
    """A damaged recording.

    Attributes:
        title: What the recording is.
        happens: What was done to it.
        change: Makes it from a whole recording and the run.
        naive: The check as it is often written, in words.
        says: The naive check, on the recording.
        expect: Expectation -> `not observable`, or the doubt that withholds its points.
        stays: Expectations that earn their points.
        is_idle: Whether the robot did not move, so that nothing that holds earns points.
    """

    title: str
    happens: str
    change: Callable
    naive: str
    says: Callable
    expect: dict[str, str]
    stays: tuple[str, ...] = ()
    is_idle: bool = False


IN_RANGE = "every recorded position of the joint is in range"
IS_ELSEWHERE = "the box is recorded 5 cm from its start"
EXCHANGED = {"red_box": "blue_box", "blue_box": "red_box"}


def in_range(recording):
    return all(abs(position) < 1 for position in arm_positions(recording))


RECORDINGS = (
    RecordingScene(
        "joint states of another arm",
        "the arm stood still; another arm's topic, in another namespace, has joints of these names",
        second_arm,
        "some recorded joint states are at the goal",
        any_arm_arrived,
        {ARRIVED: "failed"},
        (ALWAYS_LOW, BOX_STANDS),
        is_idle=True,
    ),
    RecordingScene(
        "hole of 0.6 s in the joint states", "the messages of the swing are missing",
        without("/joint_states", 1.1, 1.7), IN_RANGE, in_range,
        {ALWAYS_LOW: "not observable"}, (ARRIVED, BOX_STANDS),
    ),
    RecordingScene(
        "hole of 2 s in the poses of the box", "its topic is silent for two seconds",
        without(POSES, 1.0, 3.0), "every recorded pose is upright",
        lambda recording: len(box_poses(recording)) > 10,
        {BOX_STANDS: "not observable"}, (ARRIVED, ALWAYS_LOW, "upright: red_box"),
    ),
    RecordingScene(
        "clock that jumps an hour ahead", "all stamps after 1.5 s are an hour later", jumped,
        IN_RANGE, in_range,
        {ALWAYS_LOW: "not observable", BOX_STANDS: "not observable"}, (ARRIVED,),
    ),
    RecordingScene(
        "joint states that fall silent", "the last second has poses of the box alone",
        without("/joint_states", 2.5, 1e9), "the last message shows the joint at its goal",
        lambda recording: abs(arm_positions(recording)[-1] - 0.6) < 0.05,
        {ARRIVED: "not observable", ALWAYS_LOW: "not observable"}, (BOX_STANDS,),
    ),
    RecordingScene(
        "two publishers of the joint states",
        "a forgotten node publishes the joints as they were at the start", second_publisher,
        IN_RANGE, in_range, {ALWAYS_LOW: "publishers", BOX_STANDS: "publishers"},
    ),
    RecordingScene(
        "two publishers of the box", "every other pose puts it 40 cm away", second_box,
        "every recorded pose is upright", lambda recording: len(box_poses(recording)) > 10,
        {BOX_STANDS: "publishers"}, (ARRIVED, ALWAYS_LOW),
    ),
    RecordingScene(
        "/tf that contradicts the joint states", "/tf shows the arm as it was half a second ago",
        frames_of(0.5), IN_RANGE, in_range, {ALWAYS_LOW: "tf", ARRIVED: "tf"},
    ),
    RecordingScene(
        "/tf that is 20 ms late", "as a publisher of frames is", frames_of(0.02),
        IN_RANGE, in_range, {}, (ALWAYS_LOW, ARRIVED, BOX_STANDS),
    ),
    RecordingScene(
        "poses in a frame of nowhere", "the box's poses are in `my_map`, which has no parent",
        in_map, "every recorded pose is upright",
        lambda recording: len(box_poses(recording)) > 10,
        {BOX_STANDS: "frames"}, (ARRIVED, ALWAYS_LOW),
    ),
    RecordingScene(
        "steps that the student chose", "the recorded node says that the swing began at its end",
        chosen_steps, "during the step that it names the joint stays at its goal",
        lambda recording: abs(arm_positions(recording)[-1] - 0.6) < 0.05,
        {f"{{always: {{{ARRIVED}}}, during: swing}}": "steps"}, (ARRIVED, BOX_STANDS),
    ),
    RecordingScene(
        "clock at half speed", "every stamp is half as far from the first one", twice_as_fast,
        IN_RANGE, in_range, {"duration: {at_most: 2 s}": "velocities", ARRIVED: "velocities"},
    ),
    RecordingScene(
        "positions that repeat", "from 1.4 s on the driver repeats the joints' positions",
        stuck_positions, IN_RANGE, in_range, {ALWAYS_LOW: "velocities"},
    ),
    RecordingScene(
        "joints exchanged on the way", "from 1.4 s on two joints have each other's names",
        exchanged_names, IN_RANGE, in_range, {ALWAYS_LOW: "jumps", BOX_STANDS: "jumps"},
    ),
    RecordingScene(
        "boxes exchanged on the way", "from 1.4 s on two boxes have each other's names",
        renamed(EXCHANGED, 1.4), IS_ELSEWHERE, box_moved,
        {BOX_MOVED: "jumps", BOX_STANDS: "jumps"}, (ARRIVED, ALWAYS_LOW),
    ),
    RecordingScene(
        "boxes exchanged there and back", "for 0.4 s two boxes have each other's names",
        lambda whole, run: renamed(EXCHANGED, 1.8)(renamed(EXCHANGED, 1.4)(whole, run), run),
        "every recorded pose is upright", lambda recording: len(box_poses(recording)) > 10,
        {BOX_STANDS: "jumps"}, (ARRIVED, ALWAYS_LOW),
    ),
    RecordingScene(
        "box put elsewhere by a program", "from 1.4 s on the box is 8 cm aside",
        boxes_after(1.4, lambda *_: [0.38, -0.2, 0.0199]), IS_ELSEWHERE, box_moved,
        {BOX_MOVED: "jumps"}, (ARRIVED, ALWAYS_LOW, "upright: blue_box"),
    ),
    RecordingScene(
        "box that slides 8 cm", "an arm pushes it at 20 cm/s", boxes_after(1.4, slid),
        "it moves by more than 2 cm between messages that are 0.1 s apart: too strict", box_moved,
        {}, (BOX_MOVED, BOX_STANDS, ARRIVED),
    ),
    RecordingScene(
        "box glued to the hand", "from 1 s on the box follows the hand, 10 cm away from it",
        boxes_after(1.0, with_the_hand), "it moves with the hand and is as far from it as before",
        box_moved,
        {"grasped: red_box": "not observable",
         "lifted: {object: red_box, above: 1 cm}": "not observable"},
        (BOX_MOVED, ARRIVED, ALWAYS_LOW),
    ),
    RecordingScene(
        "box that was seen once", "a camera's node publishes the red box at the start alone",
        without(POSES, 0.01, 1e9), "every recorded pose is upright",
        lambda recording: len(box_poses(recording)) == 1,
        {BOX_STANDS: "once", "static: red_box": "once"}, (ARRIVED, ALWAYS_LOW),
    ),
    RecordingScene(
        "box by another name", "the recorder calls the red box `crate`",
        renamed({"red_box": "crate"}), "no recorded pose of the box is tilted",
        lambda recording: len(box_poses(recording)) == 0,
        {BOX_STANDS: "not observable", BOX_MOVED: "not observable"},
        (ARRIVED, "always: {upright: blue_box}"),
    ),
    RecordingScene(
        "velocities that come 40 ms late", "a filter smooths them", smoothed_velocities,
        IN_RANGE, in_range, {}, (ALWAYS_LOW, ARRIVED, BOX_STANDS),
    ),
    RecordingScene(
        "four lost messages", "80 ms of joint states are missing: less than ten periods",
        without("/joint_states", 1.2, 1.28), IN_RANGE, in_range,
        {}, (ALWAYS_LOW, ARRIVED, BOX_STANDS),
    ),
    RecordingScene(
        "hop between two joint states", "the box hops 4 cm high, and joint states come at 5 Hz",
        hop_between_joint_states, "at every joint state the box is low", is_low_at_joint_states,
        {BOX_LOW: "failed", "always: {static: red_box}": "failed"}, (BOX_STANDS,),
    ),
    RecordingScene(
        "box that is seen once a second", "between two of its poses it goes 8 cm aside",
        once_a_second(boxes_after(1.5, lambda *_: [0.38, -0.2, 0.0199])),
        "half way between two poses it is 4 cm aside",
        lambda recording: 0.3 < np.mean(box_poses(recording)[:, 0]) < 0.38,
        {"formula: eventually abs(x(red_box) - 34 cm) < 1 cm": "not observable",
         BOX_STANDS: "not observable"},
        (BOX_MOVED, ARRIVED),
    ),
    RecordingScene(
        "box that stands and is seen once a second", "all of its poses are the same",
        once_a_second(lambda recording, _: recording),
        "it is known for less than 1.5 s: too strict", lambda _: True,
        {}, (BOX_STANDS, "always: {static: red_box}", ARRIVED),
    ),
    RecordingScene(
        "velocities that are all 0", "the driver fills them with zeros", zero_velocities,
        "the largest velocity is 0", no_velocities,
        {"formula: always abs(velocity(joint1)) < 0.01": "velocities", ARRIVED: "velocities"},
    ),
    RecordingScene(
        "arm put at its goal by a program", "it stands still, and from 1.4 s on it is there",
        arm_put_elsewhere, "the last position is the goal",
        lambda recording: abs(arm_positions(recording)[-1] - 0.6) < 0.05,
        {ARRIVED: "jumps", ALWAYS_LOW: "jumps"},
    ),
    RecordingScene(
        "box that flips in each message", "every other pose lies on its side",
        lying_in(lambda number: number % 2 == 1), "its place is the same in all poses",
        lambda recording: bool(np.ptp(box_poses(recording), axis=0).max() < 0.01),
        {"eventually: {upright: red_box}": "publishers"}, (ARRIVED, "upright: blue_box"),
    ),
    RecordingScene(
        "box that tips over", "within 0.14 s it is on its side", tipped_over,
        "it turns by more than 10 degrees between two messages: too strict", lambda _: True,
        {}, ("never: {displaced: red_box}", "eventually: {upright: red_box}", ARRIVED),
    ),
    RecordingScene(
        "/tf that contradicts the poses of the box", "/tf has it lying, half a metre up",
        other_topic("/tf", "world", [0.3, -0.2, 0.5, 0.5**0.5, 0.5**0.5, 0, 0]),
        "every pose in the topic of objects is upright",
        lambda recording: len(box_poses(recording)) > 10,
        {BOX_STANDS: "tf", BOX_LOW: "tf"}, (ARRIVED, ALWAYS_LOW),
    ),
    RecordingScene(
        "/tf that agrees with the poses of the box", "it has the same pose, 3 mm aside",
        other_topic("/tf", "world", [0.303, -0.2, 0.02, 1, 0, 0, 0]),
        "both topics have the same numbers: too strict", lambda _: True,
        {}, (BOX_STANDS, BOX_LOW, ARRIVED),
    ),
    RecordingScene(
        "box glued to the hand by /tf_static", "one static transform holds it next to the hand",
        glued_by_tf_static, "it has a pose in the hand's frame", lambda _: True,
        {"displaced: red_box": "once", "formula: eventually z(red_box) > 10 cm": "once"},
        (ARRIVED, ALWAYS_LOW),
    ),
)  # fmt: skip


@cache
def recorded_run(folder):
    """The run that all recordings are made of, and its scenario."""
    path = folder / "recorded.scenario.yaml"
    path.write_text(SCENARIO + f"  - {ARRIVED}\n")
    result = run_case(path, report_dir=folder / "report", stills=False, page=False)
    assert result.outcome == "passed", (result.problems, result.message)
    return read_run(folder / "report").run


def graded_scene(scene, run, folder):
    """The recording and its grade: the rows that must not earn, then those that must."""
    recording = scene.change(students_recording(run), run)
    lines = "".join(f"  - {each}\n" for each in (*scene.expect, *scene.stays))
    path = folder / "scene.scenario.yaml"
    path.write_text(SCENARIO + lines)
    return recording, grade_bag(path, recording.write(folder / "scene.mcap"), GAZEBO)
