"""Moves the surfaces of static objects: belts and turntables."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import mujoco
import numpy as np

from harness.core.spatial import rotation_from_quat_wxyz
from harness.core.surface_motion import SurfaceMotion
from harness.core.types import FloatArray
from harness.simulation.model import PhysicsModel
from harness.simulation.recording import Recording
from harness.simulation.step_state import wake


class Surfaces:
    """The motions of belts and turntables, with the history that reconstructs every sample.

    Attributes:
        log: Since which samples the surface of each belt moves how.
    """

    def __init__(self, physics: PhysicsModel, data: mujoco.MjData, recording: Recording) -> None:
        self._physics, self._data, self._recording = physics, data, recording
        self.log = dict[str, list[tuple[int, SurfaceMotion]]]()
        for name, place in physics.objects.items():
            if place.obj.surface_motion is not None:
                self.log[name] = [(0, place.obj.surface_motion)]
                self._write(name, place.obj.surface_motion)

    def motion(self, name: str) -> SurfaceMotion:
        """How the surface of a belt moves now."""
        return self.log[name][-1][1]

    def set(self, name: str, motion: SurfaceMotion) -> None:
        """Let the surface of a belt move from now on; what rests on it wakes."""
        self.log[name].append((self._recording.count, motion))
        self._write(name, motion)
        wake(self._physics.model, self._data)

    def recorded(self, first: int = 0) -> dict[str, FloatArray]:
        """Velocity of each surface since the sample before: x, y, z [m/s], turn [rad/s], (N, 4)."""
        velocities: dict[str, FloatArray] = {}
        for name, log in self.log.items():
            rows = velocities[name] = np.zeros((self._recording.count - first, 4))
            for begin, motion in log:
                rows[max(0, begin - first) :] = [*motion.velocity, motion.rotation]
        return velocities

    def _write(self, name: str, motion: SurfaceMotion) -> None:
        """Set the velocity of each geom's surface: at the geom's origin, in the geom's axes."""
        model, geoms = self._physics.model, self._physics.objects[name].geoms
        for geom in range(geoms.start, geoms.stop):
            turn = rotation_from_quat_wxyz(model.geom_quat[geom]).T
            model.geom_surfacevel[geom, :3] = turn @ motion.velocity_at(model.geom_pos[geom])
            model.geom_surfacevel[geom, 3:] = turn @ np.array([0.0, 0.0, motion.rotation])
