"""Poses of links from a run alone, against Pinocchio's and MuJoCo's."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.language.scenario import RobotSpec
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.plugins.authoring.agreement import link_poses_in_physics
from harness.recording.consistency import run_flaws
from harness.recording.link_poses import replayed_link_poses
from harness.robot.load import load_robot
from harness.robot.mechanism import Link, fixed_joint
from tests.judging.synthetic_run import ROBOT, make_run

POSE = SE3.from_xyz_rpy((0.0, 0.0, 0.1))
ROBOTS = [
    {"model": "ur3e", "gripper": "rh_p12_rn_a", "base": {"xyz": [0.1, 0.2, 1.0]}},
    {"model": "open_manipulator_x"},
]


@pytest.fixture(params=ROBOTS, ids=lambda spec: spec["model"])
def description(request, tmp_path):
    return load_robot(RobotSpec.model_validate(request.param), tmp_path)


def samples_of(description, count=5):
    lower = [max(joint.lower, -3.0) for joint in description.movable_joints]
    upper = [min(joint.upper, 3.0) for joint in description.movable_joints]
    drawn = np.random.default_rng(1).uniform(lower, upper, (count, len(lower)))
    return np.array([description.with_mimics(row) for row in drawn])


def assert_same(ours, theirs):
    np.testing.assert_allclose(ours[:, :3], theirs[:, :3], atol=1e-9)
    same = np.abs(np.sum(ours[:, 3:] * theirs[:, 3:], axis=1))
    np.testing.assert_allclose(same, 1.0, atol=1e-9)


def test_links_are_where_pinocchio_and_mujoco_put_them(description):
    samples = samples_of(description)
    kinematics = PinocchioKinematics(description)
    poses = replayed_link_poses(description, samples)
    in_physics, _ = link_poses_in_physics(description, samples)
    assert set(poses) == set(description.link_names)
    for place, name in enumerate(description.link_names[1:]):
        pinocchio = [kinematics.link_pose(row, name).as_vector() for row in samples]
        assert_same(poses[name], np.array(pinocchio))
        assert_same(poses[name], in_physics[:, place])


def test_one_joint_moves_its_link_as_the_whole_tree_does(description):
    row = samples_of(description)[3]
    poses = description.link_poses(row)
    for joint, position in zip(description.movable_joints, row, strict=True):
        expected = poses[joint.parent].inverse() @ poses[joint.child]
        np.testing.assert_allclose(joint.at(position).matrix(), expected.matrix(), atol=1e-9)
        rows = joint.poses(np.array([0.0, position]))
        np.testing.assert_allclose(rows[1], expected.as_vector(), atol=1e-9)


def test_only_the_requested_links_come_back(tmp_path):
    description = load_robot(RobotSpec.model_validate({"model": "open_manipulator_x"}), tmp_path)
    samples = np.zeros((3, len(description.joint_names)))
    assert list(replayed_link_poses(description, samples, ["link3", "no_such_link"])) == ["link3"]


@pytest.mark.parametrize("order", [(1, 0), (1, 2, 0), (0, 2, 1)])
def test_a_link_that_is_placed_before_its_parent_is_a_flaw_of_the_file(order):
    names = ["world", "a", "b", "c"]
    places = pairwise(names)
    chain = [fixed_joint(f"to_{child}", parent, child, POSE) for parent, child in places]
    robot = replace(ROBOT, links=tuple(Link(name, None) for name in names))
    run = make_run(robot=replace(robot, joints=tuple(chain[each] for each in order)))
    keys = [key for key, reason in run_flaws(run) if "placed before" in reason]
    assert keys
    assert all(key.startswith("robot.joints[") for key in keys)
    ordered = make_run(robot=replace(robot, joints=tuple(chain)))
    assert not [reason for _, reason in run_flaws(ordered) if "placed before" in reason]
