"""Objects on belts and turntables: what carries them, and where they will be."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from harness.cell.cell import Cell
from harness.cell.supports import top_of
from harness.core.errors import StepFailed
from harness.core.spatial import SE3
from harness.core.surface_motion import SurfaceMotion
from harness.core.types import FloatArray
from harness.recording.explanation import Explanation

LIES_ON = 0.005  # [m], between the bottom of an object and the top of the belt that carries it
LOOK_AHEAD = 30.0  # [s]: farther ahead, slip and rolling make a prediction worthless


@dataclass(frozen=True, eq=False)
class Ride:
    """An object that a surface carries.

    Attributes:
        object: The name of the object.
        belt: The name of the belt or turntable.
        motion: How its surface moves.
        belt_pose: The pose T_world_belt of the belt.
        start: The present pose T_belt_object of the object.
        top: Least and largest x and y of the surface, in the belt's frame, shape (2, 2) [m].
    """

    object: str
    belt: str
    motion: SurfaceMotion
    belt_pose: SE3
    start: SE3
    top: FloatArray

    def pose(self, duration: float) -> SE3:
        """T_world_object after a duration [s]."""
        return self.belt_pose @ self.motion.carried(self.start, duration)

    @property
    def speed(self) -> float:
        """The speed of the object now [m/s]."""
        return float(np.linalg.norm(self.motion.velocity_at(self.start.translation)))

    def is_on(self, duration: float) -> bool:
        """Whether the belt still carries the object after a duration [s]."""
        at = self.motion.carried(self.start, duration).translation[:2]
        return bool((self.top[0] <= at).all() and (at <= self.top[1]).all())

    @property
    def ends(self) -> float:
        """The time until the object leaves the belt, at most `LOOK_AHEAD` [s]."""
        times = np.arange(0.0, LOOK_AHEAD, 0.05)
        return next((float(time) for time in times if not self.is_on(float(time))), LOOK_AHEAD)


@contextmanager
def expecting(name: str, pose: SE3, cell: Cell) -> Generator[None]:
    """Plan as if an object stood at T_world_object, where a belt will have brought it."""
    cell.expected[name] = pose
    cell.sync_scene()
    try:
        yield
    finally:
        del cell.expected[name]
        cell.sync_scene()


def ride_of(name: str, cell: Cell, pose: SE3 | None = None) -> Ride:
    """The ride of an object on the belt or turntable that it lies on, or will lie on at a pose.

    Raises:
        StepFailed: INVALID_OBJECT_NAME, when it lies on none.
    """
    cell.sync_scene()
    pose = pose or cell.measured_pose(name)
    points = pose.apply(cell.scene.corners(name))
    for belt, presence in cell.presence.items():
        if presence.obj.surface_motion is None or belt not in cell.scene.object_names():
            continue
        frame = cell.frame(belt)
        low, high = top_of(cell.scene.corners(belt))
        start, bottom = frame.inverse() @ pose, frame.inverse().apply(points)[:, 2].min()
        motion = cell.simulator.surface_motion(belt)
        ride = Ride(name, belt, motion, frame, start, np.array([low[:2], high[:2]]))
        if abs(bottom - high[2]) < LIES_ON and ride.is_on(0.0):
            return ride
    belts = [belt for belt, each in cell.presence.items() if each.obj.surface_motion is not None]
    advice = "leave out `track`" if not belts else f"put it on {' or '.join(map(repr, belts))}"
    raise StepFailed(
        "INVALID_OBJECT_NAME",
        f"'{name}' lies on no belt and no turntable, so there is nothing to track",
        Explanation(advice=advice),
    )
