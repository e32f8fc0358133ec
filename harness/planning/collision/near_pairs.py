"""Measures the pairs of bodies that are near each other at a state."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import coal
import numpy as np
import pinocchio as pin

from harness.core.types import FloatArray, IntArray
from harness.planning.collision.rigid_shapes import RigidShapes
from harness.planning.model.robot_model import pin_from_se3

_ROUNDING = 1e-9  # [m] of the corners of boxes
_MEASURED = 1e-4  # [m] extra margin within which shapes are measured

_FAR = 1e6  # Where the box around a half space ends [m]


class PlacedShapes:
    """The shapes of all bodies with the boxes around them, placed by the joints that move them."""

    def __init__(self, bodies: Sequence[RigidShapes]) -> None:
        self._shapes = [(rigid, number) for rigid in bodies for number in range(len(rigid.shapes))]
        self._joints = np.array([rigid.joint for rigid, _ in self._shapes], dtype=np.int64)
        boxes = np.concatenate([np.empty((0, 6)), *(rigid.boxes for rigid in bodies)])
        low, high = np.clip(boxes[:, :3], -_FAR, _FAR), np.clip(boxes[:, 3:], -_FAR, _FAR)
        self._middles, self._halves = 0.5 * (low + high), 0.5 * (high - low)

    def near(
        self, poses: Sequence[pin.SE3], rows: IntArray, margins: FloatArray
    ) -> Iterator[tuple[int, float]]:
        """The rows whose shapes are not farther apart than their margins, with their distances [m].

        Only shapes whose boxes are that near are checked.
        """
        rotations = np.array([pose.rotation for pose in poses])[self._joints]
        places = np.array([pose.translation for pose in poses])[self._joints]
        middles = (rotations @ self._middles[:, :, None])[:, :, 0] + places
        halves = (np.abs(rotations) @ self._halves[:, :, None])[:, :, 0]
        first, second = rows.T
        apart = np.abs(middles[first] - middles[second]) - halves[first] - halves[second]
        most = np.maximum(margins, 0.0) + _ROUNDING
        for row in np.flatnonzero(apart.max(axis=1) <= most).tolist():
            solids = [self._solid(index, poses) for index in rows[row].tolist()]
            distance = _distance_within(float(margins[row]), *solids[0], *solids[1])
            if distance <= margins[row]:
                yield row, distance

    def _solid(self, index: int, poses: Sequence[pin.SE3]) -> tuple[Any, coal.Transform3s]:
        """Coal's geometry of a shape, and its pose in the world."""
        rigid, number = self._shapes[index]
        pose = poses[rigid.joint] * pin_from_se3(rigid.shapes[number].pose)
        return rigid.solids[number], coal.Transform3s(pose.rotation, pose.translation)


def _distance_within(margin: float, *placed: Any) -> float:
    """The signed distance of two shapes [m]; infinite where a check of collisions finds none.

    The check takes a tenth of the time.
    """
    request = coal.CollisionRequest(coal.CollisionRequestFlag.NO_REQUEST, 1)
    request.security_margin = margin + _MEASURED
    if not coal.collide(*placed, request, coal.CollisionResult()):
        return np.inf
    return float(coal.distance(*placed, coal.DistanceRequest(), coal.DistanceResult()))
