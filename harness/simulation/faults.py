"""Injects faults into a running simulation: surfaces, motors, sensors, command latency."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from harness.core.types import FloatArray
from harness.simulation.geoms import set_smaller_frictions
from harness.simulation.model import PhysicsModel
from harness.simulation.step_state import wake

if TYPE_CHECKING:
    from harness.simulation.motors import Motors

STALL_SOLREF = (0.002, 1.0)
"""Time constant [s] and damping ratio of the stop that holds a stalled joint."""

STALL_SOLIMP = (0.9999, 0.9999, 0.001, 0.5, 2.0)
"""Its impedance: no motor moves the joint by 1e-4 rad."""


class MujocoFaults:
    """The active faults; the simulator passes its controls through `distorted`."""

    def __init__(self, physics: PhysicsModel, data: mujoco.MjData, motors: Motors) -> None:
        """Begin without faults.

        Args:
            motors: The simulator; a weak reference, or its memory would wait for the collector.
        """
        self._motors = motors
        self._physics = physics
        self._data = data
        self.grip_share: dict[int, float] = {}  # by the actuator of the gripper
        self._stalled: set[str] = set()
        self._deviation = 0.0
        self._latency = 0.0
        self._waiting = np.empty((0, len(physics.actuated)))  # delayed controls, oldest first
        self._rng = np.random.default_rng(0)
        self.noise = np.zeros((1, len(physics.actuated)))  # of the most recent samples

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
        return self._motors.weaken_gripper(joint, share)

    def stall_joint(self, joint: str) -> bool:
        """Hold a joint at its position by closing its range; its motor keeps pulling."""
        model, physics = self._physics.model, self._physics
        index = physics.description.joint_index[joint]
        mujoco_joint = int(model.dof_jntid[physics.dof[index]])
        model.jnt_limited[mujoco_joint] = True
        model.jnt_range[mujoco_joint] = float(self._data.qpos[physics.qpos[index]])
        model.jnt_solref[mujoco_joint] = STALL_SOLREF
        model.jnt_solimp[mujoco_joint] = STALL_SOLIMP
        was_stalled = joint in self._stalled
        self._stalled.add(joint)
        return was_stalled

    def push(self, forces: Mapping[str, FloatArray], duration: float) -> None:
        """Push free objects at their centres of mass, all at the same time."""
        bodies = [self._physics.objects[name].body for name in forces]
        self._data.xfrc_applied[bodies, :3] = list(forces.values())
        self._motors.hold(duration)
        self._data.xfrc_applied[bodies] = 0.0

    def disturb_sensors(self, deviation: float, seed: int) -> float:
        """Add white noise to the positions that the servos and the tolerance checks measure."""
        before, self._deviation = self._deviation, deviation
        self._rng = np.random.default_rng(seed)
        self.noise = self._draw(1)
        return before

    def delay_commands(self, latency: float) -> float:
        """Delay set points on the way to the motors; the current ones fill the delay."""
        before, self._latency = self._latency, latency
        samples = round(latency / self._physics.model.opt.timestep)
        self._waiting = np.tile(self._data.ctrl, (samples, 1))
        return before

    def distorted(self, controls: FloatArray, position_share: FloatArray) -> FloatArray:
        """The controls that arrive at the motors for the controls sent, both of shape (N + 1, m).

        Noise on a measured position acts on a servo like noise subtracted from its control.

        Args:
            position_share: 1 for a motor whose servo has a stiffness, else 0, shape (m,).
        """
        if not len(self._waiting) and not self._deviation:
            return controls
        count = len(controls) - 1
        sent = np.concatenate([self._waiting, controls])
        arrived, self._waiting = sent[: count + 1], sent[count : len(sent) - 1]
        if self._deviation:
            self.noise = np.concatenate([self.noise[-1:], self._draw(count)])
            return arrived - position_share * self.noise
        return arrived

    def measured_noise(self, samples: int) -> FloatArray:
        """Measurement noise of the most recent samples, shape (samples, m), or (1, m) of zeros."""
        if not self._deviation:
            return np.zeros((1, self.noise.shape[1]))
        return self.noise[-samples:]

    def _draw(self, samples: int) -> FloatArray:
        return self._rng.normal(0.0, self._deviation, (samples, self.noise.shape[1]))
