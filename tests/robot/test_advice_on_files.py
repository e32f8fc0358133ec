"""Messages on robots' files lead to what helps."""

import pytest

from harness.core.errors import SpecError
from harness.language.scenario import RobotSpec
from harness.robot.load import load_robot
from tests.session.front_door import check

ARM = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
<link name="base"/>
{parts}
</robot>
"""
LIMB = """<xacro:macro name="limb" params="n on">
<link name="l${{n}}">{link}</link>
<joint name="j${{n}}" type="revolute"><parent link="${{on}}"/><child link="l${{n}}"/>
<axis xyz="0 0 1"/>{joint}</joint></xacro:macro>
<xacro:limb n="1" on="base"/><xacro:limb n="2" on="l1"/><xacro:limb n="3" on="l2"/>"""
LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
LINK = f"""<link name="tip">{{inside}}</link><joint name="turn" type="revolute">
<parent link="base"/><child link="tip"/><axis xyz="0 0 1"/>{LIMIT}</joint>"""
MESH = '<collision><geometry><mesh filename="{}"/></geometry></collision>'


def load(folder, parts):
    (folder / "arm.xacro").write_text(ARM.format(parts=parts))
    return load_robot(RobotSpec.model_validate({"xacro": "arm.xacro"}), folder)


@pytest.mark.parametrize(
    ("link", "joint", "messages"),
    [
        ("", LIMIT.replace('"-1"', '"{-2*pi}"'), ["'{-2*pi}' is not a finite number"]),
        ('<inertial><mass value="-2"/></inertial>', LIMIT, ["link 'l1' weighs -2 kg"]),
        (
            '<inertial><mass value="x"/></inertial>',
            "",
            ["'x' is not a finite number", "joint 'j1' is revolute and has no <limit>"],
        ),
    ],
)
def test_a_mistake_in_a_macro_is_reported_once_and_with_the_others(tmp_path, link, joint, messages):
    with pytest.raises(SpecError) as caught:
        load(tmp_path, LIMB.format(link=link, joint=joint))
    assert [each.message for each in caught.value.problems] == messages


@pytest.mark.parametrize("name", ["file:///home/ws/a.stl", "/home/maker/a.stl", "../gone/a.stl"])
def test_a_mesh_of_another_machine_is_not_sought_with_an_option(tmp_path, name):
    with pytest.raises(SpecError) as caught:
        load(tmp_path, LINK.format(inside=MESH.format(name)))
    [problem] = caught.value.problems
    assert "is a path of another machine" in problem.message
    assert "--package-path" not in problem.sentence


def test_a_mesh_next_to_the_robots_folder_is_offered_with_an_option(tmp_path):
    (tmp_path / "meshes").mkdir()
    (tmp_path / "arm").mkdir()
    (tmp_path / "meshes" / "a.stl").write_text("")
    with pytest.raises(SpecError, match="--package-path"):
        load(tmp_path / "arm", LINK.format(inside=MESH.format("../meshes/a.stl")))


@pytest.mark.parametrize(
    ("inside", "hint"),
    [
        ('<origin xyz="0 0 0"/>', "it belongs to <inertial>, <visual>, <collision>, <joint>"),
        ('<mass value="1"/>', "it belongs to <inertial>"),
        ("<geometry/>", "it belongs to <visual>, <collision>"),
        ("<wheel_inertia/>", "a macro would be called as <xacro:wheel_inertia>"),
    ],
)
def test_an_element_in_the_wrong_place_is_sent_where_it_belongs(tmp_path, inside, hint):
    notes = load(tmp_path, LINK.format(inside=inside)).notes
    assert any(hint in note and "in <link> ignored" in note for note in notes)


@pytest.mark.parametrize(
    "step", ["allow_collisions: {pairs: [[robot, any]]}", "comply: {stiffness: 500}"]
)
def test_a_missing_block_is_said_to_be_a_list_of_steps(tmp_path, step):
    hints = [each.hint for each in check(tmp_path, f"- {step}").problems]
    assert "add `during:` with a list of steps" in hints
