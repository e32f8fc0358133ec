"""Moves the surfaces of static objects: belts and turntables."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import mujoco
import numpy as np

from harness.core.spatial import rotation_from_quat_wxyz
from harness.core.surface_motion import SurfaceMotion
from harness.simulation.model import PhysicsModel
from harness.simulation.step_state import wake


class Surfaces:
    """How the surfaces of static objects move now.

    Attributes:
        motions: The motion of each belt and turntable, by name.
    """

    def __init__(self, physics: PhysicsModel, data: mujoco.MjData) -> None:
        self._physics, self._data = physics, data
        self.motions = dict[str, SurfaceMotion]()
        for name, place in physics.objects.items():
            if place.obj.surface_motion is not None:
                self._set(name, place.obj.surface_motion)

    def set(self, name: str, motion: SurfaceMotion) -> None:
        """Let the surface of a belt move from now on; what rests on it wakes."""
        self._set(name, motion)
        wake(self._physics.model, self._data)

    def _set(self, name: str, motion: SurfaceMotion) -> None:
        """Write the velocity of each geom's surface: at the geom's origin, in the geom's axes."""
        self.motions[name] = motion
        model, geoms = self._physics.model, self._physics.objects[name].geoms
        for geom in range(geoms.start, geoms.stop):
            turn = rotation_from_quat_wxyz(model.geom_quat[geom]).T
            model.geom_surfacevel[geom, :3] = turn @ motion.velocity_at(model.geom_pos[geom])
            model.geom_surfacevel[geom, 3:] = turn @ np.array([0.0, 0.0, motion.rotation])
