"""The live cell: the steps of a scenario, undone to the bit, and judged as a run judges them."""

import numpy as np
import pytest

from harness.core.errors import SpecError
from harness.plugins.studio.document import Document
from harness.plugins.studio.files import StudioFiles
from harness.plugins.studio.judging import judged
from harness.plugins.studio.live_cell import LiveCell
from harness.session.run_case import run_case
from harness.session.run_request import RunRequest

TEXT = """\
# picked by hand
scenario: "a box by hand"
robot: open_manipulator_x
objects:
  - {name: box, box: {size: [0.03, 0.03, 0.03]}, pose: {xyz: [0.2, 0, 0.015]}}
steps:
  - move_to: home
  - gripper: open
    expect:
      - gripper: open
  - wait: 50 ms
expect:
  - never: collision
"""


@pytest.fixture
def cell(tmp_path):
    files = StudioFiles(tmp_path, tmp_path / "by_hand.scenario.yaml")
    return LiveCell(files, Document(TEXT, str(files.path)))


def full_state(cell):
    snapshot = cell.simulator.snapshot()
    return np.concatenate([snapshot.step.integration, *snapshot.step.arrays]), snapshot.samples


def test_the_digest_of_the_studio_is_that_of_a_run_of_the_saved_file(cell):
    cell.idle(0.2)  # physics that goes on while a person thinks is no part of the run
    cell.go_to(3)
    found = judged(cell)
    cell.files.path.write_text(cell.document.text)
    result = run_case(RunRequest(cell.files.path))
    assert result.outcome == found.outcome == "passed"
    assert found.digest == result.digest
    assert [each.margin for each in found.verdicts] == [each.margin for each in result.verdicts]


def test_the_nearest_points_of_robot_and_object_are_as_far_apart_as_the_two(cell):
    touch, points = cell.nearest_pair()
    assert (touch.first, touch.second) == ("link2", "ground_plane")
    assert touch.distance > 0.01
    assert np.linalg.norm(points[1] - points[0]) == pytest.approx(touch.distance, abs=1e-6)


def test_a_step_back_restores_the_state_to_the_bit(cell):
    cell.run_steps(1)
    before, samples = full_state(cell)
    cell.run_steps(2)
    after, _ = full_state(cell)
    cell.step_back()
    assert np.array_equal(full_state(cell)[0], before)
    assert full_state(cell)[1] == samples
    cell.run_steps(2)
    assert np.array_equal(full_state(cell)[0], after)


def test_motions_by_hand_are_undone_before_the_last_step(cell):
    cell.run_steps(1)
    before, _ = full_state(cell)
    cell.jog(cell.joint_positions() + 0.3, 1.0, 0.2)
    assert not cell.is_run
    assert not np.array_equal(full_state(cell)[0], before)
    cell.step_back()
    assert np.array_equal(full_state(cell)[0], before)
    assert (cell.steps_done, cell.is_run) == (1, True)


def test_what_was_moved_by_hand_has_no_digest_until_it_is_run(cell):
    cell.jog(cell.joint_positions() + 0.1, 1.0, 0.1)
    cell.run_steps(3)
    assert judged(cell).digest == ""
    cell.go_to(3)
    assert judged(cell).digest


def test_an_edit_keeps_the_steps_before_it(cell):
    cell.run_steps(3)
    assert not cell.load(Document(TEXT.replace("50 ms", "60 ms")))
    assert cell.steps_done == 2
    assert cell.load(Document(TEXT.replace("0.2, 0, 0.015", "0.21, 0, 0.015")))
    assert cell.steps_done == 0


def test_a_text_with_mistakes_leaves_the_cell_as_it_was(cell):
    cell.run_steps(1)
    with pytest.raises(SpecError, match="opne"):
        cell.load(Document(TEXT.replace("- gripper: open", "- gripper: opne")))
    assert (cell.steps_done, cell.document.text) == (1, TEXT)


def test_a_recorded_step_is_in_the_text_and_was_executed(cell):
    cell.run_steps(2)
    text, record = cell.record("gripper: close")
    assert record.status == "passed"
    assert text.splitlines()[10:12] == ["  - gripper: close", "  - wait: 50 ms"]
    assert text.startswith("# picked by hand")
    cell.go_to(4)
    cell.files.path.write_text(text)
    assert judged(cell).digest == run_case(RunRequest(cell.files.path)).digest


def test_a_recorded_step_that_adds_an_object_repeats_those_before_it(cell):
    cell.run_steps(2)
    before, _ = full_state(cell)
    ball = "{name: ball, sphere: {radius: 0.02}, pose: {xyz: [0.2, 0.1, 0.02]}}"
    text, record = cell.record(f"add_object: {ball}")
    assert (record.verb, record.status, cell.steps_done) == ("add_object", "passed", 3)
    assert "ball" in cell.object_poses()
    failing = ball.replace("ball", "bowl").replace("[0.2", "[{}")
    with pytest.raises(SpecError):
        cell.record(f"add_object: {failing}")
    assert (cell.steps_done, cell.document.text) == (3, text)
    cell.step_back()
    assert len(full_state(cell)[0]) > len(before), "the physics has one more object"
    cell.go_to(4)
    cell.files.path.write_text(text)
    assert judged(cell).digest == run_case(RunRequest(cell.files.path)).digest


def test_a_step_that_fails_is_not_recorded_and_changes_nothing(cell):
    cell.run_steps(1)
    before, _ = full_state(cell)
    text, record = cell.record("lin: {position: {xyz: [2, 0, 0.1]}}")
    assert (text, record.status, record.error_code) == (TEXT, "failed", "NO_IK_SOLUTION")
    assert "nearest point" in record.message
    assert np.array_equal(full_state(cell)[0], before)


def test_planning_moves_nothing(cell):
    from harness.plugins.studio.goal_actions import preview

    cell.run_steps(1)
    before, _ = full_state(cell)
    found = preview(cell, "move_to: {position: {xyz: [0.2, 0.05, 0.15]}, pitch: 0}")
    assert found.record is None
    assert found.duration > 0.1
    assert np.array_equal(full_state(cell)[0], before)
    text, _ = cell.record("move_to: {position: {xyz: [0.2, 0.05, 0.15]}, pitch: 0}")
    executed = cell.execution.records[1].trajectory
    assert executed.duration == pytest.approx(found.duration)
    assert "xyz: [0.2, 0.05, 0.15]" in text


def test_a_run_opens_in_the_middle_of_a_step_exactly_as_it_was(cell):
    cell.run_steps(3)
    recorded = judged(cell).run.signals
    middle = len(recorded.times) // 3
    cell.run_until(recorded.times[middle])
    assert cell.simulator.sample_count == middle + 1
    assert np.array_equal(cell.joint_positions(), recorded.joint_positions[middle])
    assert not cell.is_run
    cell.execute("gripper: close")  # and goes on by hand from there
    assert cell.simulator.joint_positions()[-1] != recorded.joint_positions[middle][-1]


def test_a_motion_that_is_stopped_by_hand_fails_and_leaves_the_arm_where_it_is(cell):
    cell.pace = lambda _: cell.simulator.time < 0.3
    cell.run_steps(3)
    [record, *_] = cell.execution.records
    assert (record.status, record.error_code) == ("failed", "PREEMPTED")
    assert 0.3 <= cell.simulator.time < 0.35
    assert judged(cell).digest == "", "a run of the file is not stopped there"


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize("count", [0, 1, 3])
def test_a_step_recorded_after_a_motion_by_hand_is_run_with_all_others(cell, count):
    """From the start on: what was recorded by hand is no state of a run, the states before are."""
    cell.run_steps(count)
    cell.jog(cell.joint_positions() + 0.1, 1.0, 0.1)
    cell.record("gripper: close")
    assert not cell.is_run
    cell.reset()
    cell.go_to(4)
    assert (cell.steps_done, cell.is_run) == (4, True)
    assert judged(cell).digest


def test_a_recorded_step_that_fails_after_a_motion_by_hand_leaves_the_run_possible(cell):
    cell.jog(cell.joint_positions() + 0.1, 1.0, 0.1)
    _, record = cell.record("move_to: {position: {xyz: [2, 0, 0.1]}}")
    assert record.status == "failed"
    cell.go_to(3)
    assert (cell.steps_done, cell.is_run) == (3, True)
