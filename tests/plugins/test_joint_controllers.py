"""A third-party joint controller moves the arm, and nothing that is judged depends on its word."""

import json

import pytest

from tests.plugins.commands import MODULES, harness

SCENARIO = """\
scenario: a controller
robot: {model: ur3e, joint_controller: computed_torque}
steps:
  - move_to: {joints: {shoulder_pan_joint: 0.3, elbow_joint: 0.8}}
  - inject: {sensor_noise: 0.01 deg}
  - wait: 50 ms
expect:
  - tracking_error: 0.5 deg
"""
CONTROLLERS = ("--plugin", MODULES / "controllers.py")
WRONG = '''
import numpy as np
from harness.ports import ControlRequest, ControlResult, JointController


class Mine(JointController):
    """A controller under test."""

    name = "mine"
    period = 0.01

    def control(self, request: ControlRequest) -> ControlResult:
        return {answer}
'''


@pytest.fixture
def scenario(tmp_path):
    """The folder of a scenario that names a controller."""
    (tmp_path / "move.scenario.yaml").write_text(SCENARIO, encoding="utf-8")
    return tmp_path


def digest(folder, *options):
    out = harness(folder, "run", "move.scenario.yaml", *CONTROLLERS, "-v", "--no-report", *options)
    return out.split("digest ")[1].split()[0]


@pytest.mark.nightly
def test_a_controller_follows_with_noise_and_its_run_repeats(scenario):
    first = digest(scenario)
    assert digest(scenario) == first
    assert digest(scenario, "--set", "robot.joint_controller=position_servo") != first


@pytest.mark.nightly
def test_an_arm_that_leaves_its_tolerances_fails_and_the_plug_in_is_named(scenario):
    out = harness(
        scenario, "run", "move.scenario.yaml", *CONTROLLERS,
        "--set", "robot.joint_controller=wrong_sign", code=1,
    )  # fmt: skip
    assert "CONTROL_FAILED: wrist_3_joint lags" in out
    assert "correct the plug-in `wrong_sign`, or leave out `joint_controller`" in out
    (file,) = scenario.glob("reports/**/run.json")
    assert json.loads(file.read_text())["verdicts"][0]["status"] == "failed"


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        ("1 / 0", "ZeroDivisionError: division by zero (mine.py:13)"),
        ("ControlResult(np.zeros(3))", "ValueError"),
        ("ControlResult(np.full(6, np.nan))", "returned efforts that are no finite numbers"),
        ("None", "AttributeError"),
    ],
)
def test_a_controller_that_breaks_fails_the_step(scenario, answer, reason):
    (scenario / "mine.py").write_text(WRONG.format(answer=answer), encoding="utf-8")
    out = harness(
        scenario, "run", "move.scenario.yaml", "--plugin", "mine.py", "--no-report",
        "--set", "robot.joint_controller=mine", code=1,
    )  # fmt: skip
    assert "CONTROL_FAILED: the joint controller `mine` of the package `mine`" in out
    assert reason in out


@pytest.mark.nightly(but=["check"])
@pytest.mark.parametrize("command", ["run", "check"])
def test_a_controller_that_fails_at_the_start_is_a_mistake_of_the_file(scenario, command):
    source = WRONG.replace("    period = 0.01\n", "").format(answer="1 / 0")
    (scenario / "mine.py").write_text(source, encoding="utf-8")
    out = harness(
        scenario, command, "move.scenario.yaml", "--plugin", "mine.py",
        "--set", "robot.joint_controller=mine", code=2,
    )  # fmt: skip
    assert "move.scenario.yaml:2:8: the joint controller `mine` of the package `mine`" in out
    assert "ZeroDivisionError" in out
