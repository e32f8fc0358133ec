"""Link poses and mass of a robot in MuJoCo, for a comparison with another library."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import mujoco
import numpy as np

from harness.core.types import FloatArray
from harness.robot.description import RobotDescription
from harness.simulation.model import build_model


def link_poses_in_physics(
    description: RobotDescription, positions: FloatArray
) -> tuple[FloatArray, float]:
    """Compute T_world_link of all links except `world` at joint positions, and the robot's mass.

    Args:
        description: The description of the robot.
        positions: Description order, shape (N, n).

    Returns:
        Poses in the order of `link_names[1:]`, xyz and quat wxyz, shape (N, links, 7); mass [kg].
    """
    physics = build_model(description, (), (), gravity=(0.0, 0.0, -9.8), timestep=0.001)
    model = physics.model
    data = mujoco.MjData(model)
    bodies = [model.body(name).id for name in description.link_names[1:]]
    poses = np.empty((len(positions), len(bodies), 7))
    for row, joint_positions in enumerate(positions):
        data.qpos[physics.qpos] = joint_positions
        mujoco.mj_kinematics(model, data)
        poses[row, :, :3] = data.xpos[bodies]
        poses[row, :, 3:] = data.xquat[bodies]
    return poses, float(model.body_mass.sum())
