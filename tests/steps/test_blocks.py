"""Steps made of steps: repeat, parallel, include."""

from pathlib import Path

import pytest

from harness.plugins.cameras.steps.capture import MOST_CAPTURES
from harness.plugins.comparison.rejudge import judge_stored
from harness.recording.read_run import read_run
from harness.session.check import check_file
from tests.running import run_case
from tests.session.front_door import file_of, problems, run

BLOCKS = Path(__file__).parents[2] / "scenarios/blocks/repeat_parallel_include.scenario.yaml"
UP = "move_relative: {direction: {xyz: [0, 0, 1]}, distance: 0.02}"


@pytest.fixture(scope="module")
def blocks(tmp_path_factory):
    folder = tmp_path_factory.mktemp("blocks")
    result = run_case(BLOCKS, report_dir=folder / "run", stills=False, page=False)
    return folder, result, read_run(folder / "run").run


def test_every_time_through_has_records_ids_and_seeds_of_its_own(blocks):
    _, result, saved = blocks
    assert result.outcome == "passed", result.verdicts
    ids = [step.id for step in saved.steps]
    assert [each for each in ids if each.startswith("large.")] == [
        "large.up#1", "large.down#1", "large.up#2", "large.down#2",
    ]  # fmt: skip
    assert len({step.path for step in saved.steps}) == len(saved.steps)
    judged = {verdict.step for verdict in result.verdicts}
    assert {"up#1", "up#2"} <= judged


def test_arm_and_gripper_move_at_once(blocks):
    _, _, saved = blocks
    step = next(step for step in saved.steps if step.id == "up#1")
    rows = slice(step.start_index, step.end_index)
    names = list(saved.robot.joint_names)
    moving = abs(saved.signals.joint_velocities[rows]) > 0.05
    both = moving[:, names.index("elbow_joint")] & moving[:, names.index("rh_r1_joint")]
    assert both.sum() * saved.timestep > 0.5


@pytest.mark.nightly
def test_the_resolved_file_holds_the_included_steps_and_runs_to_the_same_digest(blocks):
    folder, result, _ = blocks
    resolved = folder / "run/scenario.resolved.yaml"
    assert "include" not in resolved.read_text(encoding="utf-8").partition("steps:")[2]
    assert run_case(resolved).digest == result.digest
    judged = judge_stored(read_run(folder / "run"), folder / "run")
    assert [(v.step, v.status, v.margin) for v in judged] == [
        (v.step, v.status, v.margin) for v in result.verdicts
    ]


def test_what_is_wrong_in_an_included_file_is_reported_there(tmp_path):
    (tmp_path / "part.steps.yaml").write_text(
        "params: {a: 1}\nsteps:\n  - move_two: home\n  - wait: ${b}\n", encoding="utf-8"
    )
    path = file_of(tmp_path, "- include: {file: part.steps.yaml, params: {c: 2}}")
    found = check_file(path).problems
    assert [(Path(p.path).name, p.line, p.message) for p in found] == [
        ("part.steps.yaml", 3, "no verb is called `move_two`"),
        ("part.steps.yaml", 4, "no parameter is called `b`"),
        ("test.scenario.yaml", 5, "'part.steps.yaml' has no parameter `c`"),
    ]


def test_files_that_include_each_other_and_missing_files_are_refused(tmp_path):
    (tmp_path / "a.steps.yaml").write_text("steps:\n  - include: b.steps.yaml\n")
    (tmp_path / "b.steps.yaml").write_text("steps:\n  - include: a.steps.yaml\n")
    steps = "- include: a.steps.yaml\n- include: none.steps.yaml"
    texts = [message for _, message in problems(tmp_path, steps)]
    assert texts[0].startswith("'a.steps.yaml' is included in itself: it is here in 'b.steps.yaml'")
    assert texts[1] == "'none.steps.yaml': there is no such file"


@pytest.mark.nightly
def test_repeats_that_multiply_are_bounded(tmp_path):
    inner = "- repeat:\n    times: 1000\n    steps:\n      - repeat:\n          times: 1000\n"
    found = problems(tmp_path, inner + "          steps: [{wait: 0.001}]")
    assert "more than 10000 steps" in found[0][1]


def test_parallel_takes_one_motion_and_one_gripper_step(tmp_path):
    two = "- parallel:\n    - %s\n    - %s"
    found = problems(tmp_path, two % (UP, UP))
    assert "one motion of the arm and one `gripper` step" in found[0][1]
    found = problems(tmp_path, two % ("gripper: open", "gripper: closed"))
    assert len(found) == 1


@pytest.mark.nightly
def test_a_motion_that_fails_inside_a_block_fails_the_block_and_says_where(tmp_path):
    far = "move_relative: {direction: {xyz: [0, 0, 1]}, distance: 3}"
    result, saved = run(
        tmp_path,
        f"- move_to: mogi_home\n- repeat:\n    times: 3\n    steps:\n      - {UP}\n      - {far}",
    )
    assert result.outcome == "failed"
    failed = [step for step in saved.steps if step.status == "failed"]
    assert [step.path for step in failed] == ["steps[1]", "steps[1].repeat[0][1]"]
    assert failed[0].error_code == failed[1].error_code


@pytest.mark.parametrize(
    ("times", "captures"), [(101, "capture: eye, " * 10), (1000, "capture: eye, capture: eye")]
)
def test_pictures_that_multiply_are_bounded(tmp_path, times, captures):
    steps = f"- repeat: {{times: {times}, steps: [{captures.strip(', ')}]}}"
    cameras = "cameras:\n  - {name: eye, pose: {xyz: [1, 0, 0.5]}}\n"
    found = problems(tmp_path, steps, rest=cameras)
    assert [message.split(",")[0] for _, message in found] == [
        f"the steps take more than {MOST_CAPTURES} pictures"
    ]
    assert not problems(tmp_path, steps.replace(str(times), "20"), rest=cameras)


def test_large_pictures_count_by_their_pixels(tmp_path):
    """Each counts as 4.55 pictures of 1280 x 720."""
    large = "cameras:\n  - {name: eye, image: {width: 2048, height: 2048}}\n"
    steps = "- repeat: {times: %d, steps: [capture: eye]}"
    assert not problems(tmp_path, steps % 219, rest=large)
    [(_, message)] = problems(tmp_path, steps % 220, rest=large)
    assert message.endswith("those beyond 1280 x 720 by their pixels")
