"""Begins faults in a running simulation: surfaces, motors, sensors, command latency."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Mapping
from zlib import crc32

import numpy as np

from harness.core.types import FloatArray
from harness.simulation.geoms import set_smaller_frictions
from harness.simulation.mujoco_simulator import MujocoSimulator
from harness.simulation.step_state import wake

STALL_SOLREF = (0.002, 1.0)
"""Time constant [s] and damping ratio of the stop that holds a stalled joint."""

STALL_SOLIMP = (0.9999, 0.9999, 0.001, 0.5, 2.0)
"""Its impedance: no motor moves the joint by 1e-4 rad."""


class Injection:
    """Begins faults; each call returns what stood before, so that no change is recognised."""

    def __init__(self, simulator: MujocoSimulator) -> None:
        self._simulator, self._disturbance = simulator, simulator.disturbance
        self._physics, self._data = simulator.physics, simulator.disturbance.data

    def set_friction(self, name: str, sliding: float) -> float:
        """Change an object's sliding friction, and its other frictions in proportion."""
        model, place = self._physics.model, self._physics.objects[name]
        old = place.obj.friction
        before = float(model.geom_friction[place.geoms][0, 0])
        ratio = sliding / old.sliding if old.sliding > 0 else 1.0
        new = (sliding, old.torsional * ratio, old.rolling * ratio)
        model.geom_friction[place.geoms] = new
        set_smaller_frictions(model)
        wake(model, self._data)
        return before

    def weaken_gripper(self, share: float, joint: str = "") -> float:
        """Limit a gripper to a share of its effort, now and for every later command."""
        simulator, shares = self._simulator, self._disturbance.grip_share
        actuator = simulator.actuator_of(simulator.gripper(joint))
        before, shares[actuator] = shares.get(actuator, 1.0), share
        simulator.renew_grip_limit()
        return before

    def stall_joint(self, joint: str) -> bool:
        """Hold a joint at its position by closing its range; its motor keeps pulling."""
        model, physics = self._physics.model, self._physics
        index = physics.description.joint_index[joint]
        mujoco_joint = int(model.dof_jntid[physics.dof[index]])
        lower, upper = model.jnt_range[mujoco_joint]
        was_stalled = bool(model.jnt_limited[mujoco_joint] and lower == upper)
        model.jnt_limited[mujoco_joint] = True
        model.jnt_range[mujoco_joint] = float(self._data.qpos[physics.qpos[index]])
        model.jnt_solref[mujoco_joint] = STALL_SOLREF
        model.jnt_solimp[mujoco_joint] = STALL_SOLIMP
        return was_stalled

    def push(self, forces: Mapping[str, FloatArray], duration: float) -> None:
        """Push free objects at their centres of mass, all at the same time."""
        bodies = [self._physics.objects[name].body for name in forces]
        self._data.xfrc_applied[bodies, :3] = list(forces.values())
        self._simulator.hold(duration)
        self._data.xfrc_applied[bodies] = 0.0

    def disturb_sensors(self, deviation: float, seed: int) -> float:
        """Add white noise to the positions that the servos and the tolerance checks measure."""
        disturbance = self._disturbance
        before, disturbance.deviation = disturbance.deviation, deviation
        names, joints = self._physics.description.joint_names, self._physics.actuated
        seeds = [[seed, crc32(names[joint].encode())] for joint in joints]
        sources = [(np.random.default_rng(each), 1) for each in seeds]
        is_cell = self._physics.description.is_cell  # joints of other robots draw nothing of it
        disturbance.sources = sources if is_cell else [(np.random.default_rng(seed), len(joints))]
        disturbance.noise = disturbance.draw(1)
        return before

    def delay_commands(self, latency: float) -> float:
        """Delay set points on the way to the motors; the current ones fill the delay."""
        before, self._disturbance.latency = self._disturbance.latency, latency
        samples = round(latency / self._physics.model.opt.timestep)
        self._disturbance.waiting = np.tile(self._data.ctrl, (samples, 1))
        return before
