"""Injected faults: what they do to a run, and that a fault without effect is reported."""

from pathlib import Path

import pytest

from harness.recording.read_run import read_run
from tests.running import run_case
from tests.session.front_door import problems, run

ROOT = Path(__file__).parents[2]
HOME = "- move_to: mogi_home\n"


def receipts(saved):
    return {
        (fault["fault"], fault["target"]): (fault["receipt"], fault["evidence"])
        for step in saved.steps
        for fault in step.result.plain().get("faults", ())
    }


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["weak_grip", "stalled_joint", "bumped_box"])
def test_a_bundled_fault_lands_and_its_scenario_passes(name, tmp_path):
    path = ROOT / f"scenarios/faults/{name}.scenario.yaml"
    result = run_case(path, report_dir=tmp_path / "r", stills=False, page=False)
    assert result.outcome == "passed", result.verdicts
    saved = read_run(tmp_path / "r").run
    assert {receipt for receipt, _ in receipts(saved).values()} == {"landed"}
    assert not [f for f in saved.findings if f.kind == "fault_without_effect"]


def test_faults_that_change_nothing_are_findings_with_their_reason(tmp_path):
    result, saved = run(
        tmp_path,
        """
        - settle: {}  # while contacts take the weight, a push may move the box by a micrometre
        - inject:
            friction: {green_cylinder: 0.1, red_box: 30}
            gripper_effort: 0.5
            joint_stall: wrist_3_joint
            command_latency: 20 ms
            push: {red_box: [0.1 N, 0, 0]}
        - wait: 0.2 s
        """,
        world="lesson_ur",
    )
    assert result.outcome == "passed"
    assert receipts(saved) == {
        ("friction", "green_cylinder"): ("no_effect", "nothing pulled at it afterwards"),
        ("friction", "red_box"): ("no_effect", "it was so already"),
        ("gripper_effort", "rh_r1_joint"): (
            "no_effect",
            "the gripper pressed on nothing afterwards",
        ),
        ("joint_stall", "wrist_3_joint"): ("no_effect", "it was not commanded to move afterwards"),
        ("command_latency", ""): ("no_effect", "no joint was commanded to move afterwards"),
        ("push", "red_box"): ("no_effect", "it did not move: friction or a hand held it"),
    }
    reported = [f.message for f in saved.findings if f.kind == "fault_without_effect"]
    assert "push of red_box had no effect: it did not move: friction or a hand held it" in reported
    assert len(reported) == 6


@pytest.mark.nightly
def test_a_fault_that_is_set_back_in_time_had_no_effect(tmp_path):
    """What happens after it was set back is none of its doing."""
    _, saved = run(
        tmp_path,
        HOME
        + """- inject: {friction: {green_cylinder: 0.02}, gripper_effort: 0.1, sensor_noise: 1 deg,
            command_latency: 20 ms}
- inject: {friction: {green_cylinder: 1}, gripper_effort: 1, sensor_noise: 0, command_latency: 0}
- pick: green_cylinder
""",
        world="lesson_ur",
    )
    broke, repaired = (step.result.plain()["faults"] for step in saved.steps[1:3])
    assert {fault["fault"]: (fault["receipt"], fault["evidence"]) for fault in broke} == {
        "friction": ("no_effect", "nothing pulled at it before it was set again"),
        "gripper_effort": ("no_effect", "the gripper pressed on nothing before it was set again"),
        "sensor_noise": ("no_effect", "no time passed before it was set again"),
        "command_latency": ("no_effect", "no joint was commanded to move before it was set again"),
    }
    assert {fault["receipt"] for fault in repaired} == {"landed"}
    reported = [found for found in saved.findings if found.kind == "fault_without_effect"]
    assert len(reported) == 4


def test_pushes_of_one_step_are_at_the_same_time(tmp_path):
    _, saved = run(
        tmp_path,
        "- inject: {push: {a: [0, 0.1, 0], b: [0, -0.1, 0]}, push_duration: 80 ms}",
        rest="""
        objects:
          - {name: a, box: {size: [0.03, 0.03, 0.03]}, mass: 50 g, friction: 0.01,
             pose: {xyz: [0.5, 0.4, 0.015]}}
          - {name: b, box: {size: [0.03, 0.03, 0.03]}, mass: 50 g, friction: 0.01,
             pose: {xyz: [0.5, -0.4, 0.015]}}
        """,
    )
    assert saved.steps[0].end_time == pytest.approx(0.08)
    went = {name: saved.signals.object_poses[name][:, 1] for name in "ab"}
    assert went["a"][-1] - went["a"][0] > 0.004
    assert went["a"] - 0.4 == pytest.approx(-(went["b"] + 0.4), abs=1e-5)
    assert {receipt for receipt, _ in receipts(saved).values()} == {"landed"}


@pytest.mark.nightly
def test_large_encoder_noise_stops_the_arm_and_small_noise_repeats_to_the_bit(tmp_path):
    lift = "- move_relative: {direction: {xyz: [0, 0, 1]}, distance: 0.05}"
    steps = HOME + "- inject: {sensor_noise: %s}\n" + lift
    result, _ = run(tmp_path, steps % "0.3 rad")
    assert [step.error_code for step in result.steps][-1] == "CONTROL_FAILED"
    first, saved = run(tmp_path, steps % "0.05 deg")
    again, _ = run(tmp_path, steps % "0.05 deg")
    assert first.outcome == "passed"
    assert first.digest == again.digest
    assert receipts(saved)[("sensor_noise", "")][0] == "landed"


@pytest.mark.nightly
def test_late_commands_make_the_arm_lag_by_the_latency(tmp_path):
    steps = "{}- ptp: {{joints: {{shoulder_pan_joint: 1.0}}}}"
    lags = {}
    for latency in ("", "- inject: {command_latency: 20 ms}\n"):
        _, saved = run(tmp_path, steps.format(latency))
        signals = saved.signals
        lag = signals.joint_commands[:, 0] - signals.joint_positions[:, 0]
        fastest = abs(signals.joint_command_velocities[:, 0]).max()
        lags[bool(latency)] = abs(lag).max() / fastest
    assert lags[False] < 0.001
    assert lags[True] == pytest.approx(0.020, abs=0.001)


def test_a_stalled_joint_does_not_move_whatever_its_motor_does(tmp_path):
    _, saved = run(
        tmp_path,
        HOME + "- inject: {joint_stall: elbow_joint}\n"
        "- ptp: {joints: {elbow_joint: 0}}\n  expect_error: CONTROL_FAILED",
    )
    stalled = saved.steps[2]
    joint = saved.robot.joint_index["elbow_joint"]
    rows = saved.signals.joint_positions[stalled.start_index : stalled.end_index, joint]
    assert rows.max() - rows.min() < 1e-4


def test_mistakes_in_a_fault_are_reported_where_they_stand(tmp_path):
    assert problems(tmp_path, "- inject: {}")[0][0] == 5
    found = problems(
        tmp_path,
        """
        - inject: {push: {Table_0: [1, 0, 0]}}
        - inject: {joint_stall: elbow}
        - inject: {friction: {green_cilinder: 0.1}}
        - inject: {joint_stall: rh_l1_joint}
        """,
        world="lesson_ur",
    )
    assert [line for line, _ in found] == [5, 6, 7, 8]
    assert "'Table_0' is static" in found[0][1]
