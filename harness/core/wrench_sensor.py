"""A sensor of force and torque between two links of a robot, with all parameters resolved."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from harness.core.pose_arrays import conjugate, rotate
from harness.core.spatial import SE3
from harness.core.types import FloatArray


@dataclass(frozen=True, eq=False)
class WrenchSensor:
    """Measures the wrench with which a link, and all that it carries, acts on the link before it.

    Attributes:
        name: The name, unique in a run.
        link: The first link that it carries; the sensor is in the joint before this link.
        pose: T_link_sensor; force and torque are in its axes, the torque about its origin.
        rate: Readings in a second [Hz]; inf for one at every physics sample.
        force_noise: Standard deviation of each component of the force [N].
        torque_noise: Standard deviation of each component of the torque [N m].
    """

    name: str
    link: str
    pose: SE3 = field(default_factory=SE3.identity)
    rate: float = float("inf")
    force_noise: float = 0.0
    torque_noise: float = 0.0

    @property
    def frame_id(self) -> str:
        """The frame of its messages: its link, where it has the link's frame."""
        is_link = self.pose.distance_to(SE3.identity()) == (0.0, 0.0)
        return self.link if is_link else f"{self.name}_wrench_frame"


@dataclass(frozen=True, eq=False)
class Payload:
    """What a sensor carries, whose weight is subtracted from its readings.

    Attributes:
        mass: The mass of what it carries [kg].
        center_of_mass: Its centre of mass in the axes of the sensor's link [m], shape (3,).
    """

    mass: float
    center_of_mass: FloatArray

    def weight(
        self, sensor: WrenchSensor, link_poses: FloatArray, gravity: FloatArray
    ) -> FloatArray:
        """Force and torque of its weight, as the sensor reads them, shape (N, 6) [N, N m].

        Args:
            link_poses: T_world_link of the sensor's link (xyz, quat wxyz), shape (N, 7).
            gravity: The gravitational acceleration in the world, shape (3,).
        """
        force = self.mass * rotate(conjugate(link_poses[:, 3:]), gravity) @ sensor.pose.rotation
        place = sensor.pose.inverse().apply(self.center_of_mass)
        return np.hstack([force, np.cross(place, force)])
