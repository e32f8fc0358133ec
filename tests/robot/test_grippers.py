"""Grippers: linkage, pads, efforts."""

import math

import numpy as np
import pytest

from harness.core.geometry import Box
from harness.robot.load import gripper_names, robot_names
from tests.robot.models import Arm, robot
from tests.session.front_door import failures, run

SWAPPED = {"model": "open_manipulator_x", "gripper": "rh_p12_rn_a"}

# ROBOTIS: position of rh_r1_joint and gap between the pads [m], tip height over the base [m].
GAPS = [
    (0.0, 0.10693, 0.1165),
    (0.3, 0.08567, 0.12981),
    (0.59, 0.05852, 0.13915),
    (0.8, 0.03609, 0.14327),
    (1.0, 0.01358, 0.14494),
]


def pad_face(description, link, side):
    """Inner face of a pad in its link [m]: the named shape's face towards the other finger."""
    (pad,) = (
        s for x in description.links if x.name == link for s in x.collisions if s.name == "pad"
    )
    assert isinstance(pad.geometry, Box)
    return pad.pose.translation[1] - side * pad.geometry.size[1] / 2


def pad_gap(description, arm, positions):
    palm = description.gripper.palm_link
    ys = []
    for link in description.gripper.pads.values():
        T_palm_pad = arm.pose(link, positions, palm)
        side = math.copysign(1, T_palm_pad.translation[1])
        ys.append(T_palm_pad.act(np.array([0.0, pad_face(description, link, side), 0.0]))[1])
    return abs(ys[0] - ys[1])


@pytest.mark.parametrize(("position", "gap", "tip"), GAPS)
def test_rh_p12_rn_a_pads_stand_as_far_apart_as_measured(position, gap, tip):
    description = robot(gripper="rh_p12_rn_a")
    arm = Arm(description)
    assert pad_gap(description, arm, {"rh_r1_joint": position}) == pytest.approx(gap, abs=6e-6)
    T_palm_pad = arm.pose("rh_p12_rn_r2", {"rh_r1_joint": position}, "rh_p12_rn_base")
    assert T_palm_pad.translation[2] + 0.040 == pytest.approx(tip, abs=6e-6)
    assert T_palm_pad.rotation == pytest.approx(np.eye(3), abs=1e-12), "pads stay parallel"


def test_open_manipulator_x_pads_close_on_a_box_where_the_formula_says():
    description = robot(model="open_manipulator_x")
    arm = Arm(description)
    for position, gap in (
        (-0.01, 0.022),
        (0.0, 0.042),
        (0.004, 0.05),
        (0.015, 0.072),
        (0.019, 0.08),
    ):
        found = pad_gap(description, arm, {"gripper_left_joint": position})
        assert found == pytest.approx(gap, abs=1e-9)


@pytest.mark.parametrize("spec", [{"model": "open_manipulator_x"}, {"gripper": "rh_p12_rn_a"}])
def test_the_width_table_is_what_the_linkage_does(spec):
    description = robot(**spec)
    arm = Arm(description)
    gripper = description.gripper
    assert (np.diff(gripper.widths[:, 0]) > 0).all()
    for position, width in gripper.widths:
        assert pad_gap(description, arm, {gripper.joint: position}) == pytest.approx(
            width, abs=1e-6
        )
    assert {gripper.open_position, gripper.closed_position} == {
        gripper.widths[0, 0],
        gripper.widths[-1, 0],
    }


@pytest.mark.parametrize("spec", [{"model": "open_manipulator_x"}, {"gripper": "rh_p12_rn_a"}])
def test_no_shape_of_a_pad_link_is_nearer_to_the_object_than_the_pad(spec):
    description = robot(**spec)
    for side, link_name in zip(
        (1, -1), sorted(description.gripper.pads.values(), reverse=True), strict=True
    ):
        side = -side if spec.get("model") else side
        (link,) = (item for item in description.links if item.name == link_name)
        face = pad_face(description, link_name, side)
        (pad,) = (shape for shape in link.collisions if shape.name == "pad")
        for shape in link.collisions:
            overlap = (
                abs(shape.pose.translation - pad.pose.translation)[[0, 2]] * 2
                < (np.array(shape.geometry.size) + np.array(pad.geometry.size))[[0, 2]] - 1e-6
            )
            if overlap.all():
                inner = shape.pose.translation[1] - side * shape.geometry.size[1] / 2
                assert side * (inner - face) >= -1e-9


def test_mimic_joints_are_no_part_of_a_group_and_follow():
    description = robot(model="ur3e", gripper="rh_p12_rn_a")
    assert description.groups["gripper"].joint_names == ("rh_r1_joint",)
    positions = np.zeros(len(description.joint_names))
    positions[description.joint_index["rh_r1_joint"]] = 0.59
    followed = description.with_mimics(positions)
    assert [followed[description.joint_index[n]] for n in ("rh_r2", "rh_l1", "rh_l2")] == [0.59] * 3


def test_the_largest_effort_presses_with_the_data_sheets_force():
    gripper = robot(gripper="rh_p12_rn_a").gripper
    lever = lambda q: 0.0493634 * math.sin(q) + 0.0285 * math.cos(q)  # noqa: E731
    assert gripper.max_effort / (2 * lever(0.0)) == pytest.approx(170, abs=0.1)
    assert 15 < gripper.grip_effort / (2 * lever(0.5755)) < 20


def test_a_gripper_on_no_arm_is_a_robot():
    for spec in ({"gripper": "rh_p12_rn_a"}, {"model": "rh_p12_rn_a"}):
        description = robot(**spec, base={"xyz": [0, 0, 1.1], "rpy": [math.pi, 0, 0]})
        assert description.arm_group == ""
        assert description.groups["gripper"].joint_names == ("rh_r1_joint",)
        tcp = Arm(description).pose(description.tcp_link, {})
        assert tcp.translation == pytest.approx([0, 0, 1.1 - 0.125], abs=1e-12)


def test_a_mounted_gripper_moves_the_groups_tip_to_its_tcp():
    alone, mounted = robot(model="ur5e"), robot(model="ur5e", gripper="rh_p12_rn_a")
    assert alone.groups["ur_manipulator"].tip_link == alone.tcp_link == "tool0"
    assert mounted.groups["ur_manipulator"].tip_link == mounted.tcp_link == "end_effector_link"
    assert mounted.gripper.links == tuple(f"rh_p12_rn_{name}" for name in ("r1", "r2", "l1", "l2"))
    assert mounted.allowed_collisions["rh_p12_rn_base", "wrist_3_link"] == "Adjacent"
    arm = Arm(mounted)
    assert arm.pose("end_effector_link", {}, "tool0").translation == pytest.approx([0, 0, 0.125])
    assert arm.pose("rh_p12_rn_ee", {}, "end_effector_link").isIdentity(1e-12)


def test_a_gripper_takes_the_place_of_the_arms_own():
    own, other = robot(model="open_manipulator_x"), robot(**SWAPPED)
    assert other.gripper.group == "gripper"
    assert other.gripper.palm_link == "rh_p12_rn_base"
    assert other.tcp_link == other.groups["arm"].tip_link == "end_effector_link"
    gone = {"gripper_left_link", "gripper_right_link"}
    assert gone <= set(own.link_names)
    assert not gone & set(other.link_names)
    assert "open" in other.states_of("gripper")
    assert other.states_of("arm") == own.states_of("arm")
    # Out of the front of link5 and 0.125 m on, as the mount says; the gripper points along +z.
    T_link5_tcp = Arm(other).pose("end_effector_link", {}, "link5")
    assert T_link5_tcp.translation == pytest.approx([0.0684 + 0.125, 0, 0.0074], abs=1e-12)
    assert T_link5_tcp.rotation @ [0, 0, 1] == pytest.approx([1, 0, 0], abs=1e-12)


@pytest.mark.nightly(
    but=[
        "open_manipulator_x-rh_p12_rn_a",
        "ur3e-suction_cup",
        "ur5e-suction_array",
        "ur5e-rh_p12_rn_a",
    ]
)
@pytest.mark.parametrize("gripper", gripper_names())
@pytest.mark.parametrize("model", [name for name in robot_names() if name not in gripper_names()])
def test_every_gripper_goes_on_every_arm(model, gripper):
    description = robot(model=model, gripper=gripper)
    assert description.gripper is not None
    assert set(description.gripper.links) <= set(description.link_names)
    arm = Arm(description)
    for state in description.states_of(description.arm_group).values():
        assert arm.touching(state.positions) is None, state.name


@pytest.mark.nightly
def test_the_small_arm_lifts_a_part_with_the_other_gripper(tmp_path):
    reach = {"joint2": -0.6, "joint3": 0.4, "joint4": 0.2}
    x, _, z = Arm(robot(**SWAPPED)).pose("end_effector_link", reach).translation
    height = z - 0.035
    steps = f"""
        - gripper: open
        - move_to: {{joints: {reach}}}
        - add_object:
            name: post
            static: true
            box: {{size: [0.04, 0.04, {height}]}}
            pose: {{xyz: [{x}, 0, {height / 2}]}}
        - add_object:
            name: part
            cylinder: {{radius: 0.03, length: 0.07}}
            mass: 0.05
            pose: {{xyz: [{x}, 0, {z}]}}
        - grasp: {{object: part, position: 0.59}}
        - move_to: {{joints: {{joint3: 0.1, joint4: 0.5}}}}
          expect: [grasped: {{object: part}}]
    """
    rest = "expect: [always: within_limits]"
    chosen = "{model: open_manipulator_x, gripper: rh_p12_rn_a}"
    result, saved = run(tmp_path, steps, robot=chosen, rest=rest)
    assert result.outcome == "passed", [*failures(result), *(s.message for s in result.steps)]

    assert saved.signals.object_poses["part"][-1, 2] > z + 0.02
