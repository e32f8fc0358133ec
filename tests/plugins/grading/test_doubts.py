"""What a recording says of itself that cannot be, and what is no reason to doubt it."""

import json

import numpy as np
import pytest

from harness.plugins.grading.bag.content import BagTopics
from tests.plugins.grading.hand_made import (
    FRAMES,
    POSES,
    SCENARIO,
    add_box,
    add_joints,
    box_pose,
    grade,
    outcomes,
    recorded,
    statuses,
    times,
)
from tests.plugins.grading.recordings import Recording, transform

STANDS, IN_RANGE = "always: {upright: box}", "formula: always abs(position(joint1)) < 1"
AT_END, SLOW = "upright: box", "formula: always abs(velocity(joint1)) < 0.01"
STILL = "joints: {positions: {joint2: 0}}"


def ramp(speed, first=1.0, last=2.0):
    """A position that rises evenly between two times."""
    return lambda time: speed * (np.clip(time, first, last) - first)


# -- velocities that are filled with zeros --------------------------------------------------------


def zero(_):
    return 0.0


@pytest.mark.parametrize(
    "position",
    [ramp(0.4), ramp(0.03, 0, 3), lambda t: 0.2 * (t > 2), lambda t: 0.1 * np.sin(9 * t)],
    ids=["a motion", "a slow motion", "a jump", "to and fro"],
)
def test_zeros_are_no_velocities_of_a_joint_that_moves(position, tmp_path):
    filled = recorded(position=position, velocity=zero)
    found = grade(filled, tmp_path, "within_limits: {effort: false}", SLOW, IN_RANGE)
    assert statuses(found) == ["not observable", "not observable", "passed"]
    assert "velocities" in found.rows[-1].withheld
    note = "joint1 moves, and its velocities are all 0: they count as not recorded"
    assert note in found.notes
    allowed = grade(filled, tmp_path, SLOW, IN_RANGE, allowed=["velocities", "jumps"])
    assert outcomes(allowed) == ["not observable", "passed"]


@pytest.mark.parametrize(
    "position",
    [zero, lambda t: 0.001 * np.sin(40 * t), ramp(0.01, 0, 3)],
    ids=["at rest", "noise", "creep below the resolution"],
)
def test_zeros_are_velocities_of_a_joint_that_stands_still(position, tmp_path):
    found = grade(recorded(position=position, velocity=zero), tmp_path, SLOW, IN_RANGE)
    assert outcomes(found) == ["passed", "passed"]
    assert found.notes == ()


def test_true_velocities_are_believed(tmp_path):
    true = recorded(position=ramp(0.4), velocity=lambda t: 0.4 * (1 < t <= 2))
    assert outcomes(grade(true, tmp_path, SLOW, IN_RANGE)) == ["failed", "passed"]


# -- single jumps ---------------------------------------------------------------------------------


@pytest.mark.parametrize("at", [0.02, 1.0, 3.0])
def test_a_joint_that_jumps_once_is_doubted(at, tmp_path):
    jumps = recorded(position=lambda t: 0.6 * (t >= at - 1e-9))
    found = grade(jumps, tmp_path, IN_RANGE, STANDS)
    assert outcomes(found) == ["jumps", "jumps"]
    assert "joint1 jumps by 34 deg at t=" in found.notes[0]
    assert outcomes(grade(jumps, tmp_path, IN_RANGE, allowed=["jumps"])) == ["passed"]


@pytest.mark.parametrize(
    "position",
    [
        lambda t: np.degrees(ramp(0.6)(t)),
        lambda _: -40.0,
        lambda t: 20.0 + 10 * np.sin(6 * t),
    ],
    ids=["a motion", "at rest", "there and back"],
)
def test_a_joint_whose_positions_are_in_degrees_is_said_to_be(position, tmp_path):
    found = grade(recorded(position=position), tmp_path, IN_RANGE, STANDS)
    assert outcomes(found) == ["jumps", "jumps"]
    assert "these look like degrees, and JointState has radians" in found.notes[0]


def test_a_joint_that_is_a_turn_off_is_not_in_degrees(tmp_path):
    found = grade(recorded(position=lambda _: 2 * np.pi + 0.1), tmp_path, IN_RANGE, STANDS)
    assert "degrees" not in "".join(found.notes)


def test_a_motion_at_the_limit_in_messages_that_come_late_is_no_jump(tmp_path):
    """4.8 rad/s, and three messages of 60 ms arrive with nearly the same stamp."""
    fast = recorded(position=ramp(4.8, 1.0, 1.15))
    for message in fast.of("/joint_states"):
        since = message.stamp - 123.4
        if 1.0 < since < 1.055:
            message.stamp = 123.4 + 1.055 + 1e-3 * since
    assert outcomes(grade(fast, tmp_path, IN_RANGE, STANDS)) == ["passed", "passed"]


def test_a_hole_while_the_joint_moves_is_no_jump(tmp_path):
    moving = recorded(position=ramp(0.6))
    moving.messages = [
        m for m in moving.messages if m.topic == POSES or not 1.1 < m.stamp - 123.4 < 1.9
    ]
    assert outcomes(grade(moving, tmp_path, "joints: {positions: {joint1: 0.6}}", STANDS)) == [
        "passed",
        "passed",
    ]


# -- turns ----------------------------------------------------------------------------------------


def lying_at(is_lying):
    return lambda time: box_pose(tilt=np.pi / 2 if is_lying(time) else 0.0)


@pytest.mark.parametrize("rate", [10, 20, 50, 250])
def test_a_box_that_flips_in_each_message_has_two_publishers(rate, tmp_path):
    flips = recorded(lying_at(lambda t: round(t * rate) % 2), box=rate)
    assert outcomes(grade(flips, tmp_path, AT_END, IN_RANGE)) == ["publishers", "passed"]


@pytest.mark.parametrize(
    "is_lying",
    [lambda t: t < 2.97, lambda t: 1.0 < t < 1.03, lambda t: t < 1.5],
    ids=["upright in the last message", "one wrong message", "half of the time"],
)
def test_a_box_that_turns_at_once_is_doubted(is_lying, tmp_path):
    found = grade(recorded(lying_at(is_lying)), tmp_path, AT_END, IN_RANGE)
    assert outcomes(found) == ["jumps", "passed"]
    assert "box jumps by 0 mm and 90 deg" in found.notes[0]


@pytest.mark.parametrize(
    ("pose", "shape"),
    [
        (lambda t: box_pose(tilt=min(np.pi / 2, 12 * max(0.0, t - 1.0))), ""),
        (lambda t: box_pose(tilt=0.3 * np.sin(20 * t)), ""),
        (lambda t: box_pose(tilt=33.0 * t), "sphere: {radius: 0.02}"),
        (
            lambda t: [0.3, -0.2, 0.02, np.cos(40 * t), 0, 0, np.sin(40 * t)],
            "cylinder: {radius: 0.02, length: 0.04}",
        ),
    ],
    ids=["tips over", "rocks", "ball that rolls", "can that turns about its axis"],
)
def test_a_turn_that_a_body_makes_is_no_doubt(pose, shape, tmp_path):
    scenario = SCENARIO.replace("box: {size: [0.04, 0.04, 0.04]}", shape) if shape else SCENARIO
    found = grade(recorded(pose), tmp_path, IN_RANGE, "displaced: box", scenario=scenario)
    assert found.notes == ()


# -- two sources of one pose ----------------------------------------------------------------------


def both(other, topic="/tf", parent="world", at=None):
    """Poses of the box in two topics, of which the named one says that it stands."""
    return add_box(recorded(), times(50) if at is None else at, other, topic, parent)


@pytest.mark.parametrize(
    "other",
    [
        lambda _: box_pose(z=0.5, tilt=np.pi / 2),
        lambda _: box_pose(tilt=0.25),
        lambda t: box_pose(x=0.3 + 0.03 * min(1.0, 5 * max(0.0, t - 1.5))),
    ],
    ids=["elsewhere and on its side", "leaning", "3 cm aside in the second half"],
)
@pytest.mark.parametrize("topic", ["/tf", "/tf_static"])
def test_two_topics_that_contradict_each_other_about_a_box_are_noticed(other, topic, tmp_path):
    at = times(50) if topic == "/tf" else [2.0]
    bag = both(other, topic, at=at)
    found = grade(bag, tmp_path, STANDS, IN_RANGE)
    assert outcomes(found) == ["tf", "passed"]
    assert any("two topics contradict each other about box" in note for note in found.notes)
    assert outcomes(grade(bag, tmp_path, STANDS, allowed=["tf"])) == ["passed"]


def test_two_topics_that_agree_are_no_doubt(tmp_path):
    """One of them says it in a frame of its own, and 10 ms late."""
    slides = recorded(lambda t: box_pose(y=-0.2 + 0.2 * t))
    late = [t + 0.005 for t in times(50, last=2.9)]
    add_box(slides, late, lambda t: box_pose(x=0.2, y=-0.2 + 0.2 * (t - 0.01)), "/tf", "camera")
    add_box(slides, [0.0], lambda _: [0.1, 0, 0, 1, 0, 0, 0], "/tf_static", name="camera")
    found = grade(slides, tmp_path, STANDS, "displaced: box")
    assert outcomes(found) == ["passed", "passed"]
    assert found.notes == ()


# -- poses that were published once ---------------------------------------------------------------


@pytest.mark.parametrize(
    "edges",
    [
        [("link5", "box")],
        [("world", "box")],
        [("tag", "box"), ("link5", "tag")],
    ],
    ids=["in the hand", "in the world", "on a tag on the hand"],
)
def test_a_static_pose_of_a_movable_box_is_doubted(edges, tmp_path):
    glued = add_joints(Recording(), times(50))
    transforms = [transform(*edge, box_pose()) for edge in edges]
    glued.add("/tf_static", FRAMES, 0.0, {"transforms": transforms})
    found = grade(glued, tmp_path, STANDS, IN_RANGE, topics=BagTopics())
    assert [row.withheld for row in found.rows] == [("once",), ()]
    assert outcomes(grade(glued, tmp_path, IN_RANGE, topics=BagTopics())) == ["passed"]


def test_a_static_pose_on_a_tag_that_is_tracked_is_no_doubt(tmp_path):
    """The tag is glued to the box, and a camera follows the tag."""
    tracked = add_joints(Recording(), times(50))
    add_box(tracked, times(50), lambda t: box_pose(y=-0.2 + 0.1 * t), "/tf", name="tag")
    add_box(tracked, [0.0], lambda _: [0, 0, 0, 1, 0, 0, 0], "/tf_static", "tag", "box")
    found = grade(tracked, tmp_path, STANDS, "displaced: box", topics=BagTopics())
    assert outcomes(found) == ["passed", "passed"]


def test_a_static_pose_of_a_fixture_is_no_doubt(tmp_path):
    fixed = add_joints(Recording(), times(50))
    add_box(fixed, [0.0], lambda _: box_pose(), "/tf_static")
    scenario = SCENARIO.replace("mass: 0.1", "static: true")
    found = grade(fixed, tmp_path, IN_RANGE, topics=BagTopics(), scenario=scenario)
    assert found.notes == ()


# -- what a program says of itself ----------------------------------------------------------------


def say(recording, time, **event):
    """A message on the topic of events."""
    content = {"data": json.dumps(event)}
    recording.add("/armharness/events", "std_msgs/msg/String", time, content)
    return recording


@pytest.mark.parametrize("event", ["run_started", "run_finished", "verdict", "attached"])
def test_no_event_lifts_a_doubt(event, tmp_path):
    """Anybody can publish them."""
    once = add_box(add_joints(Recording(), times(50)), [1.0], lambda _: box_pose())
    jumps = recorded(lambda t: box_pose(x=0.3 if t < 1 else 0.6))
    joint = recorded(position=lambda t: 0.6 * (t >= 1))
    for recording, doubt in ((once, "once"), (jumps, "jumps"), (joint, "jumps")):
        say(recording, 0.0, event=event, scenario="made", case="", seed=0, object="box",
            link="link5", pose_in_link=[0, 0, 0, 1, 0, 0, 0])  # fmt: skip
        assert outcomes(grade(recording, tmp_path, STANDS)) == [doubt]


def test_a_program_that_hides_an_object_is_doubted_about_it(tmp_path):
    """The box lies on its side for a second, in which it is said not to be there."""
    fallen = recorded(lambda t: box_pose(tilt=1.5 * np.clip(min(5 * (t - 1), 5 * (2 - t)), 0, 1)))
    assert outcomes(grade(fallen, tmp_path, STANDS, IN_RANGE)) == ["failed", "passed"]
    say(fallen, 0.9, event="object_removed", object="box")
    say(fallen, 2.1, event="object_added", object="box")
    assert outcomes(grade(fallen, tmp_path, STANDS, IN_RANGE)) == ["steps", "passed"]


def test_results_that_a_program_reports_of_its_steps_are_not_recorded(tmp_path):
    done = recorded(position=ramp(0.4))
    say(done, 0.5, event="step_started", step="weld", verb="cartesian_path")
    say(done, 2.5, event="step_finished", step="weld", verb="cartesian_path", status="passed",
        result={"fraction": 1.0})  # fmt: skip
    assert outcomes(grade(done, tmp_path, "fraction: 0.9")) == ["not observable"]


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize("other", [0.0, -0.9])
def test_distances_of_doubtful_joints_are_not_measured(other, tmp_path):
    """A forgotten node publishes each joint elsewhere, 4 ms after each message."""
    two = add_joints(recorded(position=ramp(0.6)), times(50) + 0.004, lambda _: other)
    near = "clearance: {between: [robot, box], at_least: 1 cm}"
    found = grade(two, tmp_path, near, IN_RANGE)
    assert outcomes(found) == ["publishers", "publishers"]
    assert (found.withheld, found.open, found.earned) == (2, 0, 0)
    assert not found.run.signals.clearances
    allowed = grade(two, tmp_path, near, allowed=["publishers"])
    assert ("robot", "box") in allowed.run.signals.clearances
