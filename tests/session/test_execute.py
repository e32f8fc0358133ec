"""Steps that are expected to fail, steps in steps, and what check predicts of them."""

import gc
import weakref

import pytest

from harness.simulation import mujoco_simulator
from harness.simulation.mujoco_simulator import MujocoSimulator
from tests.running import run_case
from tests.session.front_door import check, failures, file_of, run

OUT_OF_REACH = "{pose: {frame: base_link, xyz: [0.9, 0, 0.3], rpy: [180 deg, 0, 0]}}"
IN_THE_TABLE = "{pose: {frame: base_link, xyz: [0.35, 0.05, -0.03], rpy: [180 deg, 0, 0]}}"
CLEAR = "clear_objects: {world: true}"
SLAB = "{name: slab, box: {size: [1, 1, 0.02]}, static: true, pose: {xyz: [0.5, 0, 1.0]}}"


def statuses(result):
    return [(step.id, step.status, step.error_code) for step in result.steps]


def test_another_failure_than_the_expected_one_ends_the_run(tmp_path):
    steps = f"- move_to: {OUT_OF_REACH}\n  expect_error: GOAL_IN_COLLISION\n- wait: 1"
    result, _ = run(tmp_path, steps)
    assert result.outcome == "failed"
    assert statuses(result) == [
        ("steps[0]", "failed", "NO_IK_SOLUTION"),
        ("steps[1]", "not reached", ""),
    ]
    assert result.steps[0].message.startswith(
        "expected GOAL_IN_COLLISION, but it failed with NO_IK"
    )
    (predicted,) = check(tmp_path, steps).predicted
    assert predicted.line == 5


def test_success_where_a_failure_is_expected_is_a_failure(tmp_path):
    result, _ = run(tmp_path, "- wait: 0.01\n  expect_error: TIMED_OUT")
    assert result.outcome == "failed"
    assert result.steps[0].message == "expected to fail with TIMED_OUT, but it succeeded"


def test_a_step_made_of_others_may_be_expected_to_fail_inside(tmp_path):
    """And check, which goes on after a failure, predicts nothing else."""
    steps = f"""
    - repeat: {{times: 1, steps: [{{wait: 0.01}}, {{move_to: {OUT_OF_REACH}}}]}}
      expect_error: NO_IK_SOLUTION
    - wait: 0.01
    """
    result, _ = run(tmp_path, steps)
    assert result.outcome == "passed"
    assert statuses(result) == [
        ("steps[0]", "expected error", "NO_IK_SOLUTION"),
        ("steps[0].repeat[0][0]", "passed", ""),
        ("steps[0].repeat[0][1]", "failed", "NO_IK_SOLUTION"),
        ("steps[1]", "passed", ""),
    ]
    assert check(tmp_path, steps).predicted == ()


def test_check_reports_each_failure_once_and_goes_on_to_the_next_step(tmp_path):
    steps = f"""
    - pick: far
    - allow_collisions:
        pairs: [[robot, far]]
        during:
          - move_to: {OUT_OF_REACH}
    """
    rest = "objects: [{name: far, box: {size: [0.04, 0.04, 0.1]}, pose: {xyz: [2, 0, 0.05]}}]"
    predicted = check(tmp_path, steps, rest=rest).predicted
    assert [problem.line for problem in predicted] == [5, 9]
    assert all(problem.message.startswith("NO_IK_SOLUTION: ") for problem in predicted)


def test_collisions_are_allowed_within_and_checked_again_after_whatever_happened(tmp_path):
    steps = f"""
    - add_object: {SLAB}
    - move_to: {IN_THE_TABLE}
      expect_error: GOAL_IN_COLLISION
    - allow_collisions:
        pairs: [[robot, slab]]
        during:
          - allow_collisions: {{pairs: [[robot, slab]], during: [{{wait: 0.01}}]}}
          - move_to: {OUT_OF_REACH}
      expect_error: NO_IK_SOLUTION
    - move_to: {IN_THE_TABLE}
      expect_error: GOAL_IN_COLLISION
    """
    result, _ = run(tmp_path, steps)
    assert result.outcome == "passed", [step.message for step in result.steps]


def test_what_was_allowed_outside_is_still_allowed_after_an_inner_block(tmp_path):
    steps = f"""
    - add_object: {SLAB.replace("static: true,", "static: true, in: planning,")}
    - allow_collisions:
        pairs: [[robot, slab]]
        during:
          - allow_collisions: {{pairs: [[robot, slab]], during: [{{wait: 0.01}}]}}
          - move_to: {IN_THE_TABLE}
    """
    result, _ = run(tmp_path, steps)
    assert result.outcome == "passed", [step.message for step in result.steps]


def test_a_step_without_duration_is_judged_at_its_one_sample(tmp_path):
    steps = """
    - clear_objects: {}
      expect:
        - named_target: home
        - duration: {at_most: 0.001}
        - always: within_limits
        - static: {for: 0.1 s}
    """
    result, _ = run(tmp_path, steps, robot="{model: ur3e, start_state: home}")
    (failure,) = failures(result)
    assert failure.startswith(
        "not reached: everything is static, for 0.1 s: what stands still is known after 50 ms"
    )


@pytest.mark.nightly
def test_a_run_that_would_take_too_long_ends_with_the_limit(tmp_path):
    """At a time step of 20 ms: the limit is of time, not of samples. The ball falls slowly."""
    (tmp_path / "coarse.yaml").write_text(
        "world: coarse\nphysics: {timestep: 0.02, gravity: [0, 0, -0.001]}\n"
        "objects: [{name: ball, sphere: {radius: 0.1}, pose: {xyz: [2, 0, 1.0e+3]}}]\n"
    )
    steps = "- settle: {max_velocity: 1 um/s}\n  timeout: 1 hour"
    result, _ = run(tmp_path, steps, robot="{gripper: rh_p12_rn_a}", world="coarse.yaml")
    (step,) = result.steps
    assert step.error_code == "TIMED_OUT"
    assert "it may take 600 s of simulated time" in step.message
    assert step.sim_time == 600.0


def test_a_step_that_takes_longer_than_its_timeout_fails_whatever_it_is_made_of(tmp_path):
    steps = """
    - wait: 1 s
      timeout: 0.5 s
      expect_error: TIMED_OUT
    - gripper: closed
      timeout: 0.1 s
      expect_error: TIMED_OUT
    - allow_collisions: {pairs: [[robot, robot]], during: [wait: 0.3 s, wait: 0.3 s]}
      timeout: 0.5 s
      expect_error: TIMED_OUT
    - wait: 0.2 s
      timeout: 0.2 s
    - wait: 0.503 s
      timeout: 0.5 s
      expect_error: TIMED_OUT
    - wait: 90 ms
      timeout: 50 ms
      expect_error: TIMED_OUT
    """
    result, _ = run(tmp_path, steps, robot="{gripper: rh_p12_rn_a}")
    assert result.outcome == "passed", [step.message for step in result.steps]
    messages = [step.message for step in result.steps if step.status == "expected error"]
    assert messages[0] == "the step took 1.000 s, its timeout is 0.5 s"
    assert messages[1].startswith("'rh_r1_joint' is at ")
    assert messages[2:] == [
        "the step took 0.600 s, its timeout is 0.5 s",
        "the step took 0.503 s, its timeout is 0.5 s",
        "the step took 0.090 s, its timeout is 0.05 s",
    ]


@pytest.mark.parametrize(
    ("step", "timeout"), [("gripper: {width: 50 mm}", 0.333), ("settle: {}", 0.052)]
)
def test_a_step_that_waits_ends_with_its_timeout(tmp_path, step, timeout):
    steps = f"""
    - {step}
      timeout: {timeout} s
      expect_error: TIMED_OUT
    """
    result, _ = run(tmp_path, steps, robot="{gripper: rh_p12_rn_a}")
    assert result.steps[0].sim_time == pytest.approx(timeout, abs=1e-9)


@pytest.mark.nightly(but=["0.2004-0.2"])
@pytest.mark.parametrize(("seconds", "timeout"), [(0.2, 0.2), (0.2004, 0.2), (0.3, 0.2996)])
def test_the_rounding_of_a_step_to_samples_is_no_timeout(tmp_path, seconds, timeout):
    result, _ = run(tmp_path, f"\n- wait: {seconds} s\n  timeout: {timeout} s\n")
    assert result.outcome == "passed"


def test_the_memory_of_a_run_is_free_without_the_collector(tmp_path, monkeypatch):
    """It would look at all objects of the process, which takes half as long as a short run."""
    made = []

    class Watched(MujocoSimulator):
        def __init__(self, *words, **more):
            super().__init__(*words, **more)
            made.append(weakref.ref(self))

    monkeypatch.setattr(mujoco_simulator, "MujocoSimulator", Watched)
    file = file_of(tmp_path, "- inject: {gripper_effort: 0.5}\n- gripper: closed")
    gc.disable()
    try:
        assert run_case(file).outcome == "passed"
        [simulator] = made
        assert simulator() is None
    finally:
        gc.enable()
