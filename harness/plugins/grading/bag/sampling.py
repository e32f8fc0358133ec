"""Interpolation of recorded rows, except where nothing is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.pose_arrays import conjugate, quat_product, rotation_angle
from harness.core.types import BoolArray, FloatArray

SHORTEST_GAP, LONGEST_GAP = 0.1, 1.5
"""Bounds of the time between two messages, or beyond the first and last, that counts as a gap [s].

A burst of lost messages is shorter than the first; a topic at 1 Hz has no gaps.
"""
GAP_PERIODS = 10  # between the bounds a gap is longer than so many of the topic's median periods
LONGEST_MOTION = 0.25
"""Longest time between two messages over which a motion is interpolated [s]: an arm that
accelerates by 2 m/s^2 is 16 mm off the straight line then. Over a longer time only what is the same
at both messages is known in between. The topics of a recorder begin so far apart, too."""
SAME_PLACE, SAME_ORIENTATION = 0.01, 0.05
"""An object that moves and turns by less from one message to the next stands still [m, rad]."""


@dataclass(frozen=True, eq=False)
class Trace:
    """What was recorded of one thing, and where nothing is known of it.

    Attributes:
        times: Rising times of the rows [s], shape (N,), N > 0.
        rows: What was recorded, shape (N, width).
        steps: The change from each row to the next, shape (N - 1, width).
        is_hole: Whether nothing is known between each row and the next, shape (N - 1,).
        reach: How long before the first and after the last row they apply [s].
    """

    times: FloatArray
    rows: FloatArray
    steps: FloatArray
    is_hole: BoolArray
    reach: tuple[float, float]

    @classmethod
    def of(
        cls, times: FloatArray, rows: FloatArray, steps: FloatArray, is_moving: BoolArray
    ) -> Trace:
        """A trace of rows at rising times; `is_moving` says which steps are motions, (N - 1,)."""
        limit, spans = gap_limit(times), np.diff(times)
        is_hole = (spans > limit) | (is_moving & (spans > LONGEST_MOTION))
        moves = is_moving if len(is_moving) else np.array([False])
        first = LONGEST_MOTION if moves[0] else max(limit, LONGEST_MOTION)
        last = min(limit, LONGEST_MOTION) if moves[-1] else limit
        return cls(times, rows, steps, is_hole, (first, last))

    def at(self, sample_times: FloatArray) -> FloatArray:
        """Linear interpolation; NaN where nothing is known, shape (len(sample_times), width)."""
        last = len(self.times) - 1
        before = np.clip(np.searchsorted(self.times, sample_times, side="right") - 1, 0, last)
        since = sample_times - self.times[before]
        spans = np.append(np.diff(self.times), np.inf)[before]
        steps = np.concatenate([self.steps, np.zeros_like(self.rows[:1])])[before]
        found = self.rows[before] + (np.clip(since, 0, None) / spans)[:, None] * steps
        unknown = np.append(self.is_hole, False)[before] & (since > 0)
        unknown |= (since < -self.reach[0]) | ((before == last) & (since > self.reach[1]))
        return np.where(unknown[:, None], np.nan, found)


def first_of_each(times: FloatArray, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rising times and their rows, of messages in any order; the first of equal times."""
    times, first = np.unique(times, return_index=True)
    return times, rows[first]


def gap_limit(times: FloatArray) -> float:
    """The longest time between two messages of a topic over which its value is known [s]."""
    period = float(np.median(np.diff(times))) if len(times) > 1 else LONGEST_GAP
    return float(np.clip(GAP_PERIODS * period, SHORTEST_GAP, LONGEST_GAP))


def sample_times(traces: Sequence[Trace]) -> FloatArray:
    """The times of all rows of all traces, and two in each hole that has none inside [s]."""
    times = np.unique(np.concatenate([trace.times for trace in traces]))
    begins = np.concatenate([trace.times[:-1][trace.is_hole] for trace in traces])
    ends = np.concatenate([trace.times[1:][trace.is_hole] for trace in traces])
    is_empty = np.searchsorted(times, begins, side="right") == np.searchsorted(times, ends)
    begins, ends = begins[is_empty], ends[is_empty]
    inset = np.minimum((ends - begins) / 3, SHORTEST_GAP / 2)
    return np.unique(np.concatenate([times, begins + inset, ends - inset]))


def pose_trace(times: FloatArray, poses: FloatArray) -> Trace:
    """The trace of poses (xyz, quat wxyz) in any order.

    A single pose applies at all times: it was published once because nothing moves. Quaternions are
    interpolated linearly along the shorter way, which is accurate between adjacent messages; they
    do not have unit length then.
    """
    times, poses = first_of_each(times, poses)
    turns = np.einsum("ij,ij->i", poses[1:, 3:], poses[:-1, 3:])
    poses[:, 3:] *= np.cumprod(np.append(1.0, np.where(turns < 0, -1.0, 1.0)))[:, None]
    steps = np.diff(poses, axis=0)
    moves = np.linalg.norm(steps[:, :3], axis=1) > SAME_PLACE
    trace = Trace.of(times, poses, steps, moves | (turned(poses[:, 3:]) > SAME_ORIENTATION))
    return trace if len(poses) > 1 else replace(trace, reach=(np.inf, np.inf))


def turned(quats: FloatArray) -> FloatArray:
    """Angle from each orientation to the next [rad], shape (N - 1,)."""
    return rotation_angle(quat_product(conjugate(quats[:-1]), quats[1:]))
