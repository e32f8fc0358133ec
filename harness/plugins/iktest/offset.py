"""An error that many targets share: a wrong base height, a wrong tool, a turned base."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from harness.core.pose_arrays import rotation_vector
from harness.core.spatial import SE3, pitch_of, quat_wxyz_from_rotation
from harness.core.types import FloatArray
from harness.plugins.iktest.strategies.tasks import Task

SAME = 5e-4  # [m, rad] that two errors may differ by and still be one
APART = 0.02  # [m] between targets that count as different
LEAST_COUNT, LEAST_SHARE = 5, 0.15


@dataclass(frozen=True, eq=False)
class Offset:
    """The error that many answers share.

    Attributes:
        frame: `world`, or `link`: the reached link's own.
        is_everywhere: Whether no answer is right.
        error: Shift [m], then for poses the turn's rotation vector [rad], for positions with a
            pitch that of the pitch [rad]; shape (3,), (4,) or (6,).
    """

    frame: Literal["world", "link"]
    error: FloatArray
    is_everywhere: bool = True

    def explains(self, task: Task, target: SE3, reached: SE3) -> bool:
        """Whether a miss shows this error."""
        return bool(np.abs(_error(self.frame, task, target, reached) - self.error).max() < SAME)

    def text(self) -> str:
        """The error in words."""
        millimetres = numbers_text(1000 * self.error[:3], 1)
        parts = [f"off by ({millimetres}) mm"]
        angle = float(np.linalg.norm(self.error[3:]))
        if angle > SAME:
            turn = f"turned by {np.degrees(angle):.1f} deg"
            if len(self.error) == 6:
                turn += f" about ({numbers_text(self.error[3:] / angle, 2)})"
            else:
                turn += " down" if self.error[3] > 0 else " up"
            parts = [*(parts if np.linalg.norm(self.error[:3]) > SAME else []), turn]
        where = "the world's axes" if self.frame == "world" else "the link's own axes"
        targets = "every target" if self.is_everywhere else "many targets"
        return f"{' and '.join(parts)} in {where}, at {targets}"


def common_offset(task: Task, misses: Sequence[tuple[SE3, SE3]]) -> Offset | None:
    """The error that many misses share, if one does.

    Args:
        misses: Target poses and poses reached.
    """
    best: tuple[int, Offset] | None = None
    frames: tuple[Literal["world", "link"], ...] = ("world", "link")
    for frame in frames:
        if not misses:
            return None
        errors = np.array([_error(frame, task, target, reached) for target, reached in misses])
        alike = np.abs(errors[:, None] - errors[None]).max(axis=2) < SAME
        counts = alike.sum(axis=1)
        winner = int(np.argmax(counts))
        count = int(counts[winner])
        places = [misses[int(index)][0].translation for index in np.flatnonzero(alike[winner])]
        is_common = count >= LEAST_SHARE * len(misses) and number_of_places(places) >= LEAST_COUNT
        is_common = is_common and np.abs(errors[winner]).max() > SAME
        if is_common and (best is None or count > best[0]):
            best = count, Offset(frame, np.median(errors[alike[winner]], axis=0))
    return None if best is None else best[1]


def number_of_places(places: Sequence[FloatArray]) -> int:
    """How many of some points lie apart; Hypothesis tries a target and others next to it."""
    kept: list[FloatArray] = []
    for place in places:
        if all(float(np.linalg.norm(place - other)) > APART for other in kept):
            kept.append(place)
    return len(kept)


def _error(frame: str, task: Task, target: SE3, reached: SE3) -> FloatArray:
    """Shift of the link's origin, and for poses the whole change as one motion."""
    if task != "pose":
        shift = reached.translation - target.translation
        shift = shift if frame == "world" else reached.rotation.T @ shift
        if task == "position":
            return shift
        return np.append(shift, pitch_of(reached.rotation) - pitch_of(target.rotation))
    change = reached @ target.inverse() if frame == "world" else target.inverse() @ reached
    return np.concatenate([change.translation, matrix_rotation_vector(change.rotation)])


def matrix_rotation_vector(rotation: FloatArray) -> FloatArray:
    """Axis times angle [rad] of a rotation; of a half turn, the axis whose largest part is > 0."""
    quat = quat_wxyz_from_rotation(rotation)
    if quat[0] < 1e-6 and quat[1 + int(np.argmax(np.abs(quat[1:])))] < 0:
        quat[1:] *= -1.0
    return rotation_vector(quat)


def numbers_text(values: FloatArray, digits: int) -> str:
    """Numbers with so many digits after the point, none of them a negative zero."""
    return ", ".join(f"{round(float(value), digits) + 0.0:.{digits}f}" for value in values)
