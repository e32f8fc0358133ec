"""`harness new --robot`: a scenario for whatever robot, which then passes."""

import json
import re
from importlib.metadata import PathDistribution
from pathlib import Path

import pytest

from harness.cli.main import main
from harness.language.reading.load import load_scenario
from harness.plugins.authoring import first_scenario
from harness.plugins.authoring.first_scenario import _trouble
from harness.plugins.authoring.new_project import requirement_lines
from tests.robot.arm_files import SRDF, URDF, write_arm
from tests.robot.hands import (
    FIVE_WITH_TURNING_JAW,
    JAW,
    SIX,
    SIX_SRDF,
    SIX_WITH_JAW,
    SIX_WITH_TURNING_JAW,
)

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
    assert "it was run once and passed" in capsys.readouterr().out
    code, said = runs(capsys)
    assert code == 0, said


@pytest.mark.nightly
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


@pytest.mark.nightly
def test_a_motion_says_why_it_is_no_pick_and_that_it_passed(capsys):
    new("arm.urdf", "--srdf", "arm.srdf")
    said = capsys.readouterr().out
    assert "it is a motion and no pick: no joint that the arm carries closes two sides" in said
    assert "it was run once and passed" in said


@pytest.mark.nightly
@pytest.mark.parametrize(
    "urdf",
    [SIX, SIX_WITH_JAW, SIX_WITH_TURNING_JAW, FIVE_WITH_TURNING_JAW],
    ids=["fingers", "jaw", "turning jaw", "turning jaw of five joints"],
)
def test_a_gripper_without_an_srdf_gets_a_pick_that_passes(capsys, folder, urdf):
    write_arm(folder, urdf)
    assert new("arm.urdf").steps[0].verb == "pick"
    code, said = runs(capsys)
    assert code == 0, said


@pytest.mark.nightly
def test_what_is_in_reach_on_the_floor_alone_is_picked_there(capsys, folder):
    """The wrist bends by 66 degrees, so that the hand points down only near the floor."""
    wrist = 'name="e_joint"(.*?)lower="-3" upper="3"'
    bends = re.sub(wrist, r'name="e_joint"\1lower="-1.15" upper="1.15"', SIX, count=1)
    assert bends != SIX
    write_arm(folder, bends, SIX_SRDF)
    scenario = new("arm.urdf", "--srdf", "arm.srdf")
    assert (scenario.steps[0].verb, [each.name for each in scenario.objects]) == ("pick", ["box"])
    assert "it was run once and passed" in capsys.readouterr().out


@pytest.mark.nightly
def test_an_arm_far_from_the_root_of_its_robot_picks_too(capsys, folder):
    """Places for the box are measured from the link that carries the arm."""
    cell = (
        '<link name="cell"/><joint name="mount" type="fixed"><parent link="cell"/>'
        '<child link="base_link"/><origin xyz="0 3 1.5"/></joint>'
    )
    write_arm(folder, SIX.replace("</robot>", cell + "</robot>"), SIX_SRDF)
    scenario = new("arm.urdf", "--srdf", "arm.srdf")
    assert scenario.steps[0].verb == "pick"
    assert scenario.objects[1].pose.xyz[1] > 2
    assert "it was run once and passed" in capsys.readouterr().out


@pytest.mark.nightly
def test_the_box_is_as_heavy_as_the_fingers_can_hold(capsys, folder):
    weak = SIX.replace('effort="40"', 'effort="1.5"')
    assert weak != SIX
    write_arm(folder, weak, SIX_SRDF)
    assert new("arm.urdf", "--srdf", "arm.srdf").objects[1].mass == 0.02
    assert "it was run once and passed" in capsys.readouterr().out


def test_a_hand_that_does_not_close_is_named(capsys, folder):
    still = JAW.replace("0 1 0", "0 0 1")
    assert still != JAW
    write_arm(folder, SIX_WITH_JAW.replace(JAW, still))
    assert new("arm.urdf").steps[0].verb == "move_to"
    assert "no pick: 'gripper' is not used as a gripper: the gap" in capsys.readouterr().out


@pytest.mark.nightly(but=["0-none of 1 picks"])
@pytest.mark.parametrize(("seconds", "tried"), [(0, "none of 1 picks"), (600, "none of 19 picks")])
def test_no_pick_is_tried_after_its_time(tmp_path, capsys, monkeypatch, seconds, tried):
    def trouble(text, candidate):
        return ("out of reach", False) if "pick:" in text else _trouble(text, candidate)

    monkeypatch.setattr(first_scenario, "_trouble", trouble)
    monkeypatch.setattr(first_scenario, "PICK_SECONDS", seconds)
    assert main(["new", str(tmp_path / "a.scenario.yaml"), "--robot", "open_manipulator_x"]) == 0
    said = capsys.readouterr().out
    assert f"no pick: {tried} passes; the last: out of reach" in said
    assert "it was run once and passed" in said


@pytest.mark.nightly
@pytest.mark.parametrize("start", ["1.23456789", "-1.23456789"])
def test_goals_stay_inside_limits_that_rounding_would_exceed(capsys, folder, start):
    """The robot starts on a limit of many digits."""
    limits = 'lower="-1.23456789" upper="1.23456789"'
    urdf = URDF.replace('lower="-2" upper="2"', limits)
    assert urdf != URDF
    write_arm(folder, urdf, SRDF.replace('"bend" value="0.7"', f'"bend" value="{start}"'))
    scenario = new("arm.urdf", "--srdf", "arm.srdf")
    assert all(abs(step.joints["bend"]) < 1.2345 for step in scenario.steps)
    code, said = runs(capsys)
    assert code == 0, said


@pytest.mark.nightly
@pytest.mark.parametrize("bend", ["3.1", "2.9"])
def test_a_robot_that_starts_in_collision_gets_a_start_that_is_free(capsys, folder, bend):
    """All joints at zero, or the only named state, is in collision."""
    srdf = SIX_SRDF.replace(
        "</robot>",
        '<group_state name="home" group="manipulator">'
        f'<joint name="c_joint" value="{bend}"/></group_state>'
        '<disable_collisions link1="left" link2="right" reason="Never"/></robot>',
    )
    box = '<collision><geometry><box size="0.08 0.08 0.1"/></geometry></collision>'
    urdf = SIX
    for link in ("b", "c", "d"):
        urdf = urdf.replace(f'<link name="{link}">', f'<link name="{link}">{box}')
    write_arm(folder, urdf, srdf)
    scenario = new("arm.urdf", "--srdf", "arm.srdf")
    assert scenario.robot.start_state is not None
    code, said = runs(capsys)
    assert code == 0, said


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--srdf", "arm.srdf"], "--srdf goes with --robot"),
        (["--robot", "ur3f"], "'ur3f' is not known; did you mean `ur3`?"),
        (["--robot", "a.scenario.yaml"], "--robot is a robot, and 'a.scenario.yaml' a scenario"),
        (["--robot", "arm.urdf", "--gripper", "hand"], "robot.gripper: 'hand' is not known"),
    ],
)
def test_wrong_words_are_exit_code_2_and_leave_nothing(arguments, said, folder, capsys):
    assert main(["new", str(FILE), *arguments]) == 2
    assert said in capsys.readouterr().err
    assert not (folder / "sub").exists()


@pytest.mark.nightly
def test_the_first_line_names_the_schema_for_editors_which_is_there(tmp_path):
    assert main(["new", "a.scenario.yaml"]) == 0
    bundled = schema_of("a.scenario.yaml")
    assert Path(bundled).is_absolute()
    assert json.loads(Path(bundled).read_text())["title"]
    (tmp_path / "scenario.schema.json").write_text("{}")
    assert main(["new", "b.scenario.yaml"]) == 0
    assert schema_of("b.scenario.yaml") == "scenario.schema.json"
    assert main(["new", str(FILE), "--robot", "arm.urdf", "--srdf", "arm.srdf"]) == 0
    assert schema_of(FILE) == "../scenario.schema.json"
    assert main(["check", "a.scenario.yaml", str(FILE)]) == 0


def schema_of(file):
    first = Path(file).read_text(encoding="utf-8").splitlines()[0]
    return first.partition("# yaml-language-server: $schema=")[2]


def test_a_project_is_written_whole_or_not_at_all(tmp_path, capsys):
    before = sorted(each.name for each in tmp_path.iterdir())
    assert main(["new", "--project", "cell", "--robot", "no_such_robot"]) == 2
    (tmp_path / "taken").mkdir()
    assert main(["new", "--project", "taken"]) == 2
    assert "'taken' exists already" in capsys.readouterr().err
    assert main(["new"]) == main(["new", "a.scenario.yaml", "--project", "cell"]) == 2
    assert sorted(each.name for each in tmp_path.iterdir()) == [*before, "taken"]


def test_a_project_of_a_robot_names_its_files_from_the_scenario(tmp_path, capsys):
    arguments = ["--robot", "arm.urdf", "--srdf", "arm.srdf"]
    assert main(["new", "--project", "work/cell", *arguments]) == 0
    file = tmp_path / "work/cell/scenarios/first.scenario.yaml"
    scenario = load_scenario(file).scenario
    assert scenario.robot.urdf == "../../../arm.urdf"
    assert schema_of(file) == "../scenario.schema.json"
    assert "harness run scenarios --baseline margins.json" in capsys.readouterr().out
    assert main(["check", str(tmp_path / "work/cell")]) == 0


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(
    ("robot", "said"),
    [
        (["arm.urdf", "--srdf", "arm.srdf"], "../../arm.urdf, ../../arm.srdf are outside; "),
        (["arm.urdf", "--package-path", "."], "../../arm.urdf, ../.. are outside; "),
        (["open_manipulator_x"], ""),
    ],
)
def test_a_project_names_the_robots_files_that_a_pipeline_would_lack(capsys, robot, said):
    assert main(["new", "--project", "cell", "--robot", *robot]) == 0
    printed = capsys.readouterr().out
    assert said in printed
    assert bool(said) == ("copy the robot into it" in printed)


def test_the_requirements_name_the_repository_that_the_program_was_installed_from(monkeypatch):
    origin = {"url": "https://host/x.git", "vcs_info": {"vcs": "git", "commit_id": "ab12"}}
    monkeypatch.setattr(PathDistribution, "read_text", lambda _self, _name: json.dumps(origin))
    assert requirement_lines().endswith("\narmharness[meshes] @ git+https://host/x.git@ab12\n")
    monkeypatch.setattr(PathDistribution, "read_text", lambda _self, _name: '{"url": "file:///c"}')
    assert requirement_lines().endswith("\narmharness[meshes] @ file:///c\n")
    monkeypatch.setattr(PathDistribution, "read_text", lambda _self, _name: None)
    assert requirement_lines().endswith("\narmharness[meshes]\n")
