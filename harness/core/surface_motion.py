"""The motion of the surface of an object that stays in its place: a belt, or a turntable."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.amounts import amount
from harness.core.pose_arrays import rotations_about
from harness.core.spatial import SE3
from harness.core.types import FloatArray


@dataclass(frozen=True)
class SurfaceMotion:
    """How the surface of a static object moves, in the object's axes.

    Attributes:
        velocity: The velocity of the surface at the object's origin [m/s].
        rotation: The rate at which the surface turns about the object's z axis [rad/s].
    """

    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation: float = 0.0

    @property
    def is_still(self) -> bool:
        """Whether the surface does not move."""
        return not any(self.velocity) and not self.rotation

    def between(self, other: SurfaceMotion, share: float) -> SurfaceMotion:
        """The motion at a share of the way to another one."""
        x, y, z = np.array(self.velocity) * (1 - share) + np.array(other.velocity) * share
        rotation = self.rotation * (1 - share) + other.rotation * share
        return SurfaceMotion((float(x), float(y), float(z)), float(rotation))

    def velocity_at(self, point: FloatArray) -> FloatArray:
        """The velocity of the surface at a point in the object's frame [m/s], shape (3,)."""
        return np.array(self.velocity) + self.rotation * np.array([-point[1], point[0], 0.0])

    def carried(self, pose: SE3, duration: float) -> SE3:
        """The pose, in the object's frame, of what the surface has carried for a duration [s]."""
        angle = self.rotation * duration
        turn = rotations_about(np.array([0.0, 0.0, 1.0]), angle)
        # The integral of the rotation over the duration turns the velocity into the displacement.
        along, across = duration * np.sinc(angle / np.pi), duration * _cosine_share(angle)
        x, y, z = self.velocity
        shift = np.array([along * x - across * y, across * x + along * y, duration * z])
        return SE3(turn @ pose.rotation, turn @ pose.translation + shift)

    def __str__(self) -> str:
        speed = float(np.linalg.norm(self.velocity))
        parts = [amount(speed, "m/s")] if speed or not self.rotation else []
        return ", ".join([*parts, *([amount(self.rotation, "rad/s")] if self.rotation else [])])


def _cosine_share(angle: float) -> float:
    """(1 - cos a) / a, which is 0 at 0."""
    return float(np.sin(angle / 2) * np.sinc(angle / (2 * np.pi)))
