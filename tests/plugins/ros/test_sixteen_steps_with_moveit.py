"""The lesson's sixteen steps, written as a client of MoveIt, against the lesson's own run."""

import numpy as np
import pytest

from harness.core.resources import data_folder
from harness.plugins.ros.actions import Status
from harness.plugins.ros.handover import replay
from harness.recording.read_run import read_run
from tests.plugins.ros.bridging import bridge
from tests.plugins.ros.move_group_client import (
    GROUP,
    MoveGroupClient,
    box,
    joint_goal,
    moveit,
    pose,
    pose_goal,
    primitive,
)
from tests.plugins.ros.nodes import grip
from tests.robot.models import robot

LESSON = data_folder("scenarios") / "lessons/03_ur_sixteen_steps.scenario.yaml"
CELL = """scenario: The sixteen steps by a client of MoveIt
robot: {model: ur3e, gripper: rh_p12_rn_a, base: {xyz: [0, 0, 1.02]}}
world: lesson_ur
seed: 7
planning: {padding: 12 mm}
steps: [{external: {}, timeout: 120 s}]
expect: [{lifted: {object: green_cylinder, above: 30 cm}}]
"""
TURNED = (0.924, -0.383, 0.0, 0.0)
TOUCHING = ("rh_p12_rn_l1", "rh_p12_rn_l2", "rh_p12_rn_r1", "rh_p12_rn_r2")
BASE = "base_link"
SLOW = {"max_velocity_scaling_factor": 0.3, "max_acceleration_scaling_factor": 0.3}


def in_base(made):
    made.header.frame_id = BASE
    return made


@pytest.mark.nightly
def test_the_sixteen_steps_of_a_client_leave_the_scene_and_the_arm_of_the_lesson(
    tmp_path, recorded_run
):
    lesson = read_run(recorded_run(LESSON) / "run").run
    arm = robot(model="ur3e", gripper="rh_p12_rn_a")
    states = {name: dict(each.positions) for name, each in arm.states_of(GROUP).items()}
    file, folder = tmp_path / "steps.scenario.yaml", tmp_path / "run"
    file.write_text(CELL)
    names = []
    with bridge(file, factor=2.0, run={"report_dir": folder}) as (node, results):
        client = MoveGroupClient(node)

        def move(goal):
            moved = client.move_to(goal, **SLOW)
            assert moved.status is Status.SUCCEEDED, moved.result.error_code.message
            names.append(sorted(o.id for o in client.scene().world.collision_objects))

        def at(*xyz):
            return pose_goal(pose(xyz, TURNED), frame=BASE, tolerance=0.001)

        def remove(*ids):
            assert client.apply(*(moveit("CollisionObject", id=each, operation=1) for each in ids))

        move(joint_goal(states["mogi_down"]))
        boxes = ("hanging_box", (0, -0.6, 0.5)), ("upper_box", (0.3, 0.3, 0.7))
        assert client.apply(*(in_base(box(name, xyz, (0.05, 0.3, 0.2))) for name, xyz in boxes))
        move(joint_goal(states["up"]))
        move(joint_goal(states["mogi_home"]))
        node.send(grip(arm.gripper.closed_position, 0.0), node.gripper)
        remove("hanging_box", "upper_box")
        joints = dict.fromkeys(states["up"], 0.0)
        move(joint_goal({**joints, "shoulder_pan_joint": -1.5707, "shoulder_lift_joint": -1.5707}))
        move(at(0.32, -0.17, 0.3))
        node.send(grip(arm.gripper.open_position, 0.0), node.gripper)
        move(at(0.32, -0.17, 0.08))
        remove("green_cylinder")  # which the client's own object stands for
        cylinder = moveit(
            "CollisionObject",
            id="cylinder",
            pose=pose((0.32, -0.168, 0.05), (0.0, 0.0, 0.0, 1.0)),
            primitives=[primitive(3, 0.1, 0.03)],
        )
        held = moveit(
            "AttachedCollisionObject",
            link_name="end_effector_link",
            object=in_base(cylinder),
            touch_links=list(TOUCHING),
        )
        assert client.apply(attached=[held])
        assert node.send(grip(0.59, 0.0), node.gripper).result.stalled
        assert client.apply(in_base(box("low_box", (0.2, -0.3, 0.02), (0.03, 0.3, 0.04))))
        move(at(0, -0.4, 0.09))
        move(joint_goal(states["up"]))
        attached = client.scene().robot_state.attached_collision_objects
        assert [(each.object.id, each.link_name) for each in attached] == [
            ("cylinder", "end_effector_link")
        ]
        held.object.operation = 1
        assert client.apply(attached=[held])
    [result] = results
    assert result.case.outcome == "passed"
    run = read_run(folder).run
    of_lesson = [(each.object, each.link) for each in lesson.attachments]
    assert [(each.object, each.link) for each in run.attachments] == of_lesson
    steps = ("step_1", "step_3", "step_4", "step_7", "step_8", "step_10", "step_14", "step_15")
    for name, step in zip(names, steps, strict=True):
        [record] = [each for each in lesson.steps if each.id == step]
        there = {
            each.name
            for each in lesson.objects
            if any(
                start < (record.start_time + record.end_time) / 2 < end
                for start, end in each.present
            )
        }
        assert boxes_of(there) == boxes_of(name), step
    end = np.array([each.signals.joint_positions[-1, :6] for each in (run, lesson)])
    assert np.abs(end[0] - end[1]).max() < 5e-3
    assert replay(folder).digest == result.case.digest


def boxes_of(names):
    """The names of the boxes that the planner alone knows."""
    return {*names} & {"hanging_box", "upper_box", "low_box"}
