"""How far bodies move, and how fast: by the points of their shapes, wherever their frames are.

A body has moved as far as the point of it that moved furthest. Where it is, is its middle: the
centre of its mass. How high it is, is its lowest point
(`lowest_points`). The origin of a frame is where a designer put it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from harness.core.geometry import (
    Box,
    Capsule,
    Cylinder,
    Geometry,
    Mesh,
    Shape,
    Sphere,
    bounds_of,
    center_of,
    reach,
)
from harness.core.pose_arrays import rotate, rotations_of, times_each, turn_between
from harness.core.types import BoolArray, FloatArray
from harness.judging.temporal import first_within, trailing_max
from harness.judging.window import object_record, put_samples
from harness.recording.run import TIME_RESOLUTION, ObjectRecord, Run

SIGNS = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
"""The corners of a cube about the origin, shape (8, 3)."""

STILL = 0.05  # what moves at no time during so long is still; a turning point of a swing is not [s]


@dataclass(frozen=True, eq=False)
class Balls:
    """Balls whose convex hull holds the shapes of a body, and is no larger where it can be.

    Attributes:
        centers: Their centres in the body's frame [m], shape (k, 3).
        radii: Their radii [m], shape (k,).
    """

    centers: FloatArray
    radii: FloatArray

    def moved(self, before: FloatArray, after: FloatArray) -> FloatArray:
        """How far the point that moves furthest is from where it was [m], shape (N,).

        Exact for the corners of boxes; of other shapes an upper bound, which is exact without turn.

        Args:
            before: T_world_body, shape (N, 7), or (7,) for all.
            after: T_world_body, shape (N, 7).
        """
        before = np.broadcast_to(before, after.shape)
        turned = rotations_of(after[:, 3:]) - rotations_of(before[:, 3:])
        shift = after[:, :3] - before[:, :3]
        chord = 2 * np.sin(turn_between(before[:, 3:], after[:, 3:]) / 2)
        ways = times_each(turned, self.centers.T) + shift[:, :, None]
        return (np.linalg.norm(ways, axis=1) + chord[:, None] * self.radii).max(axis=1)

    def moved_at_most(self, before: FloatArray, after: FloatArray) -> FloatArray:
        """An upper bound of `moved` [m], shape (N,), without a look at each centre."""
        outermost = float((np.linalg.norm(self.centers, axis=1) + self.radii).max())
        chord = 2 * np.sin(turn_between(before[:, 3:], after[:, 3:]) / 2)
        return np.linalg.norm(after[:, :3] - before[:, :3], axis=1) + chord * outermost


def balls_of(record: ObjectRecord) -> Balls:
    """The balls of an object; its middle where it has no shape that is known.

    For all hulls of meshes together the corners of the box along the object's axes stand: they have
    hundreds of corners.
    """
    hulls = [shape for shape in record.shapes if _is_hull(shape)]
    found: list[tuple[FloatArray, float]] = []
    if (bounds := bounds_of(hulls)) is not None:
        lower, upper = bounds
        found += [(corner, 0.0) for corner in np.where(SIGNS > 0, upper, lower)]
    for shape in record.shapes:
        if _is_hull(shape):
            continue
        centers, radius = _balls(shape.geometry)
        placed = [(shape.pose.apply(center), radius) for center in centers]
        found += placed or [(middle_of(record), 0.0)]
    found = found or [(middle_of(record), 0.0)]
    return Balls(np.array([center for center, _ in found]), np.array([r for _, r in found]))


def _is_hull(shape: Shape) -> bool:
    return isinstance(shape.geometry, Mesh) and shape.geometry.hull is not None


def _balls(geometry: Geometry) -> tuple[FloatArray, float]:
    """Centres of balls of one radius whose hull holds a shape; none of planes and meshes."""
    match geometry:
        case Box(size=size):
            return 0.5 * SIGNS * np.array(size), 0.0
        case Cylinder(radius=radius, length=length) | Capsule(radius=radius, length=length):
            return np.array([[0, 0, -length / 2], [0, 0, length / 2]]), radius
        case Sphere(radius=radius):
            return np.zeros((1, 3)), radius
        case _:
            return np.zeros((0, 3)), 0.0


def middle_of(record: ObjectRecord) -> FloatArray:
    """The middle of a body in its frame [m], shape (3,): the centre of its mass.

    Where that was not recorded it is the mean of the middles of its shapes.
    """
    if record.center_of_mass:
        return np.array(record.center_of_mass)
    middles = [center_of(shape) for shape in record.shapes]
    return np.mean(middles, axis=0) if middles else np.zeros(3)


def middles(record: ObjectRecord, poses: FloatArray) -> FloatArray:
    """Where the middle of a body is [m], shape (N, 3)."""
    return poses[:, :3] + rotate(poses[:, 3:], middle_of(record))


def lowest_points(record: ObjectRecord, poses: FloatArray) -> FloatArray:
    """Height of an object's lowest point [m], shape (N,); of its middle where that is unknown."""
    lowest = [middles(record, poses)[:, 2]] if not record.shapes else []
    for shape in record.shapes:
        centre = poses[:, 2] + rotate(poses[:, 3:], shape.pose.translation)[:, 2]
        vertical = np.stack(  # height of the shape's axes
            [rotate(poses[:, 3:], shape.pose.rotation[:, axis])[:, 2] for axis in range(3)], axis=1
        )
        below = reach(shape.geometry, -vertical)
        lowest.append(middles(record, poses)[:, 2] if below is None else centre - below)
    return np.min(lowest, axis=0)


def body_speeds(
    run: Run, name: str, poses: FloatArray, here: BoolArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Speed of a body's fastest point [m/s] and its turning speed [rad/s], shape (N,) each.

    In the first `STILL` seconds after it appeared or was put somewhere the speeds are at most what
    it has moved since, divided by `STILL`: a body that stands exactly on its support falls for one
    step of the physics until a contact begins.

    Args:
        poses: T_world_body at each sample, NaN where it is absent or not known, shape (N, 7).
        here: Samples at which it is in the scene; by default those with a pose.
    """
    moved, turned = balls_of(object_record(run, name)).moved, _turned
    found: list[FloatArray] = []
    there = np.isfinite(poses.sum(axis=1)) if here is None else here
    appears = np.flatnonzero(there & ~np.append(False, there[:-1]))
    times = run.signals.times
    for way in (moved, turned):
        speeds = rates(run, name, poses, here, way)
        for first in np.union1d(appears, put_samples(run, name)).tolist():
            last = int(np.searchsorted(times, times[first] + STILL + TIME_RESOLUTION))
            settled = way(poses[first : first + 1], poses[first + 1 : last]) / STILL
            speeds[first + 1 : last] = np.minimum(speeds[first + 1 : last], settled)
        found.append(speeds)
    return found[0], found[1]


def _turned(before: FloatArray, after: FloatArray) -> FloatArray:
    return turn_between(before[:, 3:], after[:, 3:])


def rates(
    run: Run,
    name: str,
    poses: FloatArray,
    here: BoolArray | None,
    moved: Callable[[FloatArray, FloatArray], FloatArray],
) -> FloatArray:
    """What moves between two samples, divided by the time between them, shape (N,).

    The first sample, and that at which an object appears or shows where a step put it, is at rest
    by definition. Where this pose or the one before is not known the speed is NaN.
    """
    found, missing = np.zeros(len(poses)), np.isnan(poses).any(axis=1)
    found[1:] = moved(poses[:-1], poses[1:]) / np.diff(run.signals.times)
    appeared = np.isnan(found) & ~missing
    if here is not None:
        appeared &= ~np.append(False, here[:-1])
    appeared[put_samples(run, name)] = True
    found[appeared] = 0.0
    found[missing] = np.nan
    return found


def calm(run: Run, speed: FloatArray, here: BoolArray | None = None) -> FloatArray:
    """The largest speed of the last `STILL` seconds at each sample; NaN where it is not known.

    It looks beyond the start of a step, whose window may begin at a turning point.

    Args:
        run: The run, whose times count.
        speed: The speed at each sample, NaN where it is absent or not known, shape (N,).
        here: Samples at which it is in the scene, so that NaN means not known.
    """
    times, unknown = run.signals.times, np.isnan(speed)
    if here is not None:
        unknown = unknown | (trailing_max((unknown & here).astype(np.float64), times, STILL) > 0)
    return np.where(unknown, np.nan, trailing_max(np.nan_to_num(speed, nan=0.0), times, STILL))


def fastest_time(run: Run, speed: FloatArray, sample: int) -> float:
    """When the speed that `calm` gives at a sample was last measured [s]."""
    times = run.signals.times
    first = int(first_within(times, STILL)[sample])
    recent = np.nan_to_num(speed[first : sample + 1])
    is_largest = recent >= recent.max() * (1 - 1e-6)  # a constant speed, but for rounding
    return float(times[first + int(np.flatnonzero(is_largest)[-1])])
