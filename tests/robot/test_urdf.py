"""Reading URDF and SRDF, and writing them back."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.errors import SpecError
from harness.core.geometry import Capsule, Cylinder, Sphere
from harness.core.spatial import rotation_from_rpy, rpy_from_rotation
from harness.robot.groups import planning_groups
from harness.robot.srdf.srdf import parse_srdf, write_srdf
from harness.robot.urdf.urdf import parse_urdf
from harness.robot.urdf.write import write_urdf
from tests.robot.arm_files import URDF
from tests.robot.models import robot

LIMIT = '<limit lower="-1" upper="1" velocity="1" effort="1"/>'
ARM = """<robot name="arm"><link name="a"/><link name="b"/><link name="c"/>
<joint name="ab" type="revolute"><parent link="a"/><child link="b"/>{limit}</joint>
<joint name="bc" type="fixed"><parent link="b"/><child link="c"/></joint></robot>"""


def read(text):
    return parse_urdf(text, Path(), "arm.urdf")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("<robot", ["not well-formed"]),
        ('<!DOCTYPE robot [<!ENTITY x "y">]><robot name="&x;"/>', ["arm.urdf:1:17", "DOCTYPE"]),
        ("<sdf/>", ["<sdf>", "<robot>"]),
        ('<robot name="a"/>', ["arm.urdf:1:2", "no <link>"]),
        ('<robot name="a"><link name="b"/><link name="c"/></robot>', ["one root link", "b, c"]),
        (ARM.format(limit=""), ["'ab'", "no <limit>"]),
        (ARM.format(limit=LIMIT).replace('child link="b"', 'child link="z"'), ["'ab'", "'z'"]),
        (
            ARM.format(limit=LIMIT).replace('child link="c"', 'child link="b"'),
            ["'b'", "two joints"],
        ),
        (ARM.format(limit=LIMIT).replace("revolute", "hinge"), ["'hinge'", "revolute"]),
        (ARM.format(limit=LIMIT).replace('lower="-1"', 'lower="low"'), ["low"]),
    ],
)
def test_what_is_no_urdf_is_refused_by_name(text, words):
    with pytest.raises(SpecError) as caught:
        read(text)
    assert "arm.urdf" in str(caught.value)
    for word in words:
        assert word in str(caught.value)


@pytest.mark.parametrize(
    ("text", "advice"),
    [
        ("<robot name='a'><!-- a -- b --></robot>", "no `--` in a comment"),
        ("<robot name='a & b'/>", "`&amp;` for &"),
        ("<robot name=a/>", "values in quotes"),
        ("<robot name='a'><link name='b'></robot>", "<link> of line 1 is not closed"),
        ("<robot name='a'><link name='b'/>", "<robot> of line 1 is not closed"),
        ("<robot name='a'><link name='b' name='c'/></robot>", ""),
    ],
)
def test_the_advice_on_broken_xml_names_what_breaks_it(text, advice):
    with pytest.raises(SpecError) as caught:
        read(text)
    [problem] = caught.value.problems
    assert advice in problem.hint
    assert bool(problem.hint) == bool(advice)


def test_soft_limits_narrow_the_position_limits():
    soft = '<safety_controller soft_lower_limit="-0.5" soft_upper_limit="2" k_velocity="0"/>'
    joint = read(ARM.format(limit=LIMIT + soft)).joints[0]
    assert (joint.lower, joint.upper) == (-0.5, 1.0)


@pytest.mark.parametrize("spec", [{"model": "open_manipulator_x"}, {"model": "ur20"}])
def test_a_written_urdf_reads_back_the_same(spec):
    description = robot(**spec, base={"xyz": [0.1, 0.2, 0.3], "rpy": [0.1, 1.5707963, -2]})
    again = read(description.urdf)
    assert [link.name for link in again.links] == [link.name for link in description.links]
    for joint, other in zip(description.joints, again.joints, strict=True):
        assert other.name == joint.name
        assert other.pose.rotation == pytest.approx(joint.pose.rotation, abs=1e-15)
        assert np.array_equal(other.pose.translation, joint.pose.translation)
        assert (other.lower, other.upper, other.effort) == (
            joint.lower,
            joint.upper,
            joint.effort,
        ) or (joint.kind == "fixed")
        assert other.mimic == joint.mimic
    for link, other in zip(description.links, again.links, strict=True):
        assert len(link.collisions) == len(other.collisions)
        if link.inertial is not None:
            assert np.array_equal(other.inertial.inertia, link.inertial.inertia)


@given(*[st.floats(-np.pi, np.pi)] * 3)
def test_roll_pitch_yaw_of_a_rotation_give_it_back(roll, pitch, yaw):
    rotation = rotation_from_rpy((roll, pitch, yaw))
    assert rotation_from_rpy(rpy_from_rotation(rotation)) == pytest.approx(rotation, abs=1e-14)


@pytest.mark.parametrize("pitch", [np.pi / 2, -np.pi / 2, 1.570796, np.pi / 2 - 1e-9])
def test_roll_pitch_yaw_hold_at_the_singularity(pitch):
    rotation = rotation_from_rpy((0.3, pitch, -1.1))
    assert rotation_from_rpy(rpy_from_rotation(rotation)) == pytest.approx(rotation, abs=1e-14)


def test_a_capsule_is_written_as_the_cylinder_and_spheres_it_is_made_of():
    capsule = (
        '<collision><origin xyz="0 0 1"/><geometry><capsule radius="0.1" length="0.4"/></geometry>'
    )
    urdf = read(f'<robot name="a"><link name="b">{capsule}</collision></link></robot>')
    (shape,) = urdf.links[0].collisions
    assert shape.geometry == Capsule(0.1, 0.4)
    written = read(write_urdf("a", urdf.links, urdf.joints)).links[0].collisions
    assert [piece.geometry for piece in written] == [Cylinder(0.1, 0.4), Sphere(0.1), Sphere(0.1)]
    assert [piece.pose.translation[2] for piece in written] == pytest.approx([1.0, 0.8, 1.2])


SRDF = """<robot name="arm"><group name="arm"><chain base_link="a" tip_link="c"/></group>
<group name="joints"><joint name="ab"/></group><group name="links"><link name="b"/></group>
<group name="both"><group name="arm"/><group name="links"/></group>
<group_state name="up" group="arm"><joint name="ab" value="0.1"/></group_state>
<disable_collisions link1="b" link2="a" reason="Adjacent"/></robot>"""


def test_groups_of_every_form_have_their_active_joints():
    srdf, joints = parse_srdf(SRDF, "arm.srdf"), read(ARM.format(limit=LIMIT)).joints
    groups = planning_groups(srdf, joints, "arm.srdf")
    assert {name: group.joint_names for name, group in groups.items()} == {
        "arm": ("ab",),
        "joints": ("ab",),
        "links": ("ab",),
        "both": ("ab",),
    }
    assert (groups["arm"].base_link, groups["arm"].tip_link) == ("a", "c")
    assert groups["joints"].tip_link == ""
    assert srdf.disabled == {("a", "b"): "Adjacent"}
    assert parse_srdf(write_srdf("arm", srdf), "again") == srdf


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('tip_link="c"', 'tip_link="d"', ["'arm'", "no chain", "'d'"]),
        ('joint name="ab"/></group>', 'joint name="cd"/></group>', ["'joints'", "'cd'"]),
        ('<group name="links"/>', '<group name="both"/>', ["'both'"]),
        ('value="0.1"', 'value="low"', ["arm.srdf:4:60", "'low' is not a finite number"]),
        ('link2="a"', 'link3="a"', ["link2"]),
    ],
)
def test_what_an_srdf_gets_wrong_is_named(old, new, words):
    assert old in SRDF
    joints = read(ARM.format(limit=LIMIT)).joints
    with pytest.raises(SpecError) as caught:
        planning_groups(parse_srdf(SRDF.replace(old, new), "arm.srdf"), joints, "arm.srdf")
    for word in words:
        assert word in str(caught.value)


def test_all_empty_ranges_of_ros2_control_are_reported_with_both_sources():
    def joint(name, low, high):
        bounds = f'<param name="min">{low}</param><param name="max">{high}</param>'
        interface = f'<command_interface name="position">{bounds}</command_interface>'
        return f'<joint name="{name}">{interface}</joint>'

    blocks = joint("turn", 2.044, 0.54) + joint("bend", 2.486, 2.885)
    control = f'<ros2_control name="c" type="system">{blocks}</ros2_control></robot>'
    with pytest.raises(SpecError) as caught:
        parse_urdf(URDF.replace("</robot>", control), Path(), "arm.urdf")
    assert [problem.message for problem in caught.value.problems] == [
        "joint 'turn': its `min` of 2.044 in ros2_control is above its `max` of 0.54",
        "joint 'bend': ros2_control allows 2.486 to 2.885, and its <limit> -2 to 2:"
        " nothing is in both",
    ]
