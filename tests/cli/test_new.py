"""`harness new --robot`: a scenario for whatever robot, which then passes."""

from pathlib import Path

import pytest

from harness.cli.main import main
from harness.language.reading.load import load_scenario
from tests.robot.arm_files import write_arm

FILE = Path("sub/first.scenario.yaml")


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_arm(tmp_path)
    return tmp_path


def new(*arguments):
    assert main(["new", str(FILE), "--robot", *arguments]) == 0
    return load_scenario(FILE).scenario


def runs(capsys):
    code = main(["run", "--no-report", "--in-process", str(FILE)])
    return code, capsys.readouterr().out


def test_an_arm_with_a_gripper_gets_a_pick_that_passes(capsys):
    scenario = new("ur3e", "--gripper", "rh_p12_rn_a")
    assert scenario.steps[0].verb == "pick"
    assert "no steps were found" not in capsys.readouterr().out
    code, said = runs(capsys)
    assert code == 0, said


def test_an_arm_of_four_joints_gets_one_too(capsys):
    assert new("open_manipulator_x").steps[0].verb == "pick"
    code, said = runs(capsys)
    assert code == 0, said


def test_an_arm_without_a_gripper_gets_a_motion_and_its_files_are_found_from_the_new_one(capsys):
    scenario = new("arm.urdf", "--srdf", "arm.srdf", "--package-path", ".")
    assert (scenario.robot.urdf, scenario.robot.srdf) == ("../arm.urdf", "../arm.srdf")
    assert scenario.robot.packages == ("..",)
    assert [step.verb for step in scenario.steps] == ["move_to", "move_to"]
    code, said = runs(capsys)
    assert code == 0, said


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--srdf", "arm.srdf"], "--srdf goes with --robot"),
        (["--robot", "ur3f"], "'ur3f' is not known; did you mean 'ur3'?"),
        (["--robot", "a.scenario.yaml"], "--robot is a robot, and 'a.scenario.yaml' a scenario"),
        (["--robot", "arm.urdf", "--gripper", "hand"], "robot.gripper: 'hand' is not known"),
    ],
)
def test_wrong_words_are_exit_code_2_and_leave_nothing(arguments, said, folder, capsys):
    assert main(["new", str(FILE), *arguments]) == 2
    assert said in capsys.readouterr().err
    assert not (folder / "sub").exists()
