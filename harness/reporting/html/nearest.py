"""The points at which two bodies are nearest, as a clearance is drawn."""

from __future__ import annotations

import numpy as np

from harness.core.geometry import Box, Capsule, Cylinder, Plane, Shape, Sphere
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.recording.link_poses import replayed_link_poses
from harness.recording.run import Run
from harness.recording.verdict import Measure, Verdict
from harness.reporting.html.first_view import rounded

PROJECTIONS = 400  # back and forth between two shapes; flat sides meet after a few
WRONG = 1e-3  # [m]: points that are farther off the recorded distance are not shown


def nearest_points(run: Run, verdict: Verdict) -> dict[str, list[float]] | None:
    """The nearest points of the pair whose clearance decided a verdict, in the world.

    None where they are not known: bodies that overlap, or whose collision shapes are meshes.
    """
    measure = next((each for each in verdict.measures if each.plot == "clearance"), None)
    if measure is None or measure.unit != "m" or not np.isfinite(verdict.time):
        return None
    first, _, second = measure.detail.partition(" and ")
    sample = int(np.searchsorted(run.signals.times, measure.time - 1e-9))
    bodies = [
        _shapes_at(run, name, min(sample, len(run.signals.times) - 1)) for name in (first, second)
    ]
    found = [points for a in bodies[0] for b in bodies[1] if (points := _between(a, b)) is not None]
    if not found:
        return None
    one, two = min(found, key=lambda points: float(np.linalg.norm(points[1] - points[0])))
    if not _is_recorded(float(np.linalg.norm(two - one)), measure, run):
        return None
    return {"expected": rounded(one), "actual": rounded(two)}


def _is_recorded(distance: float, measure: Measure, run: Run) -> bool:
    """Whether a distance is the one that was judged, of `clearance` and of its loss alike."""
    if measure.name == "clearance":
        return abs(distance - measure.value) <= WRONG
    return distance < run.signals.clearance_cutoff


def _shapes_at(run: Run, name: str, sample: int) -> list[tuple[Shape, FloatArray]]:
    """The collision shapes of a link or an object, each with T_world_shape (4, 4)."""
    link = next((each for each in run.robot.links if each.name == name), None)
    if link is not None:
        pose = replayed_link_poses(run.robot, run.signals.joint_positions[[sample]], [name])[name][
            0
        ]
        shapes = link.collisions
    else:
        obj = next((each for each in run.objects if each.name == name), None)
        recorded = run.signals.object_poses.get(name)
        if obj is None or (recorded is None and not obj.pose):
            return []
        pose = np.array(obj.pose) if recorded is None else recorded[sample]
        shapes = obj.shapes
    T_world_body = SE3.from_vector(pose).matrix()
    return [(shape, T_world_body @ shape.pose.matrix()) for shape in shapes]


def _between(
    one: tuple[Shape, FloatArray], two: tuple[Shape, FloatArray]
) -> tuple[FloatArray, FloatArray] | None:
    """Nearest points of two convex shapes that do not meet, by projections in turns.

    Projecting a point on two closed convex sets in turns converges to their nearest points [1].

    References:
        [1] W. Cheney and A. Goldstein, "Proximity Maps for Convex Sets", Proc. AMS 10, 1959.
    """
    point = two[1][:3, 3]
    other = point
    for _ in range(PROJECTIONS):
        before = point
        on_one = _projected(other, *one)
        if on_one is None or (on_two := _projected(on_one, *two)) is None:
            return None
        point, other = on_one, on_two
        if np.abs(point - before).max() < 1e-7:
            break
    return None if np.linalg.norm(point - other) < 1e-6 else (point, other)


def _projected(point: FloatArray, shape: Shape, T_world_shape: FloatArray) -> FloatArray | None:
    """The nearest point of a shape; None for a mesh."""
    rotation, origin = T_world_shape[:3, :3], T_world_shape[:3, 3]
    local = rotation.T @ (point - origin)
    match shape.geometry:
        case Box(size=size):
            half = np.array(size) / 2
            nearest = np.clip(local, -half, half)
        case Cylinder(radius=radius, length=length):
            nearest = np.append(
                _shortened(local[:2], radius), np.clip(local[2], -length / 2, length / 2)
            )
        case Capsule(radius=radius, length=length):
            core = np.array([0.0, 0.0, np.clip(local[2], -length / 2, length / 2)])
            nearest = core + _shortened(local - core, radius)
        case Sphere(radius=radius):
            nearest = _shortened(local, radius)
        case Plane():
            nearest = np.append(local[:2], min(local[2], 0.0))
        case _:
            return None
    return rotation @ nearest + origin


def _shortened(vector: FloatArray, most: float) -> FloatArray:
    length = float(np.linalg.norm(vector))
    return vector if length <= most else vector * (most / length)
