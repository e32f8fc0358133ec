"""An SRDF that other variants of the robot share: what the URDF does not have is left out."""

import pytest

from harness.core.errors import SpecError
from tests.robot.arm_files import SRDF, load_arm, write_arm

HEAD = "<group name="
FIRST = SRDF.index(HEAD)


def load(folder, *elements):
    """The arm with more elements before its own group, which an order of groups may matter to."""
    write_arm(folder, srdf=SRDF[:FIRST] + "\n  ".join((*elements, SRDF[FIRST:])))
    return load_arm(folder)


def notes(arm):
    return [note for note in arm.notes if "group '" in note]


HAND = '<group name="hand"><joint name="reach"/><joint name="knuckle"/><link name="thumb"/></group>'


def test_a_group_goes_on_without_what_is_not_there_as_in_moveit(tmp_path):
    arm = load(
        tmp_path,
        HAND,
        '<group_state name="open" group="hand"><joint name="reach" value="0.1"/>'
        '<joint name="knuckle" value="0.3"/></group_state>',
        '<passive_joint name="knuckle"/>',
    )
    assert arm.arm_group == "manipulator"
    assert arm.groups["manipulator"].joint_names == ("turn", "bend", "reach")
    assert arm.groups["hand"].joint_names == ("reach",)
    assert arm.states_of("hand")["open"].positions == {"reach": 0.1}
    assert notes(arm) == [
        "SRDF: group 'hand' names what the URDF does not have, ignored: knuckle, thumb"
    ]


def test_a_group_of_which_nothing_is_there_goes_with_all_that_names_it(tmp_path):
    arm = load(
        tmp_path,
        '<group name="leg"><chain base_link="hip" tip_link="foot"/></group>',
        '<group name="legs"><group name="leg"/></group>',
        '<group name="all"><group name="legs"/><group name="manipulator"/></group>',
        '<group_state name="kneeling" group="legs"><joint name="knee" value="1"/></group_state>',
        '<end_effector name="shoe" parent_link="foot" group="leg" parent_group="legs"/>',
    )
    assert list(arm.groups) == ["all", "manipulator"]
    assert arm.arm_group == "manipulator"
    assert arm.gripper is None
    assert notes(arm) == [
        "SRDF: group 'leg' is left out: the URDF has nothing of it",
        "SRDF: group 'legs' is left out: the URDF has nothing of it",
    ]


@pytest.mark.parametrize(
    "words",
    [
        'name="paw" parent_link="tool" group="left_hand"',
        'name="paw" parent_link="tool" group="manipulators" parent_group="manipulator"',
        'parent_link="nowhere" group="gripper"',
    ],
)
def test_an_end_effector_of_no_group_is_left_out_as_in_moveit(tmp_path, words):
    arm = load(tmp_path, f"<end_effector {words}/>")
    assert arm.gripper is None
    group = words.partition('group="')[2].partition('"')[0]
    assert f"SRDF: end effector left out: there is no group '{group}'" in arm.notes


@pytest.mark.parametrize(
    ("elements", "message"),
    [
        (
            ['<group name="other"><joint name="knuckle"/><chain base_link="upper"'
             ' tip_link="tool"/></group>'],
            "3:36: group 'other': names the unknown joint 'knuckle'",
        ),
        (
            [HAND, '<group_state name="open" group="hand"><joint name="rach" value="0"/>'
             "</group_state>"],
            "4:54: state 'open' names the unknown joint 'rach'",
        ),
        ([HAND, '<passive_joint name="nuckle"/>'], "4:24: passive_joint names the unknown joint"),
        (
            [HAND, '<end_effector name="e" parent_link="tol" group="hand"/>'],
            "4:39: end effector 'e' names the unknown link 'tol'",
        ),
        ([HAND, '<group name="both"><group name="hnd"/></group>'], "names the unknown group 'hnd'"),
        (
            [HAND, '<group name="bent"><chain base_link="tool" tip_link="upper"/></group>'],
            "no chain leads from 'tool' to 'upper'",
        ),
    ],
)  # fmt: skip
def test_what_may_be_a_mistake_stays_an_error(tmp_path, elements, message):
    with pytest.raises(SpecError) as error:
        load(tmp_path, *elements)
    assert message in str(error.value)


def test_an_srdf_without_an_arm_that_is_there_is_an_error_at_its_first_name(tmp_path):
    write_arm(tmp_path, srdf=SRDF.replace('tip_link="tool"', 'tip_link="tol"'))
    with pytest.raises(SpecError, match="3:30: group 'manipulator': no chain leads from"):
        load_arm(tmp_path)


def test_an_empty_group_stays_as_it_was(tmp_path):
    arm = load(tmp_path, '<group name="nothing"/>', HAND)
    assert arm.groups["nothing"].joint_names == ()
    assert len(notes(arm)) == 1


def test_what_is_written_has_no_absent_names(tmp_path):
    write_arm(tmp_path, srdf=SRDF[:FIRST] + HAND + SRDF[FIRST:])
    arm = load_arm(tmp_path)
    assert "reach" in arm.srdf
    assert "knuckle" not in arm.srdf


def test_a_virtual_joint_may_be_passive(tmp_path):
    """As for the floating base of a robot on wheels."""
    arm = load(
        tmp_path,
        '<virtual_joint name="base" type="planar" parent_frame="odom" child_link="base_link"/>',
        '<passive_joint name="base"/>',
    )
    assert arm.groups["manipulator"].joint_names == ("turn", "bend", "reach")
