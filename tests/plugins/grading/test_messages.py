"""Messages without a stamp, and messages that make no sense."""

import numpy as np
import pytest

from harness.cli.main import main
from tests.plugins.grading.hand_made import POSES, grade, outcomes, recorded

STANDS, IN_RANGE = "always: {upright: box}", "formula: always abs(position(joint1)) < 1"
TOOK = ("duration: {at_least: 5 s}", "duration: {at_most: 4 s}")


def at_half_speed(begin):
    """Three seconds of simulation that the recorder saw as six."""
    recording = recorded()
    for message in recording.messages:
        message.stamp = begin + message.stamp - 123.4
    return recording


@pytest.mark.parametrize("begin", [0.0, 0.3, 5.0])
def test_a_simulation_that_begins_at_0_has_stamps(begin, tmp_path):
    found = grade(at_half_speed(begin), tmp_path, *TOOK, IN_RANGE)
    assert outcomes(found) == ["failed", "passed", "passed"]
    assert found.notes == ()


@pytest.mark.parametrize("topic", ["/joint_states", POSES])
def test_some_messages_without_a_stamp_are_where_the_recorder_got_them(topic, tmp_path):
    recording = at_half_speed(5.0)
    for message in recording.of(topic)[40:60]:
        message.stamp = 0.0
    found = grade(recording, tmp_path, *TOOK, STANDS, IN_RANGE)
    assert outcomes(found) == ["failed", "passed", "passed", "passed"]
    [note] = found.notes
    assert "20 of 151 messages of" in note
    assert len(found.run.signals.times) == 151


def test_mostly_missing_stamps_are_no_clock(tmp_path):
    recording = at_half_speed(5.0)
    for message in recording.messages[: int(0.6 * len(recording.messages))]:
        message.stamp = 0.0
    found = grade(recording, tmp_path, *TOOK)
    assert outcomes(found) == ["passed", "failed"]
    assert "the joint states have no stamps; the recorder's times are used instead" in found.notes


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"name": ["joint1", "joint1"], "position": [0, 0]}, "it names joint1 twice"),
        ({"name": [], "position": []}, "it names no joint"),
        ({"name": ["joint1"], "position": [0, 0]}, "it has 1 names and 2 values"),
        ({"name": ["joint1"], "position": [np.inf]}, "it has infinite numbers"),
    ],
)
def test_messages_that_cannot_be_used_say_why(change, reason, tmp_path, capsys):
    recording = recorded()
    for message in recording.of("/joint_states")[5:]:
        message.content = {**message.content, "velocity": [], **change}
    found = grade(recording, tmp_path, STANDS)
    assert (
        f"146 of 151 messages of /joint_states cannot be read; the first: {reason}" in found.notes
    )
    for message in recording.of("/joint_states"):
        message.content = {**message.content, "velocity": [], **change}
    bag = recording.write(tmp_path / "none.mcap")
    assert main(["grade", str(tmp_path / "made.scenario.yaml"), str(bag), "--objects", POSES]) == 2
    assert f"no message of /joint_states can be read: {reason}" in capsys.readouterr().err
