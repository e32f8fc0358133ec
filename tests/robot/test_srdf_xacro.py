"""An SRDF in xacro format is rendered with the robot's arguments, as MoveIt configurations do."""

import pytest

from harness.cli.main import main
from harness.core.errors import RobotError, SpecError
from tests.robot.arm_files import SRDF, load_arm, write_arm
from tests.robot.test_xacro import HEAD
from tests.robot.test_xacro import write as write_xacro_arm

MACRO = (
    HEAD
    + """  <xacro:macro name="arm_srdf" params="prefix bend">
    <group name="${prefix}manipulator"><chain base_link="base_link" tip_link="tool"/></group>
    <group_state name="home" group="${prefix}manipulator">
      <joint name="bend" value="${bend}"/>
    </group_state>
    <disable_collisions link1="upper" link2="wrist" reason="Never"/>
  </xacro:macro>
</robot>
"""
)
CALL = (
    HEAD
    + """  <xacro:arg name="prefix" default=""/>
  <xacro:include filename="$(find arm_moveit_config)/srdf/arm_macro.srdf.xacro"/>
  <xacro:arm_srdf prefix="$(arg prefix)" bend="${pi / 4}"/>
</robot>
"""
)


def write_config(folder, call=CALL):
    """A description and a MoveIt configuration as two packages of one workspace."""
    write_arm(folder)
    config = folder / "arm_moveit_config"
    (config / "srdf").mkdir(parents=True)
    (config / "package.xml").write_text("<package><name>arm_moveit_config</name></package>")
    (config / "srdf" / "arm.srdf.xacro").write_text(call, encoding="utf-8")
    (config / "srdf" / "arm_macro.srdf.xacro").write_text(MACRO, encoding="utf-8")


def load(folder, **options):
    return load_arm(folder, srdf="arm_moveit_config/srdf/arm.srdf.xacro", **options)


def test_groups_states_and_pairs_of_an_included_macro_are_read(tmp_path):
    write_config(tmp_path)
    arm = load(tmp_path)
    assert arm.groups["manipulator"].tip_link == "tool"
    assert arm.start_state["bend"] == pytest.approx(0.785398, abs=1e-6)
    assert arm.allowed_collisions["upper", "wrist"] == "Never"
    assert not any("longest chain" in note for note in arm.notes)


def test_the_srdf_takes_the_robots_arguments(tmp_path):
    write_config(tmp_path)
    assert list(load(tmp_path, args={"prefix": "left_"}).groups) == ["left_manipulator"]


def test_a_urdf_and_an_srdf_in_xacro_share_their_arguments(tmp_path):
    """Each file gets the arguments that it declares; one that neither declares is refused."""
    write_xacro_arm(tmp_path)
    srdf = (
        HEAD
        + """  <xacro:arg name="group" default="manipulator"/>
  <group name="$(arg group)"><chain base_link="base_link" tip_link="lower"/></group>
</robot>"""
    )
    (tmp_path / "arm.srdf.xacro").write_text(srdf, encoding="utf-8")
    words = {"urdf": None, "xacro": "arm.xacro", "srdf": "arm.srdf.xacro", "packages": ["."]}
    arm = load_arm(tmp_path, **words, args={"group": "main", "length": 0.31})
    assert list(arm.groups) == ["main"]
    assert arm.joint_by_name["upper_joint"].pose.translation[2] == pytest.approx(0.31)


def test_an_argument_that_no_file_declares_is_refused(tmp_path):
    write_arm(tmp_path)
    text = SRDF.replace('<robot name="three">', HEAD.splitlines()[1])
    text = text.replace("</robot>", '<xacro:arg name="prefix" default=""/></robot>')
    (tmp_path / "arm.srdf").write_text(text, encoding="utf-8")
    with pytest.raises(RobotError, match=r"arm\.srdf takes no argument 'prefx'; known are prefix"):
        load_arm(tmp_path, args={"prefx": 1})


def test_a_mistake_in_an_included_macro_is_located_there(tmp_path):
    write_config(tmp_path)
    macro = tmp_path / "arm_moveit_config/srdf/arm_macro.srdf.xacro"
    macro.write_text(MACRO.replace('tip_link="tool"', 'tip_link="toool"'), encoding="utf-8")
    with pytest.raises(SpecError) as caught:
        load(tmp_path)
    assert caught.value.problems[0].path.endswith("arm_macro.srdf.xacro")
    assert caught.value.problems[0].line == 4


def test_an_srdf_without_a_group_is_reported(tmp_path):
    """A macro that is never called renders to an SRDF without groups."""
    write_config(tmp_path)
    arm = load_arm(tmp_path, srdf="arm_moveit_config/srdf/arm_macro.srdf.xacro")
    assert any("defines arm_srdf; the file that calls" in note for note in arm.notes)
    assert "SRDF: no groups; 'arm' is the longest chain" in arm.notes


def test_the_command_line_takes_an_srdf_in_xacro(tmp_path, capsys, monkeypatch):
    write_config(tmp_path)
    monkeypatch.chdir(tmp_path)
    options = ["--srdf", "arm_moveit_config/srdf/arm.srdf.xacro", "--args", "prefix=left_"]
    assert main(["robot", "check", "--samples", "100", "arm.urdf", *options]) == 0
    assert "left_manipulator (the arm): 3 joints" in capsys.readouterr().out
