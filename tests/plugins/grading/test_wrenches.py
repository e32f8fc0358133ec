"""Recordings with a sensor of force and torque: which topic is read, and what is not known."""

import pytest

from tests.plugins.grading.hand_made import SCENARIO, grade, recorded, times
from tests.plugins.grading.recordings import header, vector

SENSED = SCENARIO.replace(
    "robot: open_manipulator_x",
    "robot: {model: open_manipulator_x, wrench_sensors: {wrist: {link: link5}}}",
)
WRENCH = "geometry_msgs/msg/WrenchStamped"
BELOW = "wrench: {below: 12 N, force_window: 0}"
PRESSED = "eventually: {wrench: {above: 9 N, direction: {xyz: [0, 0, 1], frame: wrist}}, for: 0.5}"
FORMULA = "formula: always (force_z(wrist) < 12 N)"


def with_wrench(force, rate=500, frame="link5", topic="/wrist/wrench", recording=None, last=3.0):
    recording = recorded() if recording is None else recording
    for time in times(rate, last=last):
        wrench = {"force": vector([0, 0, force(time)]), "torque": vector([0, 0.1, 0])}
        recording.add(topic, WRENCH, float(time), {"header": header(frame), "wrench": wrench})
    return recording


def statuses(recording, folder, *lines):
    found = grade(recording, folder, *lines, scenario=SENSED)
    return [row.verdict.status for row in found.rows], found


def ten(_time):
    return 10.0


@pytest.mark.parametrize("topic", ["/wrist/wrench", "/ft_sensor/data"])
def test_a_topic_with_the_sensor_s_frame_is_judged(tmp_path, topic):
    found, _ = statuses(with_wrench(ten, topic=topic), tmp_path, BELOW, PRESSED, FORMULA)
    assert found == ["passed"] * 3


def test_a_blow_between_two_messages_of_the_joints_is_seen(tmp_path):
    """Joints come every 20 ms, and the force is 40 N for 6 ms between two of them."""
    blow = with_wrench(lambda time: 40.0 if 1.006 < time < 1.012 else 10.0)
    found, grades = statuses(blow, tmp_path, BELOW)
    assert found == ["failed"]
    assert "40.0 N" in grades.rows[0].verdict.reason


@pytest.mark.parametrize(
    ("recording", "said"),
    [
        (recorded, "no geometry_msgs/WrenchStamped has the frame 'link5'"),
        (lambda: with_wrench(ten, frame="tool0"), "/wrist/wrench has 'tool0'"),
        (lambda: with_wrench(ten, topic="/b", recording=with_wrench(ten, topic="/a")), "/a, /b"),
    ],
)
def test_a_sensor_that_no_topic_is_of_is_not_observable(tmp_path, recording, said):
    found, grades = statuses(recording(), tmp_path, BELOW, FORMULA)
    assert found == ["not observable"] * 2
    assert any(said in note for note in grades.notes)


def test_the_topic_below_the_sensor_s_name_counts_among_several(tmp_path):
    both = with_wrench(ten, recording=with_wrench(lambda _: 50.0, topic="/raw"))
    assert statuses(both, tmp_path, BELOW)[0] == ["passed"]


def test_what_was_never_read_is_not_taken_for_small(tmp_path):
    """The sensor falls silent after a second: a force later may have been anything."""
    found, _ = statuses(with_wrench(ten, last=1.0), tmp_path, BELOW, PRESSED)
    assert found[0] != "passed"


def test_damaged_numbers_are_left_out_with_a_note(tmp_path):
    broken = with_wrench(lambda time: float("nan") if 1 < time < 1.01 else 10.0)
    found, grades = statuses(broken, tmp_path, BELOW)
    assert found == ["passed"]
    assert any("/wrist/wrench cannot be read" in note for note in grades.notes)
