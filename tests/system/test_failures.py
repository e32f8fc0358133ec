"""Every bundled failure passes as expected, and reads well where it is unexpected."""

import re
from pathlib import Path

import cv2
import pytest

from harness.core.resources import data_folder
from harness.recording.explanation import STAGES, recorded_explanation
from harness.recording.read_run import read_run
from harness.reporting.explanation import explanation_lines
from harness.reporting.terminal import failure
from harness.session.check import check_file
from tests.running import run_case

FAILURES = data_folder("scenarios") / "failures"
FILES = sorted(FAILURES.glob("*.scenario.yaml"))

MESSAGES = {
    "too_far": [
        r"cannot reach .* the nearest point it reaches, .*, is \d+\.\d mm away",
        r"reach: NO_IK_SOLUTION: nearest reachable pose: \(.*\) mm, \d+\.\d mm and \d+\.\d° away",
        r"    with the requested orientation: \(.*\) mm, \d+\.\d mm away",
        r"    with any orientation: \(.*\) mm, \d+\.\d mm away",
        r"inverse kinematics: skipped, no branch",
        r"what to do: `pose: \{frame: world, xyz: \[.*\], quat_xyzw: \[.*\]\}` is reached",
        r"picture: images/01-too-far-why.jpg \(nearest pose\)",
    ],
    "turned_too_far": [
        r"reaches .*, but not with the requested orientation",
        r"    at the requested position: \d+\.\d° away",
    ],
    "line_meets_a_limit": [
        r"can follow the straight line for \d+ % .*: shoulder_pan_joint meets its limit",
        r"    backwards, elbow up, wrist_2_joint > 0: free",
        r"path: NO_IK_SOLUTION",
        r"what to do: begin the line in another posture",
    ],
    "into_the_table": [
        r"reaches \(.*\) mm in world in \d ways, each of them in collision; the nearest: .* deep",
        r"inverse kinematics: GOAL_IN_COLLISION: 8 branches .*: 0 free, 8 in collision",
        r"    forwards, elbow up, wrist_2_joint < 0: \w+ and \w+ \(\d+\.\d mm deep\)",
        r"    backwards, elbow down, wrist_2_joint > 0: ",
        r"what to do: moved \d+\.\d mm along \+z of the world the goal is free",
    ],
    "joints_into_the_table": [r"inverse kinematics: GOAL_IN_COLLISION: .*forearm_link and Table"],
    "steps[0]": [
        r"elbow_joint would be at -3\.491 rad \(-200\.0°\), 0\.499 rad \(28\.6°\) beyond its limit",
        r"reach: GOAL_STATE_INVALID: 2 joints beyond a limit",
        r"what to do: give elbow_joint at least -2\.992 rad",
    ],
    "steps[2]": [
        r"start state: START_STATE_IN_COLLISION: in collision before anything moves: \d pairs",
        r"    wrist_1_link and crate \(\d+\.\d mm deep\)",
        r"what to do: move 'crate' out of the way: it is 131\.\d mm too near, or start elsewhere",
    ],
    "turned_sideways": [
        r"with 4 joints \w+ reaches the position and pitch of the pose, but is then turned 30\.0°",
        r"what to do: give `position` and `pitch` instead of `pose`, or allow `tolerance: ",
    ],
    "past_the_plates": [
        r"no free path to the goal was found in at most 300 state checks",
        r"path: PLANNING_FAILED",
        r"    what blocks: after \d+ % of the direct joint motion, \w+ and plate",
        r"    gap between the search trees: \d+\.\d°",
        r"    budget: \d+ state checks used in 1 search of 300",
        r"what to do: raise `max_state_checks`",
    ],
    "not_so_far": [
        r"gets \d+\.\d mm far, not 600\.0 mm: the arm reaches no farther on this line",
        r"what to do: begin the line in another posture",
    ],
    "through_the_plate": [
        r"joint motion cannot be executed: at \d\.\d\d s .* plate \(0\.\d mm apart, 2\.0 mm req",
        r"path: INVALID_MOTION_PLAN",
        r"what to do: `move_to` goes around what is in the way",
    ],
    "too_fast": [
        r"time parameterisation: INVALID_MOTION_PLAN",
        r"what to do: give it `duration: 1\.942` or more",
    ],
    "before_it_has_landed": [
        r"ball still moves with 1\.96 m/s after 0\.2 s",
        r"what to do: give the step a longer `timeout`",
    ],
    "slower_than_allowed": [r"the motion takes \d\.\d\d s, the step's timeout is 0\.5 s; raise"],
    "closes_on_nothing": [
        r"did not touch 'green_cylinder' when the gripper closed",
        r"what to do: bring the TCP to the object first",
    ],
    "into_the_post": [
        r"wrist_2_joint lags 11\.\d+ deg behind .*presses on hidden_post with \d+ N",
        r"what to do: the planner does not know hidden_post \(it is `in: simulation`\)",
    ],
}
"""Id of each step that fails -> what a person is reported, in this order."""


@pytest.fixture(scope="module", params=FILES, ids=lambda file: file.name.split(".")[0])
def failed(request, tmp_path_factory):
    """A bundled failure's result and saved run, with pictures."""
    folder = tmp_path_factory.mktemp("failures") / "report"
    result = run_case(request.param, report_dir=folder, page=False)
    assert result.outcome == "passed", failure(result)
    return request.param, read_run(folder).run, folder


def unexpected(file: Path, folder: Path, step_id: str) -> Path:
    """The file with the expectation of one step's failure taken out."""
    kept, within = [], False
    for index, block in enumerate(re.split(r"(?m)^(?=  - |steps:)", file.read_text())):
        within = f"id: {step_id}\n" in block or step_id == f"steps[{index - 2}]"
        kept.append(re.sub(r"    expect_error: \w+\n", "", block) if within else block)
    changed = folder / file.name
    changed.write_text("".join(kept), encoding="utf-8")
    return changed


@pytest.mark.nightly(but=["goal_in_collision"])
def test_every_failure_is_reported_in_the_words_that_a_person_needs(failed):
    file, run, _ = failed
    steps = [step for step in run.steps if step.status == "expected error"]
    assert steps
    for step in steps:
        text = [step.message, *explanation_lines(step.explanation, step.message)]
        said = iter(text)
        for pattern in MESSAGES[step.id]:
            assert any(re.search(pattern, line) for line in said), (file.name, pattern, text)


@pytest.mark.nightly(but=["goal_in_collision"])
def test_stages_come_in_order_and_the_first_that_failed_has_the_code(failed):
    _, run, _ = failed
    for step in run.steps:
        stages = recorded_explanation(step.explanation).stages
        if not stages:
            continue
        names = [stage.stage for stage in stages]
        assert names == [name for name in STAGES if name in names]
        codes = [stage.code for stage in stages if stage.status == "failed"]
        assert step.error_code in codes


@pytest.mark.nightly(but=["goal_in_collision"])
def test_a_motion_that_is_refused_never_moves_the_arm(failed):
    """Refused by planning, verification included: no time passes and no command changes."""
    _, run, _ = failed
    for step in run.steps:
        if step.status != "expected error" or step.error_code in ("CONTROL_FAILED", "TIMED_OUT"):
            continue
        assert step.trajectory is None
        assert step.end_time == step.start_time
        commands = run.signals.joint_commands[step.start_index : step.end_index]
        assert len(commands) <= 1  # the one that stood already


@pytest.mark.nightly(but=["goal_in_collision"])
def test_a_picture_shows_every_state_that_is_spoken_of(failed):
    _, run, folder = failed
    for step in run.steps:
        explanation = recorded_explanation(step.explanation)
        if explanation.nearest is not None:
            joints = explanation.nearest.joint_positions
            assert set(joints) == {joint.name for joint in run.robot.movable_joints}
            picture = cv2.imread(str(folder / explanation.picture))
            assert picture.shape == (480, 640, 3)
            assert picture.std() > 10


SCENARIOS = sorted(data_folder("scenarios").rglob("*.scenario.yaml"))


REPRESENTATIVES = ("05_goals", "02_sequence", "goal_state_invalid", "control_failed")
"""Bundled scenarios whose checks take little time."""


@pytest.mark.nightly(but=REPRESENTATIVES)
@pytest.mark.parametrize("file", SCENARIOS, ids=lambda file: file.name.split(".")[0])
def test_a_check_foresees_of_every_bundled_scenario_what_its_run_shows(file):
    """Lines and relative motions are followed; a grasp that is to fail is not taken to hold."""
    found = check_file(file)
    assert not found.problems
    assert not found.predicted


def test_every_code_of_a_file_name_is_what_the_file_expects():
    for file in FILES:
        code = file.name.split(".")[0].upper()
        assert f"expect_error: {code}" in file.read_text(encoding="utf-8")


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(
    ("name", "step"),
    [
        ("no_ik_solution", "too_far"),
        ("goal_in_collision", "into_the_table"),
        ("goal_constraints_violated", "turned_sideways"),
        ("control_failed", "closes_on_nothing"),
    ],
)
def test_without_the_expectation_the_run_fails_and_the_terminal_explains(tmp_path, name, step):
    file = unexpected(FAILURES / f"{name}.scenario.yaml", tmp_path, step)
    result = run_case(file, stills=False)
    assert result.outcome == "failed"
    reported = iter(failure(result).splitlines())
    for pattern in MESSAGES[step]:
        if not pattern.startswith("picture"):
            assert any(re.search(pattern, line) for line in reported), pattern


@pytest.mark.nightly(but=[1])
@pytest.mark.parametrize(
    ("name", "step"),
    [
        ("no_ik_solution", "turned_too_far"),
        ("goal_in_collision", "joints_into_the_table"),
        ("goal_state_invalid", "steps[0]"),
        ("goal_constraints_violated", "turned_sideways"),
        ("start_state_in_collision", "steps[2]"),
    ],
)
def test_a_check_finds_the_static_ones_and_explains_them(tmp_path, name, step):
    file = FAILURES / f"{name}.scenario.yaml"
    assert not check_file(file).predicted
    found = check_file(unexpected(file, tmp_path, step))
    [problem], [lines] = found.predicted, found.explanations
    reported = iter([problem.message, *lines])
    for pattern in MESSAGES[step]:
        assert any(re.search(pattern, line) for line in reported), pattern
