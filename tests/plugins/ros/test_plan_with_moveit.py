"""The exercise for MoveIt's clients, solved by one that sends what MoveGroupInterface sends."""

import pytest

from harness.core.resources import data_folder
from harness.plugins.ros.actions import Status
from harness.plugins.ros.handover import replay
from harness.recording.read_run import read_run
from tests.plugins.ros.bridging import bridge
from tests.plugins.ros.move_group_client import (
    GROUP,
    MoveGroupClient,
    joint_goal,
    moveit,
    pose,
    pose_goal,
)
from tests.plugins.ros.nodes import grip
from tests.robot.models import robot

EXERCISE = data_folder("scenarios") / "ros2/03_plan_with_moveit.scenario.yaml"
TIP = "end_effector_link"
SLOW = {"max_velocity_scaling_factor": 0.3, "max_acceleration_scaling_factor": 0.3}


@pytest.mark.nightly
def test_a_client_plans_grasps_attaches_and_lifts_for_all_points(tmp_path):
    arm = robot(model="ur3e", gripper="rh_p12_rn_a")
    home = dict(arm.states_of(GROUP)["mogi_home"].positions)
    folder = tmp_path / "run"
    with bridge(EXERCISE, waits=True, factor=3.0, run={"report_dir": folder}) as (node, results):
        client = MoveGroupClient(node)

        def line(*places):
            path = client.call(
                "compute_cartesian_path", "GetCartesianPath", group_name=GROUP, max_step=0.01,
                waypoints=[pose(place) for place in places], avoid_collisions=True, **SLOW,
            )  # fmt: skip
            assert path.fraction == 1.0, path.error_code.message
            assert client.follow(path.solution).status is Status.SUCCEEDED

        assert client.move_to(joint_goal(home), **SLOW).status is Status.SUCCEEDED
        [cylinder] = [
            each for each in client.scene().world.collision_objects if each.id == "green_cylinder"
        ]
        x, y, z = (getattr(cylinder.pose.position, axis) for axis in "xyz")
        above = client.move_to(pose_goal(pose((x, y, z + 0.12))), **SLOW)
        assert above.status is Status.SUCCEEDED, above.result.error_code.message
        line((x, y, z + 0.02))
        closed = node.send(grip(arm.gripper.closed_position, 0.0), node.gripper)
        assert closed.result.stalled
        held = moveit("CollisionObject", id="green_cylinder")
        held = moveit("AttachedCollisionObject", link_name=TIP, object=held)
        assert client.apply(attached=[held])
        line((x, y, z + 0.17))
    [result] = results
    failed = [each for each in result.case.verdicts if each.status != "passed"]
    assert not failed
    assert result.case.outcome == "passed"
    run = read_run(folder).run
    plan, motion = run.commands[:2]
    assert (plan.summary, plan.answer) == ("plan for ur_manipulator: 6 joints", "planned")
    assert motion.summary.startswith("trajectory of ")
    assert motion.result.startswith("succeeded, t=")
    above = run.commands[2].summary
    assert above.startswith("plan for ur_manipulator: end_effector_link at ")
    summaries = [(each.summary, each.has_failed) for each in run.commands]
    assert ("planning scene: attach green_cylinder", False) in summaries
    [gripped] = [each.result for each in run.commands if each.kind == "gripper"]
    assert gripped.startswith("stalled on something")
    [attachment] = run.attachments
    assert (attachment.object, attachment.link) == ("green_cylinder", TIP)
    assert replay(folder).digest == result.case.digest
