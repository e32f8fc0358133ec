"""Recordings whose clocks, stamps, order or completeness cannot be relied on."""

import random
from dataclasses import replace

import numpy as np
import pytest

from harness.plugins.grading.grade import grade_bag
from tests.plugins.grading.recordings import (
    GAZEBO,
    GAZEBO_STARTED,
    POSES,
    SCENARIO,
    WALL_CLOCK,
    status_of,
)


@pytest.mark.nightly
def test_messages_in_disorder_and_twice_change_nothing(recording, tmp_path):
    straight = grade_bag(SCENARIO, recording.write(tmp_path / "straight.mcap"), GAZEBO)
    shuffled = list(recording.messages)
    source = random.Random(3)
    for start in range(0, len(shuffled), 12):
        block = shuffled[start : start + 12]
        source.shuffle(block)
        shuffled[start : start + 12] = block
    for message in shuffled:
        message.logged += source.uniform(0, 0.05)
    recording.messages = shuffled + shuffled[100:160]
    grade = grade_bag(SCENARIO, recording.write(tmp_path / "disorder.mcap"), GAZEBO)
    assert [row.verdict for row in grade.rows] == [row.verdict for row in straight.rows]


def test_objects_stamped_by_another_clock_come_over_the_recorders(recording, tmp_path):
    """The tracker has no `use_sim_time`; simulation ran at half speed."""
    for message in recording.of(POSES):
        message.stamp = message.logged
    grade = grade_bag(SCENARIO, recording.write(tmp_path / "clocks.mcap"), GAZEBO)
    assert grade.earned == 14
    [note] = grade.notes
    assert "and the joint states have different clocks" in note


@pytest.mark.nightly
def test_joint_states_without_stamps_are_where_the_recorder_got_them(recording, tmp_path):
    for message in recording.messages:
        message.stamp, message.logged = 0.0, WALL_CLOCK + (message.stamp - GAZEBO_STARTED)
    grade = grade_bag(SCENARIO, recording.write(tmp_path / "no_stamps.mcap"), GAZEBO)
    assert grade.earned == 14
    assert any("have no stamps" in note for note in grade.notes)


@pytest.mark.nightly
def test_after_a_simulation_was_restarted_only_the_last_attempt_counts(recording, tmp_path):
    """Both attempts have the same stamps: sorting them together would make a third."""
    first = [replace(message) for message in recording.messages]
    for message in first:
        message.logged -= 100.0
        if message.topic == POSES:
            message.content = {"transforms": []}
    recording.messages = first + recording.messages
    grade = grade_bag(SCENARIO, recording.write(tmp_path / "twice.mcap"), GAZEBO)
    assert grade.earned == 14
    assert any("the clock was set back" in note for note in grade.notes)


def test_a_gap_is_no_failure_and_no_success(recording, tmp_path):
    gone = (GAZEBO_STARTED + 4, GAZEBO_STARTED + 8)
    recording.messages = [
        m for m in recording.messages if m.topic != POSES or not gone[0] < m.stamp < gone[1]
    ]
    file = tmp_path / "always.scenario.yaml"
    text = SCENARIO.read_text()
    file.write_text(text[: text.index("expect:\n  - eventually")] + (
        "expect:\n  - always: {upright: green_cylinder}\n  - always: {upright: red_box}\n"
        "  - upright: green_cylinder\n"
    ))  # fmt: skip
    bag = recording.write(tmp_path / "gap.mcap")
    grade = grade_bag(file, bag, GAZEBO)
    [_, held, _, bare] = [row.verdict for row in grade.rows]
    assert held.status == "not observable"
    assert held.reason.endswith("are not known, and would decide it")
    assert bare.status == "passed"
    assert any("green_cylinder: no pose for" in note for note in grade.notes)


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize("seconds", [(4.0, 6.0), (4.0, 4.4), (9.0, 9.3)])
def test_nothing_is_interpolated_across_a_hole_in_the_joint_states(recording, tmp_path, seconds):
    begin, end = (GAZEBO_STARTED + second for second in seconds)
    recording.messages = [
        m for m in recording.messages if m.topic != "/joint_states" or not begin < m.stamp < end
    ]
    file = tmp_path / "hole.scenario.yaml"
    text = SCENARIO.read_text()
    file.write_text(text[: text.index("expect:\n  - eventually")] + (
        "expect:\n  - formula: always z(tcp) > 0\n"
        "  - formula: always z(green_cylinder) > 0\n  - upright: green_cylinder\n"
    ))  # fmt: skip
    grade = grade_bag(file, recording.write(tmp_path / "hole.mcap"), GAZEBO)
    [_, arm, cylinder, _] = [row.verdict for row in grade.rows]
    assert arm.status == "not observable"
    assert cylinder.status == "passed"
    run = grade.run
    inside = (run.signals.times > seconds[0] + 0.05) & (run.signals.times < seconds[1] - 0.05)
    assert inside.sum() > 5
    assert np.isnan(run.signals.tcp_pose[inside]).all()
    assert not np.isnan(run.signals.object_poses["green_cylinder"][inside]).any()


@pytest.mark.nightly
def test_a_few_lost_messages_are_no_hole(recording, tmp_path):
    lost = (GAZEBO_STARTED + 4.0, GAZEBO_STARTED + 4.09)
    recording.messages = [m for m in recording.messages if not lost[0] < m.stamp < lost[1]]
    grade = grade_bag(SCENARIO, recording.write(tmp_path / "lost.mcap"), GAZEBO)
    assert grade.notes == ()
    assert grade.earned == grade.points


def test_a_clock_that_jumps_ahead_leaves_an_hour_unknown(recording, tmp_path):
    for message in recording.messages:
        if message.stamp > GAZEBO_STARTED + 5:
            message.stamp += 3600
    grade = grade_bag(SCENARIO, recording.write(tmp_path / "jump.mcap"), GAZEBO)
    assert any("has a gap that begins at t=5." in note for note in grade.notes)
    assert status_of(grade, "within limits") == "not observable"
    assert status_of(grade, "named target") == "passed"
