"""Placeholders that other tools load are left out, held or replaced, each with a note."""

import numpy as np
import pytest

from harness.core.errors import RobotError, SpecError
from harness.language.scenario import RobotSpec
from harness.robot.load import load_robot
from tests.robot.arm_files import INERTIAL, LIMIT, SHAPE, SRDF, URDF, load_arm, write_arm
from tests.session.front_door import run

TENSOR = '<inertia ixx="0.01" iyy="0.01" izz="0.002"/>'
END = "</robot>"


def load(folder, *changes, srdf=SRDF, **options):
    """The arm with replaced texts."""
    urdf = URDF
    for old, new in changes:
        assert old in urdf
        urdf = urdf.replace(old, new)
    write_arm(folder, urdf, srdf or SRDF)
    return load_arm(folder, srdf=srdf and "arm.srdf", **options)


def link(arm, name):
    return next(each for each in arm.links if each.name == name)


def noted(arm, *parts):
    """Whether one of the notes has all parts."""
    return any(all(part in note for part in parts) for note in arm.notes)


def leaf(name, parent, kind="prismatic", content=""):
    return (
        f'<link name="{name}">{content}</link><joint name="{name}_joint" type="{kind}">'
        f'<parent link="{parent}"/><child link="{name}"/><axis xyz="0 0 1"/>'
        '<limit lower="0" upper="0.1" effort="40" velocity="0.1"/></joint>'
    )


def test_empty_leaves_on_joints_get_a_gram_and_are_no_part_of_the_default_arm(tmp_path):
    leaves = leaf("width", "tool") + leaf("pan", "upper", "revolute") + leaf("pan2", "pan")
    arm = load(tmp_path, (END, leaves + END), srdf=None)
    assert noted(arm, "get 0.001 kg", "width", "pan", "pan2")
    assert arm.groups["arm"].joint_names == ("turn", "bend", "reach")
    assert arm.tcp_link == "tool"
    assert sum(each.inertial.mass for each in arm.links if each.inertial) == pytest.approx(4.003)


def test_a_leaf_that_states_zero_kilograms_is_an_empty_leaf(tmp_path):
    zero = '<inertial><mass value="0"/><inertia ixx="0" iyy="0" izz="0"/></inertial>'
    arm = load(tmp_path, (END, leaf("width", "tool", content=zero) + END))
    assert link(arm, "width").inertial.mass == 0.001


def test_an_arm_with_an_empty_leaf_moves_in_the_physics(tmp_path):
    write_arm(tmp_path, URDF.replace(END, leaf("width", "tool") + END))
    result, _ = run(
        tmp_path,
        "- move_to: {joints: {turn: 0.5, bend: 0.2}}",
        robot="{urdf: arm.urdf, srdf: arm.srdf}",
        rest="""
        expect:
          - always: within_limits
        """,
    )
    assert result.outcome == "passed", [step.message for step in result.steps]


def test_only_a_robot_of_frames_alone_weighs_grams(tmp_path):
    arm = load(tmp_path, (INERTIAL, ""), (SHAPE, ""), srdf=None)
    assert arm.groups["arm"].joint_names == ("turn", "bend", "reach")
    assert noted(arm, "get 0.001 kg, for they carry none: upper, lower, wrist")


@pytest.mark.parametrize("tensor", ["", '<inertia ixx="0" iyy="0" izz="0"/>', "<rod r='1'/>"])
def test_a_mass_without_a_tensor_gets_that_of_its_shapes(tmp_path, tensor):
    arm = load(tmp_path, (TENSOR, tensor))
    found = link(arm, "upper").inertial
    assert found.mass == 1
    assert found.inertia[2, 2] == pytest.approx(0.03**2 / 2)
    assert found.inertia[0, 0] == pytest.approx(0.03**2 / 4 + 0.14**2 / 12)
    assert noted(arm, "no inertia is given for upper, lower, wrist: that of their shapes at")
    assert noted(arm, "4 <rod> elements in <inertial>", "line 3 of arm.urdf") == ("rod" in tensor)


def test_unknown_parts_of_joints_and_links_are_named_with_their_lines(tmp_path):
    shape = '<collision><mesh_scale/><geometry><sphere radius="0.01"/></geometry></collision>'
    changes = (
        ("<axis", "<hardware/><axis"),
        ('<link name="tool"/>', f'<link name="tool">{shape}</link>'),
    )
    arm = load(tmp_path, *changes)
    assert noted(arm, "3 <hardware> elements in <joint> ignored, the first in line 9 of arm.urdf")
    assert noted(arm, "1 <mesh_scale> element in <collision> ignored, the first in line 7")


@pytest.mark.parametrize(("key", "value"), [("effort", "-1"), ("velocity", "-1"), ("effort", "0")])
def test_a_limit_of_zero_or_less_is_none(tmp_path, key, value):
    old = {"effort": 'effort="30"', "velocity": 'velocity="2"'}[key]
    arm = load(tmp_path, (old, f'{key}="{value}"'))
    assert noted(arm, f"joints turn, bend: the {key} limit of {value} counts as none")
    if key == "effort":
        assert arm.joint_by_name["bend"].effort == np.inf
    else:
        assert arm.joint_by_name["bend"].is_velocity_assumed


def control(joint, interface, low, high):
    return (
        f'<ros2_control name="c" type="system"><joint name="{joint}"><command_interface '
        f'name="{interface}"><param name="min">{low}</param><param name="max">{high}</param>'
        "</command_interface></joint></ros2_control>"
    )


@pytest.mark.parametrize(
    ("interface", "low", "high", "expected"),
    [
        ("velocity", 0, 0.8, 0.8),
        ("velocity", 0.1, 0.8, 0.8),
        ("velocity", 0, 0, 2.0),
        ("velocity", -0.5, 0, 0.5),
        ("effort", 0, 12, 12.0),
        ("effort", -3, 12, 3.0),
    ],
)
def test_the_magnitude_of_a_ros2_control_interface_is_its_max(
    tmp_path, interface, low, high, expected
):
    arm = load(tmp_path, (END, control("bend", interface, low, high) + END))
    assert getattr(arm.joint_by_name["bend"], interface) == expected
    for key, is_noted in (("min", low >= 0), ("max", high <= 0)):
        assert noted(arm, "joint bend: ", f"`{key}` of", interface) == is_noted


SOLID = '<cylinder radius="0.03" length="0.14"/>'


@pytest.mark.parametrize(
    "solid",
    [
        '<sphere radius="0"/>',
        '<box size="5 5 0"/>',
        '<cylinder radius="1" length="0"/>',
        '<box size="0 0 0"/>',
        '<capsule radius="0" length="1"/>',
        '<mesh filename="part.obj" scale="1 1 0"/>',
        '<box size="1 1 1e-12"/>',
    ],
)
@pytest.mark.parametrize("kind", ["visual", "collision"])
def test_a_shape_without_thickness_is_left_out(tmp_path, solid, kind):
    added = f"<{kind}><geometry>{solid}</geometry></{kind}>"
    arm = load(tmp_path, ('<link name="tool"/>', f'<link name="tool">{added}</link>'))
    assert link(arm, "tool").visuals == link(arm, "tool").collisions == ()
    word = solid.split()[0][1:]
    assert noted(arm, f"link 'tool': the <{word}> of a <{kind}> has no thickness and is left out")


def test_a_capsule_without_length_is_a_sphere(tmp_path):
    arm = load(tmp_path, (SOLID, '<capsule radius="0.03" length="0"/>'))
    assert type(link(arm, "upper").collisions[0].geometry).__name__ == "Sphere"


def test_a_negative_size_is_still_a_mistake(tmp_path):
    with pytest.raises(SpecError, match="radius is -1; it has to be above zero"):
        load(tmp_path, (SOLID, '<sphere radius="-1"/>'))


def test_a_joint_of_one_position_is_fixed_there_with_what_follows_it(tmp_path):
    held = LIMIT.replace('"-2" upper="2"', '"0.5" upper="0.5"')
    mimic = '<mimic joint="bend" multiplier="0.1" offset="0.02"/><limit lower="0"'
    (tmp_path / "moving").mkdir()
    srdf = SRDF.replace('<joint name="reach" value="0.05"/>', "")
    moving = load(tmp_path / "moving", srdf=srdf)
    arm = load(tmp_path, (LIMIT, held), ('<limit lower="0"', mimic), srdf=srdf)
    assert arm.joint_names == ("turn",)
    assert noted(arm, "are equal cannot move and are fixed: bend at 0.5")
    assert noted(arm, "they follow a fixed joint: reach")
    tip = arm.link_poses(np.array([0.3]))["tool"]
    expected = moving.link_poses(np.array([0.3, 0.5, 0.07]))["tool"]
    assert np.allclose(tip.matrix(), expected.matrix(), atol=1e-12)


def test_a_joint_without_lower_and_upper_is_fixed_at_zero(tmp_path):
    arm = load(tmp_path, (LIMIT, '<limit velocity="2" effort="30"/>'))
    assert "bend" not in arm.joint_names
    assert noted(arm, "are fixed: bend at 0")


def test_a_robot_of_which_every_joint_is_held_is_refused_at_the_first(tmp_path):
    rigid = URDF.replace('"continuous"', '"revolute"').replace(' upper="2"', ' upper="-2"')
    write_arm(tmp_path, rigid.replace('lower="0" upper="0.2"', ""))
    with pytest.raises(SpecError, match="no joint of the robot can move") as caught:
        load_arm(tmp_path)
    assert caught.value.problems[0].line == 8


def test_ros2_control_can_hold_a_joint(tmp_path):
    arm = load(tmp_path, (END, control("bend", "position", 0.2, 0.2) + END))
    assert noted(arm, "are fixed: bend at 0.2")


def test_states_and_steps_of_a_held_joint_do_no_harm(tmp_path):
    held = URDF.replace(LIMIT, LIMIT.replace('"-2" upper="2"', '"0" upper="0"'))
    write_arm(tmp_path, held)
    result, _ = run(
        tmp_path,
        "- move_to: {named_target: home}\n- move_to: {joints: {turn: 0.4}}",
        robot="{urdf: arm.urdf, srdf: arm.srdf}",
        rest="""
        expect:
          - joints: {positions: {turn: 0.4}, tolerance: 1 deg}
        """,
    )
    assert result.outcome == "passed", [step.message for step in result.steps]


def test_a_virtual_joint_needs_no_attributes(tmp_path):
    srdf = SRDF.replace('name="held" type="fixed" parent_frame="world"', 'type="floating"')
    arm = load(tmp_path, srdf=srdf)
    assert noted(arm, "SRDF: <virtual_joint> in line 9 has no 'name'")
    assert noted(arm, "SRDF: <virtual_joint> in line 9 has no 'parent_frame'")
    assert noted(arm, "counts as fixed")


def test_an_end_effector_without_a_name_has_that_of_its_group(tmp_path):
    fingers = '<group name="hand"><joint name="reach"/></group>'
    tool = '<end_effector parent_link="tool" group="hand"/>'
    arm = load(tmp_path, srdf=SRDF.replace(END, fingers + tool + END))
    assert noted(arm, "<end_effector>", "has no 'name': 'hand' is assumed")


EQUAL = ('effort="80"', 'effort="30"')
HEAVY = ('<mass value="1"/>', '<mass value="20"/>')


@pytest.mark.parametrize("effort", ["30", "1", "100"])
def test_equal_efforts_that_cannot_hold_the_arm_count_as_none(tmp_path, effort):
    heavy = ('<mass value="1"/>', f'<mass value="{effort}"/>')
    arm = load(tmp_path, EQUAL, ('effort="30"', f'effort="{effort}"'), heavy)
    assert {arm.joint_by_name[name].effort for name in arm.joint_names} == {np.inf}
    assert noted(arm, f"the effort limit of {effort} of all joints of the arm counts as none")
    assert noted(arm, "`joint_limits: {reach: {max_effort: ...}}` in `robot:`")
    known = load(tmp_path, EQUAL, HEAVY, joint_limits={"bend": {"max_effort": 4000}})
    assert known.joint_by_name["bend"].effort == 4000


@pytest.mark.parametrize("changes", [[EQUAL], [HEAVY]])
def test_efforts_that_hold_the_arm_or_differ_stay(tmp_path, changes):
    arm = load(tmp_path, *changes)
    assert arm.joint_by_name["bend"].effort == 30
    assert not noted(arm, "counts as none")


def test_a_larger_effort_than_the_file_has_belongs_into_the_file(tmp_path):
    with pytest.raises(RobotError, match="its file has the `effort` to correct"):
        load(tmp_path, joint_limits={"bend": {"max_effort": 4000}})


def test_an_arm_whose_efforts_are_a_placeholder_moves(tmp_path):
    write_arm(tmp_path, URDF.replace(*EQUAL).replace(*HEAVY))
    result, _ = run(
        tmp_path,
        "- move_to: {joints: {turn: 0.5, bend: 1.2}}",
        robot="{urdf: arm.urdf, srdf: arm.srdf}",
        rest="""
        expect:
          - always: within_limits
        """,
    )
    assert result.outcome == "passed", [step.message for step in result.steps]


ROBOT_YAML = """
robot: three
kind: arm
urdf: arm.urdf
srdf: arm.srdf
arm_group: manipulator
tcp_link: tool
"""


def test_a_robot_of_a_folder_is_treated_alike(tmp_path):
    folder = tmp_path / "three"
    folder.mkdir()
    (folder / "robot.yaml").write_text(ROBOT_YAML)
    write_arm(folder, URDF.replace(TENSOR, "").replace(END, leaf("width", "tool") + END))
    arm = load_robot(RobotSpec(model="three"), tmp_path)
    assert link(arm, "upper").inertial.inertia[2, 2] == pytest.approx(0.03**2 / 2)
    assert link(arm, "width").inertial.mass == 0.001
    assert noted(arm, "no inertia is given for upper, lower, wrist")
