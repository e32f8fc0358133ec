"""Grippers that clients of MoveIt move: followers among the joints, and controllers of grippers."""

import pytest

from harness.plugins.ros.actions import Status
from harness.plugins.ros.handover import replay
from harness.recording.read_run import read_run
from tests.plugins.ros.bridging import ROBOT, bridge, scenario
from tests.plugins.ros.move_group_client import UR, MoveGroupClient, joint_goal, moveit
from tests.plugins.ros.nodes import point

HOLD = "- external: {}"
SUCCESS, INVALID_GOAL_CONSTRAINTS, CONTROL_FAILED = 1, -16, -4
FINGERS = {"gripper_left_joint": 0.019, "gripper_right_joint": 0.019}


@pytest.mark.nightly
def test_a_goal_of_a_gripper_names_the_joint_that_follows_and_the_gripper_has_its_own_speed(
    tmp_path,
):
    """MoveGroupInterface names all joints of a group, and requests a tenth of the speed."""
    slow = {"group": "gripper", "max_velocity_scaling_factor": 0.1}
    with bridge(scenario(tmp_path, HOLD), run={"report_dir": tmp_path / "run"}) as (node, results):
        client = MoveGroupClient(node)
        plan = client.move_to(joint_goal(FINGERS), plan_only=True, **slow)
        assert plan.result.error_code.val == SUCCESS
        last = plan.result.planned_trajectory.joint_trajectory.points[-1].time_from_start
        assert last.sec >= 3
        opened = client.move_to(joint_goal(FINGERS), **slow)
        assert (opened.status, opened.result.error_code.val) == (Status.SUCCEEDED, SUCCESS)
        now = client.scene().robot_state.joint_state
        assert dict(zip(now.name, now.position, strict=True)) == pytest.approx(
            {**dict.fromkeys(now.name, 0.0), **FINGERS}, abs=2e-3
        )
        apart = client.move_to(joint_goal({**FINGERS, "gripper_right_joint": 0.0}), **slow)
        assert apart.result.error_code.val == INVALID_GOAL_CONSTRAINTS
        assert "follows 'gripper_left_joint'" in apart.result.error_code.message
        elsewhere = client.move_to(joint_goal({"gripper_right_joint": 0.0}), group="arm")
        assert elsewhere.result.error_code.val == INVALID_GOAL_CONSTRAINTS
        twice = moveit(
            "Constraints",
            joint_constraints=[
                moveit("JointConstraint", joint_name="joint1", position=at) for at in (0.1, 0.2)
            ],
        )
        assert "another constraint" in client.move_to(twice, group="arm").result.error_code.message
    [result] = results
    commands = read_run(tmp_path / "run").run.commands
    [command] = [each for each in commands if each.kind == "gripper"]
    assert command.content == {"position": 0.019, "max_effort": 0.0}
    assert replay(tmp_path / "run").digest == result.case.digest


@pytest.mark.nightly
@pytest.mark.parametrize("robot", [ROBOT, UR])
def test_a_trajectory_may_name_the_joints_that_follow(tmp_path, robot):
    with bridge(scenario(tmp_path, HOLD, robot=robot)) as (node, _):
        client = MoveGroupClient(node)
        state = client.scene().robot_state.joint_state
        trajectory = moveit("RobotTrajectory")
        joints = trajectory.joint_trajectory
        joints.joint_names = list(state.name)
        joints.points = [point(seconds, state.position) for seconds in (0.0, 1.0)]
        followed = client.follow(trajectory)
        assert (followed.status, followed.result.error_code.val) == (Status.SUCCEEDED, SUCCESS)
        joints.points[-1].positions = joints.points[-1].positions[:-1]
        short = client.follow(trajectory)
        assert short.result.error_code.val == CONTROL_FAILED
        assert "point 1" in short.result.error_code.message
