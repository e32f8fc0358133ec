"""Arms on rails and pedestals: one robot with more joints, for planner and physics alike."""

import numpy as np
import pytest

from harness.core.errors import RobotError
from harness.core.kinematics import LinkPoses
from harness.language.scenario import RobotSpec
from harness.robot.load import load_robot
from tests.running import run_case
from tests.session.front_door import failures, problems, run


def robot(mount, model="ur5e", **more):
    return load_robot(RobotSpec.model_validate({"model": model, "mount": mount, **more}))


def base_at(description, **positions):
    """T_world_base of a robot at joint positions, the others at its start."""
    state = description.start_positions()
    for name, value in positions.items():
        state[description.joint_index[name]] = value
    poses = LinkPoses(description.joints, state[None], {description.base_link})
    return poses.rows(description.base_link)[0]


def test_a_rail_is_the_first_joint_of_the_arm_and_moves_its_base():
    plain = load_robot(RobotSpec.model_validate({"model": "ur5e", "base": {"xyz": [1, 2, 0.5]}}))
    railed = robot({"rail": {"axis": "y", "range": [-0.5, 2]}}, base={"xyz": [1, 2, 0.5]})
    group = railed.groups[railed.arm_group]
    assert group.joint_names == ("rail", *plain.groups[plain.arm_group].joint_names)
    assert railed.tcp_link == plain.tcp_link
    joint = railed.joint_by_name["rail"]
    assert (joint.lower, joint.upper, joint.velocity) == (-0.5, 2, 1)
    assert base_at(railed, rail=0.0) == pytest.approx(base_at(plain), abs=1e-12)
    moved = base_at(railed, rail=1.5)
    assert moved[:3] - base_at(plain)[:3] == pytest.approx((0, 1.5, 0), abs=1e-12)
    assert moved[3:] == pytest.approx(base_at(plain)[3:], abs=1e-12)
    assert {state.name for state in plain.named_states} == {s.name for s in railed.named_states}


def test_rails_of_a_gantry_carry_each_other_on_a_pedestal():
    description = robot(
        {
            "pedestal": [0.4, 0.4, 0.3],
            "rail": [
                {"name": "across", "axis": "x", "range": [0.2, 1]},
                {"name": "up", "axis": [0, 0, 2], "range": [0, 0.6], "max_velocity": 0.2},
            ],
        }
    )
    assert description.groups[description.arm_group].joint_names[:2] == ("across", "up")
    assert base_at(description)[:3] == pytest.approx((0.2, 0, 0.3))
    assert base_at(description, across=0.9, up=0.5)[:3] == pytest.approx((0.9, 0, 0.8))
    assert description.joint_by_name["up"].velocity == 0.2


def test_an_arm_without_a_mount_is_what_it_was_and_a_pedestal_lifts_it():
    plain = load_robot(RobotSpec.model_validate({"model": "ur5e"}))
    lifted = robot({"pedestal": [0.3, 0.3, 0.7]})
    assert lifted.joint_names == plain.joint_names
    assert lifted.ik_solver == plain.ik_solver
    assert base_at(lifted)[:3] - base_at(plain)[:3] == pytest.approx((0, 0, 0.7))
    shoulder = next(joint for joint in lifted.movable_joints)
    assert ("pedestal", shoulder.child) not in lifted.allowed_collisions


@pytest.mark.parametrize(
    ("mount", "message"),
    [
        (
            {"axis": "y", "range": [0, 1], "name": "elbow_joint"},
            "the robot has something called 'elbow_joint': give each rail a `name`",
        ),
        (
            [{"axis": "y", "range": [0, 1]}, {"axis": "x", "range": [0, 1]}],
            "2 rails are called 'rail': give each rail a `name`",
        ),
    ],
)
def test_the_joint_of_a_rail_has_a_name_of_its_own(mount, message):
    with pytest.raises(RobotError, match=message):
        robot({"rail": mount})


def test_a_gripper_alone_rides_no_rail():
    with pytest.raises(RobotError, match="a rail carries an arm"):
        load_robot(
            RobotSpec.model_validate(
                {"gripper": "rh_p12_rn_a", "mount": {"rail": {"axis": "x", "range": [0, 1]}}}
            )
        )


@pytest.mark.parametrize(
    ("mount", "message"),
    [
        ("{rail: {axis: w, range: [0, 1]}}", "an axis is `x`, `y`, `z`"),
        ("{rail: {axis: [0, 0, 0], range: [0, 1]}}", "an axis has some length"),
        ("{rail: {axis: x, range: [1, 1]}}", "not below the upper one"),
        ("{rail: {axis: x, range: [0, 90 deg]}}", "length"),
        ("{pedestal: [1, 1, 0]}", "more than 0"),
        ("{}", "at least one of"),
    ],
)
def test_a_mistake_has_its_place(tmp_path, mount, message):
    (found,) = problems(tmp_path, "- settle", robot=f"{{model: ur5e, mount: {mount}}}")
    assert found[0] == 2
    assert message in found[1]


def test_an_arm_drives_along_its_rail_and_stays_within_its_limits(tmp_path):
    result, record = run(
        tmp_path,
        "- move_to: {pose: {xyz: [0.5, 1.6, 0.4], rpy: [180 deg, 0, 0]}}",
        robot="{model: ur5e, base: {xyz: [0, 0, 0.05]}, mount: {rail: {axis: y, range: [0, 2]}}}",
        rest="expect:\n  - {tcp_pose: {pose: {xyz: [0.5, 1.6, 0.4], rpy: [180 deg, 0, 0]}}}\n"
        "  - always: within_limits\n",
    )
    assert result.outcome == "passed", failures(result)
    column = record.robot.joint_names.index("rail")
    assert record.signals.joint_positions[-1, column] > 0.7
    assert np.ptp(record.signals.joint_efforts[:, column]) > 1


GANTRY_OF_FOUR_JOINTS = """
robot:
  model: open_manipulator_x
  mount: {rail: [{name: gx, axis: x, range: [0, 1 m]}, {name: gy, axis: y, range: [0, 1 m]}]}
steps:
  - lin: {position: {xyz: [0.5, 0.3, 0.2]}}
  - lin: {pose: {xyz: [0.7, 0.5, 0.15], rpy: [0, 0, 80 deg]}}
"""


@pytest.mark.nightly
def test_a_line_to_a_position_turns_as_it_must_and_one_to_another_turn_is_refused(tmp_path):
    file = tmp_path / "gantry.scenario.yaml"
    file.write_text(f"scenario: a gantry{GANTRY_OF_FOUR_JOINTS}", encoding="utf-8")
    first, second = run_case(file).steps
    assert (first.status, second.error_code) == ("passed", "NO_IK_SOLUTION")
    assert "give the goal as a `position`" in "".join(second.explanation)
