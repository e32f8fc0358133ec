"""A robot without a gripper, without named states, or whose files are exchanged, says so."""

import pytest

from harness.cli.main import main
from tests.session.front_door import check

LINK = """<link name="%s"><inertial><mass value="0.1"/>
<inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
URDF = """<robot name="claw">
<link name="base"/>LINKS
<joint name="j1" type="revolute"><parent link="base"/><child link="hand"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" velocity="1" effort="9"/></joint>
<joint name="l" type="prismatic"><parent link="hand"/><child link="left"/><axis xyz="0 1 0"/>
<limit lower="0" upper="0.04" velocity="1" effort="9"/></joint>
<joint name="r" type="prismatic"><parent link="hand"/><child link="right"/><axis xyz="0 1 0"/>
<limit lower="0" upper="0.04" velocity="1" effort="9"/><mimic joint="l"/></joint></robot>
""".replace("LINKS", "".join(LINK % each for each in ("hand", "left", "right")))
SRDF = """<robot name="claw"><group name="arm"><chain base_link="base" tip_link="hand"/></group>
<group name="gripper"><joint name="l"/></group>
<end_effector name="e" parent_link="hand" group="gripper"/></robot>
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A claw whose fingers move the same way, and no named state."""
    (tmp_path / "claw.urdf").write_text(URDF)
    (tmp_path / "claw.srdf").write_text(SRDF)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def found(folder, steps, robot="{urdf: claw.urdf, srdf: claw.srdf}"):
    return [(each.message, each.hint) for each in check(folder, steps, robot=robot).problems]


def test_a_step_that_needs_a_gripper_says_why_there_is_none(folder):
    for step in ("gripper: open", "grasp: part"):
        hints = [hint for message, hint in found(folder, f"- {step}") if "gripper, and" in message]
        assert hints
        assert all("'gripper' is not used as a gripper: " in each for each in hints)


@pytest.mark.parametrize("step", ["move_to: ready", "ptp: ready"])
def test_a_group_without_named_states_says_so(folder, step):
    [(message, hint)] = found(folder, f"- {step}")
    assert message == "there is no named state 'ready': the group 'arm' has no named states"
    assert "write joint positions" in hint


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("arguments", [("claw.srdf", "--srdf", "claw.urdf"), ("claw.srdf",)])
def test_exchanged_files_are_recognised_at_the_command_line(capsys, arguments):
    assert main(["robot", "check", *arguments]) == 2
    said = " ".join(capsys.readouterr().err.split())
    assert "claw.srdf:1:2: this is an SRDF" in said
    assert "its links and joints are in a URDF" in said


def test_exchanged_files_are_recognised_in_a_scenario(folder):
    robot = "{urdf: claw.srdf, srdf: claw.urdf}"
    [(message, _)] = found(folder, "- wait: 1 s", robot)
    assert message == "this is an SRDF"
