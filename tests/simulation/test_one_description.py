"""Pinocchio and MuJoCo are given one robot: where its links are, and what they weigh."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from harness.language.scenario import RobotSpec
from harness.robot.load import load_robot, robot_names
from harness.simulation.model import build_model
from harness.simulation.robot_mjcf import joint_range

ROBOTS = [{"model": name} for name in robot_names()] + [
    {"model": "ur3e", "gripper": "rh_p12_rn_a", "base": {"xyz": [0.1, -0.2, 1.02]}},
    {"model": "ur5e", "gripper": "rh_p12_rn_a", "base": {"rpy": [0.3, -0.2, 0.9]}},
]


@pytest.mark.nightly(but=["ur3e", "open_manipulator_x"])
@pytest.mark.parametrize(
    "options", ROBOTS, ids=lambda options: "+".join(map(str, options.values()))
)
def test_both_libraries_agree_on_kinematics_and_masses(options):
    description = load_robot(RobotSpec.model_validate(options))
    physics = build_model(description, (), (), gravity=(0, 0, -9.81), timestep=0.002)
    model, data = physics.model, mujoco.MjData(physics.model)
    pin_model = pin.buildModelFromXML(description.urdf)
    pin_data = pin_model.createData()
    rng = np.random.default_rng(7)
    ranges = np.array([joint_range(description, joint) for joint in description.movable_joints])
    lower = np.maximum(ranges[:, 0], -np.pi)
    upper = np.minimum(ranges[:, 1], np.pi)
    for _ in range(20):
        positions = description.with_mimics(rng.uniform(lower, upper))
        data.qpos[physics.qpos] = positions
        mujoco.mj_kinematics(model, data)
        pin.framesForwardKinematics(
            pin_model, pin_data, pin_positions(pin_model, description, positions)
        )
        for link in description.link_names:
            pose = pin_data.oMf[pin_model.getFrameId(link)]
            body = model.body(link).id
            np.testing.assert_allclose(data.xpos[body], pose.translation, atol=1e-9)
            np.testing.assert_allclose(data.xmat[body].reshape(3, 3), pose.rotation, atol=1e-9)
    assert model.body_mass.sum() == pytest.approx(
        sum(link.inertial.mass for link in description.links if link.inertial), abs=1e-12
    )
    moving = sum(inertia.mass for inertia in list(pin_model.inertias)[1:])
    static = [model.body(name).mass[0] for name in description.static_links]
    assert model.body_mass.sum() - sum(static) == pytest.approx(moving, abs=1e-9)


@pytest.mark.parametrize(
    "options", ROBOTS, ids=lambda options: "+".join(map(str, options.values()))
)
def test_both_libraries_agree_on_the_mass_matrix_and_gravity(options):
    description = load_robot(RobotSpec.model_validate(options))
    physics = build_model(description, (), (), gravity=(0, 0, -9.81), timestep=0.002)
    model, data = physics.model, mujoco.MjData(physics.model)
    pin_model = pin.buildModelFromXML(description.urdf)
    pin_data = pin_model.createData()
    positions = description.start_positions() + 0.1
    data.qpos[physics.qpos] = positions
    mujoco.mj_forward(model, data)
    dense = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, dense)
    dense -= np.diag(model.dof_armature)
    q = pin_positions(pin_model, description, positions)
    expected = pin.crba(pin_model, pin_data, q)
    expected = np.triu(expected) + np.triu(expected, 1).T
    order = [pin_model.joints[pin_model.getJointId(name)].idx_v for name in description.joint_names]
    np.testing.assert_allclose(
        dense[np.ix_(physics.dof, physics.dof)], expected[np.ix_(order, order)], atol=1e-9
    )
    gravity = pin.computeGeneralizedGravity(pin_model, pin_data, q)
    np.testing.assert_allclose(data.qfrc_bias[physics.dof], gravity[order], atol=1e-9)


def pin_positions(model, description, positions):
    q = pin.neutral(model)
    for name, position in zip(description.joint_names, positions, strict=True):
        joint = model.joints[model.getJointId(name)]
        if joint.nq == 2:
            q[joint.idx_q : joint.idx_q + 2] = np.cos(position), np.sin(position)
        else:
            q[joint.idx_q] = position
    return q
