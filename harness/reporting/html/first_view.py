"""What the first view of the 3D replay holds."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.geometry import Plane, bounding_radius
from harness.core.types import FloatArray
from harness.recording.run import ObjectRecord, Run
from harness.recording.stored_run import StoredRun
from harness.recording.touched import touched_objects

FARTHEST = 20.0  # [m]; what fell off the world is drawn there
LARGE = 0.6  # [m]: a table does not widen the first view
OUTSIDE = 1.3  # of the arm's size from its base: as far as a goal out of reach widens the view
NEARBY = 4.0  # of the arm's size from its base: what falls off the table widens no view
DIRECTIONS = 64  # in each of which the first view holds what is farthest
THINNEST_ARM = 0.1  # [m]: a hand alone is no smaller than its frames


@dataclass(frozen=True)
class Framing:
    """What a view holds besides the arm and what it touched.

    Attributes:
        named: Objects, even if the robot did not touch them.
        explained: Points that explain a failure; of a goal that is far away the direction.
        decisive: The interval of the failure, on which the page opens [s]; None where it opens on
            the whole run.
    """

    named: Collection[str] = ()
    explained: Sequence[Sequence[float]] = ()
    decisive: tuple[float, float] | None = None


WHOLE_RUN = Framing()


def decisive_time(stored: StoredRun) -> tuple[float, float] | None:
    """The interval of the first failure [s]: its step, or the moment of a verdict."""
    failed = [step for step in stored.run.steps if step.status == "failed"]
    if failed:
        first = max(failed, key=lambda step: step.path.count("."))
        return first.start_time, first.end_time
    times = [each.time for each in stored.verdicts if each.status == "failed"]
    return (times[0], times[0]) if times and np.isfinite(times[0]) else None


def first_view(
    run: Run, poses: Mapping[str, FloatArray], step: float, framing: Framing
) -> dict[str, Any]:
    """What the view holds, what it opens on, and a sphere around what the sun's shadow covers.

    Args:
        poses: The poses of each link, frame by frame, shape (N, 7).
        step: The time from one frame to the next [s].
    """
    near, wide, arm = _held(run, poses, framing)
    focus = {"points": _outermost(np.concatenate(near)), "arm": round(max(THINNEST_ARM, arm), 4)}
    facts = {"focus": focus, "bounds": _sphere([*near, *wide])}
    if framing.decisive is None:
        return facts
    start, end = framing.decisive
    frames = slice(int(start / step), int(end / step) + 2)
    first, last = np.searchsorted(run.signals.times, (start, end))
    moments = slice(max(0, int(first) - 1), int(last) + 1)
    near, _, _ = _held(run, {k: rows[frames] for k, rows in poses.items()}, framing, moments)
    return facts | {"opening": _outermost(np.concatenate(near))}


def _held(
    run: Run, poses: Mapping[str, FloatArray], framing: Framing, moments: slice = slice(None)
) -> tuple[list[FloatArray], list[FloatArray], float]:
    """Points that a view holds, those that the shadow covers too, and the arm's size [m]."""
    base = poses[run.robot.base_link][0, :3] if run.robot.base_link in poses else np.zeros(3)
    near = [rows[:, :3] for rows in poses.values()]
    near = [points for points in near if np.abs(points).max(initial=0.0) > 0]
    tcp = run.signals.tcp_pose[moments]
    near.append(tcp[:: max(1, len(tcp) // 500), :3])
    arm = max(float(np.linalg.norm(points - base, axis=1).max(initial=0.0)) for points in near)
    away = np.array(framing.explained or [base]) - base
    near.append(base + away * np.clip(OUTSIDE * arm / _lengths(away), 0, 1)[:, None])
    touched = {*framing.named, *touched_objects(run)}
    wide: list[FloatArray] = []
    for obj in run.objects:
        if any(isinstance(shape.geometry, Plane) for shape in obj.looks):
            continue
        centres, reach = _extent(run, obj, moments)
        if reach < LARGE and obj.name in touched:
            seen = centres[np.linalg.norm(centres - base, axis=1) < NEARBY * arm]
            near += [seen - reach, seen + reach]
        corners = np.concatenate([centres - reach, centres + reach])
        wide.append(np.clip(corners, base - 2.5, base + 2.5))
    return near, wide, arm


def _lengths(vectors: FloatArray) -> FloatArray:
    return np.maximum(np.linalg.norm(vectors, axis=1), 1e-9)


def _outermost(points: FloatArray) -> list[list[float]]:
    """The points of a cloud that are farthest in directions all around."""
    known = points[np.isfinite(points).all(axis=1)]
    if not len(known):
        return [[0.0, 0.0, 0.0]]
    number = np.arange(DIRECTIONS)
    height, turn = 1 - (2 * number + 1) / DIRECTIONS, number * np.pi * (3 - 5**0.5)
    flat = np.sqrt(1 - height**2)
    around = np.stack([flat * np.cos(turn), flat * np.sin(turn), height])
    return [rounded(known[row], 4) for row in np.unique(np.argmax(known @ around, axis=0))]


def _extent(run: Run, obj: ObjectRecord, moments: slice) -> tuple[FloatArray, float]:
    """Where an object's centre was, a few times, and how far it reaches from there [m]."""
    reach = max((bounding_radius(shape) for shape in obj.looks), default=0.0)
    recorded = run.signals.object_poses.get(obj.name)
    rows = np.array([obj.pose or (0.0,) * 7]) if recorded is None else recorded[moments]
    rows = rows[:: max(1, len(rows) // 20)]
    centres = rows[np.isfinite(rows).all(axis=1), :3]
    return np.clip(centres, -FARTHEST, FARTHEST), reach if np.isfinite(reach) else 0.3


def _sphere(clouds: Sequence[FloatArray]) -> dict[str, Any]:
    points = np.concatenate([cloud for cloud in clouds if len(cloud)] or [np.zeros((1, 3))])
    low, high = points.min(axis=0), points.max(axis=0)
    radius = max(0.15, 0.5 * float(np.linalg.norm(high - low)))
    return {"center": rounded((low + high) / 2), "radius": round(radius, 4)}


def rounded(values: Any, digits: int = 6) -> list[float]:
    """The numbers with as many decimals as a page needs."""
    return [round(float(value), digits) for value in values]
