"""Servos of the actuated joints: gains, rotor inertia and inverse-dynamics feed-forward."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray, IntArray
from harness.ports.joint_control import LinkMotion
from harness.robot.description import RobotDescription
from harness.simulation.compiling import compile_model
from harness.simulation.robot_mjcf import add_robot, coupling

BANDWIDTH_PER_STEP = 0.3
"""Natural frequency of an arm servo times the physics step; 300 rad/s at 1 ms. It is stable below
2, and a folded arm has several times less inertia than the stretched one of the design."""

ROTOR_INERTIA_PER_EFFORT = 1e-3
"""Rotor inertia seen through the gear [kg m^2 per N m, kg per N]. An estimate, as data sheets have
none: at full effort a joint cannot accelerate its own rotor faster than 1000 rad/s^2."""

ROTOR_SHARE = 0.03
"""Rotor inertia of a joint without an effort limit, as a share of the largest inertia that a joint
of its kind accelerates: without it, the wrist of a light arm yields to what its gripper holds."""

GRIPPER_SATURATION = 0.0025  # Lag of a gripper at its default effort, as a share of its range

GRIPPER_BANDWIDTH_PER_STEP = 0.5
"""BANDWIDTH_PER_STEP of a gripper; its saturation gives the stiffness, and so its rotor inertia."""


@dataclass(frozen=True, eq=False)
class Servos:
    """Parameters of each actuated joint, in description order without mimic joints.

    A servo's force is `stiffness * (control - position) - damping * velocity`, within its limit.

    Attributes:
        stiffness: The stiffness [N m/rad or N/m], shape (m,).
        damping: The damping [N m s/rad or N s/m], shape (m,).
        rotor_inertia: MuJoCo's armature, shape (m,).
        effort: Effort limits, inf where there is none, shape (m,).
    """

    stiffness: FloatArray
    damping: FloatArray
    rotor_inertia: FloatArray
    effort: FloatArray


def bare_robot(description: RobotDescription) -> mujoco.MjSpec:
    """The robot alone, without servos."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    add_robot(spec, description)
    return spec


def design_servos(description: RobotDescription, timestep: float) -> Servos:
    """Design critically damped servos from the inertia that each joint accelerates.

    The inertia is the larger of that at all joints zero (UR and OpenMANIPULATOR-X arms are
    stretched there) and that at the start state, other joints at rest, plus the rotor's.
    """
    model = compile_model(bare_robot(description))
    actuated = [joint for joint in description.movable_joints if joint.mimic is None]
    zero = description.with_mimics(np.zeros(len(description.joint_names)))
    inertia = np.maximum(
        _reflected_inertia(model, description, zero),
        _reflected_inertia(model, description, description.start_positions()),
    )
    effort = np.array([joint.effort for joint in actuated])
    rotor = ROTOR_INERTIA_PER_EFFORT * np.where(np.isfinite(effort), effort, 0.0)
    slides = np.array([joint.kind == "prismatic" for joint in actuated])
    robots = [arm.robot_joints for arm in description.arms] if description.is_cell else []
    for names in robots or [description.joint_names]:
        own = np.array([joint.name in names for joint in actuated])
        for kind in (own & slides, own & ~slides):
            rotor[kind & ~np.isfinite(effort)] = ROTOR_SHARE * inertia[kind].max(initial=0.0)
    frequency = np.full(len(actuated), BANDWIDTH_PER_STEP / timestep)
    for gripper in description.grippers:
        index = [joint.name for joint in actuated].index(gripper.joint)
        play = GRIPPER_SATURATION * abs(gripper.closed_position - gripper.open_position)
        frequency[index] = GRIPPER_BANDWIDTH_PER_STEP / timestep
        needed = gripper.grip_effort / play / frequency[index] ** 2
        rotor[index] = max(rotor[index], needed - inertia[index])
        effort[index] = gripper.max_effort
    total = inertia + rotor
    return Servos(total * frequency**2, 2.0 * total * frequency, rotor, effort)


def _reflected_inertia(
    model: mujoco.MjModel, description: RobotDescription, positions: FloatArray
) -> FloatArray:
    """Diagonal of the mass matrix in the actuated joints, shape (m,)."""
    data = mujoco.MjData(model)
    joints = [model.joint(name) for name in description.joint_names]
    data.qpos[[joint.qposadr[0] for joint in joints]] = positions
    mujoco.mj_forward(model, data)
    dofs = np.array([joint.dofadr[0] for joint in joints], dtype=np.int64)
    return np.diag(_inertia(model, data, dofs, description)).copy()


def _inertia(
    model: mujoco.MjModel, data: mujoco.MjData, dofs: IntArray, robot: RobotDescription
) -> FloatArray:
    """The mass matrix in the actuated joints, shape (m, m)."""
    dense = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, dense)
    ordered, matrix = dense[np.ix_(dofs, dofs)], coupling(robot)
    if not robot.is_cell:
        return matrix.T @ ordered @ matrix
    return _actuated(robot, _actuated(robot, ordered).T)


def _actuated(robot: RobotDescription, values: FloatArray) -> FloatArray:
    """Values of all movable joints, summed over those that move together, shape (N, m).

    In a cell they are added one by one: how a product is rounded depends on the matrix's size.
    """
    matrix = coupling(robot)
    if not robot.is_cell:
        return values @ matrix
    sums = np.zeros((len(values), matrix.shape[1]))
    for row, column in np.argwhere(matrix):
        sums[:, column] += values[:, row] * matrix[row, column]
    return sums


class FeedForward:
    """Efforts of a motion of the robot without payload: gravity, inertia, Coriolis, friction."""

    def __init__(
        self, description: RobotDescription, servos: Servos, gravity: tuple[float, float, float]
    ) -> None:
        spec = bare_robot(description)
        spec.option.gravity = gravity
        spec.option.disableflags = (
            mujoco.mjtDisableBit.mjDSBL_CONTACT
            | mujoco.mjtDisableBit.mjDSBL_EQUALITY
            | mujoco.mjtDisableBit.mjDSBL_LIMIT
        )
        set_rotor_inertia(spec, description, servos)
        self._model = compile_model(spec)
        self._data = mujoco.MjData(self._model)
        joints = [self._model.joint(name) for name in description.joint_names]
        self._positions = np.array([joint.qposadr[0] for joint in joints], dtype=np.intp)
        self._velocities = np.array([joint.dofadr[0] for joint in joints], dtype=np.int64)
        self._robot = description
        self._bodies = {self._model.body(index).name: index for index in range(self._model.nbody)}

    def __call__(
        self, positions: FloatArray, velocities: FloatArray, accelerations: FloatArray
    ) -> FloatArray:
        """Efforts of the actuated joints, shape (N, m).

        Args:
            positions: Positions of every movable joint, mimic joints included, shape (N, n).
        """
        model, data = self._model, self._data
        efforts = np.empty((len(positions), model.nv))
        qpos, qvel, qacc = (np.empty((len(positions), model.nv)) for _ in range(3))
        qpos[:, self._positions] = positions
        qvel[:, self._velocities] = velocities
        qacc[:, self._velocities] = accelerations
        at, speed, rate, effort = data.qpos, data.qvel, data.qacc, data.qfrc_inverse
        inverse = mujoco.mj_inverse
        for row in range(len(positions)):
            at[:], speed[:], rate[:] = qpos[row], qvel[row], qacc[row]
            inverse(model, data)
            efforts[row] = effort
        return _actuated(self._robot, efforts[:, self._velocities])

    def link_motion(self, link: str, positions: FloatArray) -> LinkMotion:
        """Where a link is at positions of all movable joints, and how actuated ones move it."""
        model, data = self._model, self._data
        data.qpos[self._positions] = positions
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        body, jacobian = self._bodies[link], np.empty((6, model.nv))
        mujoco.mj_jacBody(model, data, jacobian[:3], jacobian[3:], body)
        pose = SE3(data.xmat[body].reshape(3, 3).copy(), data.xpos[body].copy())
        return LinkMotion(pose, _actuated(self._robot, jacobian[:, self._velocities]))

    def inertia(self, positions: FloatArray) -> FloatArray:
        """The mass matrix in the actuated joints at positions of every movable joint, (m, m)."""
        model, data = self._model, self._data
        data.qpos[self._positions] = positions
        for stage in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_crb):
            stage(model, data)
        return _inertia(model, data, self._velocities, self._robot)


def set_rotor_inertia(spec: mujoco.MjSpec, description: RobotDescription, servos: Servos) -> None:
    """Give each actuated joint its rotor's inertia."""
    actuated = (joint for joint in description.movable_joints if joint.mimic is None)
    for joint, inertia in zip(actuated, servos.rotor_inertia, strict=True):
        spec.joint(joint.name).armature = inertia


def add_servos(spec: mujoco.MjSpec, description: RobotDescription, servos: Servos) -> None:
    """Add one force-limited actuator for each joint, under the joint's name."""
    set_rotor_inertia(spec, description, servos)
    actuated = (joint for joint in description.movable_joints if joint.mimic is None)
    for index, joint in enumerate(actuated):
        stiffness, damping = servos.stiffness[index], servos.damping[index]
        limit = servos.effort[index]
        actuator = spec.add_actuator(
            name=joint.name, target=joint.name, trntype=mujoco.mjtTrn.mjTRN_JOINT
        )
        actuator.gaintype = mujoco.mjtGain.mjGAIN_FIXED
        actuator.biastype = mujoco.mjtBias.mjBIAS_AFFINE
        actuator.gainprm[0] = stiffness
        actuator.biasprm[:3] = 0.0, -stiffness, -damping
        actuator.forcelimited = bool(np.isfinite(limit))
        if actuator.forcelimited:
            actuator.forcerange = -limit, limit
