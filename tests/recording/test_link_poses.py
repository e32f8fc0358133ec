"""Poses of links from a run alone, against Pinocchio's."""

import numpy as np
import pytest

from harness.language.scenario import RobotSpec
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.recording.link_poses import replayed_link_poses
from harness.robot.load import load_robot
from harness.session.record import robot_record


@pytest.mark.parametrize(
    "spec",
    [
        {"model": "ur3e", "gripper": "rh_p12_rn_a", "base": {"xyz": [0.1, 0.2, 1.0]}},
        {"model": "open_manipulator_x"},
    ],
    ids=["ur3e", "open_manipulator_x"],
)
def test_links_stand_where_pinocchio_puts_them(spec, tmp_path):
    description = load_robot(RobotSpec.model_validate(spec), tmp_path)
    kinematics = PinocchioKinematics(description)
    record = robot_record(description, kinematics)
    lower = [max(joint.lower, -3.0) for joint in record.joints]
    upper = [min(joint.upper, 3.0) for joint in record.joints]
    samples = np.random.default_rng(1).uniform(lower, upper, (5, len(lower)))
    poses = replayed_link_poses(record, samples)
    names = [name for name in record.link_names if name in poses]
    assert len(names) >= len(record.joints)
    theirs = kinematics.link_poses(samples, names)
    for column, name in enumerate(names):
        ours = np.broadcast_to(poses[name], (5, 7))
        np.testing.assert_allclose(ours[:, :3], theirs[:, column, :3], atol=1e-9)
        same = np.abs(np.sum(ours[:, 3:] * theirs[:, column, 3:], axis=1))
        np.testing.assert_allclose(same, 1.0, atol=1e-9)


def test_only_the_requested_links_come_back(tmp_path):
    description = load_robot(RobotSpec.model_validate({"model": "open_manipulator_x"}), tmp_path)
    record = robot_record(description, PinocchioKinematics(description))
    samples = np.zeros((3, len(record.joints)))
    assert list(replayed_link_poses(record, samples, ["link3", "no_such_link"])) == ["link3"]
