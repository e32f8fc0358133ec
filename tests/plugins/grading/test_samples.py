"""Every message of a recording is judged, and nothing is known where none is near."""

import numpy as np
import pytest

from harness.core.errors import SpecError
from harness.plugins.grading.bag import recorded_run
from harness.plugins.grading.bag.content import BagTopics
from tests.plugins.grading.hand_made import (
    POSES,
    add_box,
    add_joints,
    box_pose,
    grade,
    outcomes,
    recorded,
    state,
    statuses,
    times,
)
from tests.plugins.grading.recordings import Recording, transform

LOW, STANDS = "formula: always z(box) < 3 cm", "always: {upright: box}"
IN_RANGE = "formula: always abs(position(joint1)) < 1"


def hop(first, last):
    """A pose that is up to 6 cm high between two times."""
    return lambda time: box_pose(z=0.02 + 4.9 * max(0.0, (time - first) * (last - time)))


def leaning(first, last):
    return lambda time: box_pose(tilt=0.5 if first < time < last else 0.0)


def test_what_happens_between_joint_states_has_failed(tmp_path):
    """The joints at 5 Hz are still at the first and the last moment of the hop."""
    found = grade(recorded(hop(1.01, 1.19), joints=5, box=100), tmp_path, LOW, STANDS)
    low, stands = (row.verdict for row in found.rows)
    assert (low.status, stands.status) == ("failed", "passed")
    assert low.measures[0].value == pytest.approx(0.0597, abs=1e-4)
    assert low.time == pytest.approx(1.1)


@pytest.mark.parametrize("box", [100, 250, 33])
def test_a_box_that_leans_for_a_moment_has_leant_at_any_rate(box, tmp_path):
    found = grade(recorded(leaning(1.021, 1.053), box=box), tmp_path, STANDS, LOW)
    assert statuses(found) == ["failed", "passed"]


def test_what_moves_between_poses_of_the_box_has_failed(tmp_path):
    """The other way round: a joint at 100 Hz swings between two poses of a box at 5 Hz."""

    def swing(time):
        return 1.2 * np.sin(np.pi * (time - 1.0) / 0.2) ** 2 if 1 < time < 1.2 else 0.0

    found = recorded(joints=100, box=5, position=swing)
    assert statuses(grade(found, tmp_path, IN_RANGE, STANDS)) == ["failed", "passed"]


def test_a_command_between_joint_states_has_been_given(tmp_path):
    """The joints stand still at 5 Hz, and one command of a hundred is beyond its limit."""
    recording = recorded(joints=5)
    for time in times(100):
        command = state(4.0 if abs(time - 1.1) < 1e-6 else 0.0)
        recording.add("/joint_commands", "sensor_msgs/msg/JointState", float(time), command)
    limits = "within_limits: {effort: false, velocity: false}"
    assert statuses(grade(recording, tmp_path, limits, IN_RANGE)) == ["failed", "passed"]


def test_joint_states_of_another_robot_leave_the_joints_to_tf(tmp_path):
    recording = add_box(Recording(), times(50), lambda _: box_pose())
    content = {**state(0.0), "name": ["a", "b", "c", "d", "e"]}
    for time in times(50):
        recording.add("/joint_states", "sensor_msgs/msg/JointState", float(time), content)
        turned = [0.012, 0, 0.017, np.cos(0.1 * time), 0, 0, np.sin(0.1 * time)]
        transforms = [transform("link1", "link2", turned)]
        recording.add("/tf", "tf2_msgs/msg/TFMessage", float(time), {"transforms": transforms})
    found = grade(recording, tmp_path, IN_RANGE, "joints: {positions: {joint1: 0.6}}", STANDS)
    assert statuses(found) == ["passed"] * 3


@pytest.mark.parametrize("shift", [0.0, 0.003, 0.01])
def test_a_phase_between_topics_changes_no_verdict(shift, tmp_path):
    recording = add_joints(Recording(), times(50), lambda t: 0.3 * np.sin(t))
    add_box(recording, times(50, first=shift), lambda t: box_pose(y=-0.2 + 0.02 * t))
    found = grade(
        recording, tmp_path, LOW, STANDS, IN_RANGE, "formula: always speed(box) < 0.021",
        "displaced: {object: box, at_least: 5 cm}", "path_length: {at_least: 5 cm}",
    )  # fmt: skip
    assert statuses(found) == ["passed"] * 6
    assert found.notes == ()


def test_what_is_recorded_before_the_joints_counts(tmp_path):
    """The joint states begin 1 s after the poses: the joints are unknown until then."""
    recording = add_joints(Recording(), times(50, first=1.0))
    add_box(recording, times(50), leaning(0.3, 0.5))
    assert statuses(grade(recording, tmp_path, STANDS, IN_RANGE)) == ["failed", "not observable"]


@pytest.mark.parametrize(("late", "status"), [(0.2, "passed"), (0.3, "not observable")])
def test_topics_may_begin_a_quarter_of_a_second_apart(late, status, tmp_path):
    recording = add_joints(Recording(), times(100, first=late), lambda t: 0.2 * t)
    add_box(recording, times(100), lambda _: box_pose())
    assert statuses(grade(recording, tmp_path, IN_RANGE, STANDS)) == [status, "passed"]
    recording = add_joints(Recording(), times(100))
    add_box(recording, times(100, first=late), lambda t: box_pose(y=-0.2 + 0.1 * t))
    assert statuses(grade(recording, tmp_path, IN_RANGE, STANDS)) == ["passed", status]


def test_a_stamp_from_before_the_recording_does_not_lengthen_it(tmp_path):
    """A node that sent the pose once, a minute before, and the recorder got it at the start."""
    recording = add_joints(Recording(), times(50))
    add_box(recording, [0.0], lambda _: box_pose())
    recording.of(POSES)[0].stamp -= 60
    found = grade(recording, tmp_path, IN_RANGE, "duration: {at_most: 3.1 s}", STANDS)
    assert outcomes(found) == ["passed", "passed", "once"]


def test_a_joint_that_turns_without_end_is_not_interpolated_through_zero(tmp_path):
    """The wheel passes 180 degrees, where its position jumps to -180 degrees."""
    urdf = tmp_path / "wheel.urdf"
    urdf.write_text(
        '<robot name="wheel"><link name="base"/><link name="rim"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="joint1" type="continuous"><parent link="base"/><child link="rim"/>'
        '<axis xyz="0 0 1"/><limit effort="9" velocity="3"/></joint></robot>'
    )
    scenario = (
        "scenario: a wheel\nrobot: {urdf: wheel.urdf}\nworld: empty\nobjects:\n"
        "  - {name: box, box: {size: [0.04, 0.04, 0.04]}, pose: {xyz: [1, 0, 0.02]}, mass: 0.1}\n"
        "steps:\n  - wait: 1 s\nexpect:\n"
    )
    turning = recorded(
        joints=20, box=100, position=lambda t: (t + 1.5 + np.pi) % (2 * np.pi) - np.pi
    )
    found = grade(
        turning, tmp_path, "formula: always abs(position(joint1)) > 1.4", scenario=scenario
    )
    assert statuses(found) == ["passed"]
    assert found.notes == ()


# -- between messages that are far apart ----------------------------------------------------------


def exchanged(at):
    return lambda time: box_pose(y=-0.2 if time < at else 0.7)


WAS_BETWEEN = "abs(y(box) - 25 cm) < 20 cm"


@pytest.mark.parametrize("joints", [50, 1])
def test_nothing_is_seen_between_messages_a_second_apart(joints, tmp_path):
    found = grade(
        recorded(exchanged(2.0), joints=joints, box=1), tmp_path,
        f"formula: eventually {WAS_BETWEEN}",
        f"formula: eventually always[0, 100 ms] {WAS_BETWEEN}", STANDS,
        "formula: always speed(box) < 0.95", "always: {static: {object: box, max_velocity: 0.95}}",
        "displaced: {object: box, at_least: 0.85 m}",
    )  # fmt: skip
    assert statuses(found) == ["not observable"] * 5 + ["passed"]


def test_what_stands_still_at_one_hertz_is_known_in_between(tmp_path):
    found = grade(recorded(box=1), tmp_path, STANDS, LOW, "always: {static: box}")
    assert statuses(found) == ["passed"] * 3
    assert found.notes == ()


def test_a_slide_at_five_hertz_is_interpolated(tmp_path):
    """200 ms between messages, and 2 cm: not far enough apart to hide something."""
    slow = recorded(lambda t: box_pose(y=-0.2 + 0.1 * t), box=5)
    found = grade(slow, tmp_path, STANDS, "formula: eventually abs(y(box) + 11 cm) < 5 mm")
    assert statuses(found) == ["passed", "passed"]


@pytest.mark.parametrize(("rate", "status"), [(5, "passed"), (3, "not observable")])
def test_a_joint_that_moves_is_known_up_to_a_quarter_of_a_second(rate, status, tmp_path):
    moving = recorded(joints=rate, position=lambda t: 0.3 * t)
    assert statuses(grade(moving, tmp_path, IN_RANGE, STANDS)) == [status, "passed"]


def test_the_speed_after_a_hole_is_not_zero(tmp_path):
    """A box that slides all along is not still because nothing is known of the moment before."""
    slides = recorded(lambda t: box_pose(y=-0.2 + 0.2 * t))
    kept = [
        m for m in slides.messages if m.topic != POSES or round((m.stamp - 123.4) * 50) % 50 < 5
    ]
    found = grade(Recording(kept), tmp_path, "eventually: {static: box}", STANDS)
    assert statuses(found) == ["not observable", "not observable"]


def test_a_distance_is_known_where_the_joints_are(tmp_path):
    """Joint states that begin 1 s late leave the start open and no more."""
    late = add_joints(Recording(), times(50, first=1.0))
    add_box(late, times(50), lambda _: box_pose())
    clear = "clearance: {between: [robot, box], at_least: %s}"
    found = grade(late, tmp_path, clear % "1 cm", clear % "50 cm")
    assert statuses(found) == ["not observable", "failed"]


def test_a_recording_with_too_many_times_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(recorded_run, "BAG_SIGNALS", 5000)
    with pytest.raises(SpecError, match="has messages at 301 different times"):
        grade(recorded(joints=10, box=100), tmp_path, STANDS)


def test_only_topics_that_are_judged_add_times(tmp_path):
    """A camera's frame at 100 Hz says nothing of the joints or the box."""
    recording = add_joints(Recording(), times(10))
    add_box(recording, times(100), lambda _: box_pose(), topic="/tf", name="camera")
    found = grade(recording, tmp_path, IN_RANGE, topics=BagTopics())
    assert len(found.run.signals.times) == 31
