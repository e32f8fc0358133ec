"""What distorts commands and measurements in the physics: latency, noise, and weak grippers."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import mujoco
import numpy as np

from harness.core.types import FloatArray
from harness.simulation.model import PhysicsModel


class Disturbance:
    """The active disturbances, none at first; the simulator passes its controls through them.

    Attributes:
        grip_share: The share of its effort that a gripper has, by its actuator.
        deviation: The standard deviation of the noise of measured positions [rad or m].
        waiting: Controls that are delayed, the oldest first, shape (n, m).
        noise: The noise of the most recent samples, shape (n, m).
        sources: Where the noise of how many joints each comes from.
    """

    def __init__(self, physics: PhysicsModel, data: mujoco.MjData) -> None:
        self.physics, self.data = physics, data
        self.grip_share: dict[int, float] = {}
        self.deviation, self.latency = 0.0, 0.0
        self.waiting = np.empty((0, len(physics.actuated)))
        self.sources = [(np.random.default_rng(0), len(physics.actuated))]
        self.noise = np.zeros((1, len(physics.actuated)))

    def distorted(self, controls: FloatArray, position_share: FloatArray) -> FloatArray:
        """The controls that arrive at the motors for the controls sent, both of shape (N + 1, m).

        Noise on a measured position acts on a servo like noise subtracted from its control.

        Args:
            position_share: 1 for a motor whose servo has a stiffness, else 0, shape (m,).
        """
        if not len(self.waiting) and not self.deviation:
            return controls
        count = len(controls) - 1
        sent = np.concatenate([self.waiting, controls])
        arrived, self.waiting = sent[: count + 1], sent[count : len(sent) - 1]
        if self.deviation:
            self.noise = np.concatenate([self.noise[-1:], self.draw(count)])
            return arrived - position_share * self.noise
        return arrived

    def measured_noise(self, samples: int) -> FloatArray:
        """Measurement noise of the most recent samples, shape (samples, m), or (1, m) of zeros."""
        if not self.deviation:
            return np.zeros((1, self.noise.shape[1]))
        return self.noise[-samples:]

    def draw(self, samples: int) -> FloatArray:
        """Noise of samples to come, shape (samples, m)."""
        return np.hstack([rng.normal(0.0, self.deviation, (samples, n)) for rng, n in self.sources])
