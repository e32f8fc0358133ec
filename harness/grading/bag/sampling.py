"""Interpolation of recorded rows, except in gaps."""

from __future__ import annotations

import numpy as np

from harness.core.types import FloatArray

SHORTEST_GAP, LONGEST_GAP = 0.1, 1.5
"""Bounds of the time between two messages, or beyond the first and last, that counts as a gap [s].

A burst of lost messages is shorter than the first; a topic at 1 Hz has no gaps.
"""
GAP_PERIODS = 10
"""Between the bounds a gap is longer than so many of the topic's median periods."""


def gap_limit(times: FloatArray) -> float:
    """The longest time between two messages of a topic over which its value is known [s].

    Args:
        times: Rising times of its messages [s].
    """
    period = float(np.median(np.diff(times))) if len(times) > 1 else LONGEST_GAP
    return float(np.clip(GAP_PERIODS * period, SHORTEST_GAP, LONGEST_GAP))


def with_gaps_filled(times: FloatArray) -> FloatArray:
    """Rising sample times with further ones inside each gap, at which nothing is known [s].

    The first and last are a median period from the edges, and at most `MOST_FILLED` in a gap.
    """
    steps = np.diff(times)
    period, limit = float(np.median(steps)), gap_limit(times)
    inside: list[FloatArray] = []
    for index in np.flatnonzero(steps > limit):
        count = min(int(steps[index] / period), MOST_FILLED)
        inside.append(np.linspace(times[index] + period, times[index + 1] - period, count))
    return np.sort(np.concatenate([times, *inside]))


MOST_FILLED = 1000
"""Samples in a gap; more would say no more of an hour in which nothing was recorded."""


def rows_at(times: FloatArray, rows: FloatArray, sample_times: FloatArray) -> FloatArray:
    """Linear interpolation of rows; NaN in gaps; shape (len(sample_times), width).

    Args:
        times: Times of the rows [s], in any order; of equal times the first is used.
        rows: Rows, shape (N, width).
        sample_times: The times of the samples, rising [s].
    """
    times, first = np.unique(times, return_index=True)
    rows = rows[first]
    after = np.clip(np.searchsorted(times, sample_times), 0, len(times) - 1)
    before = np.clip(np.searchsorted(times, sample_times, side="right") - 1, 0, len(times) - 1)
    span = times[after] - times[before]
    share = np.where(span > 0, (sample_times - times[before]) / np.where(span > 0, span, 1.0), 0.0)
    found = rows[before] + share[:, None] * (rows[after] - rows[before])
    beyond = np.maximum(times[0] - sample_times, sample_times - times[-1])
    limit = gap_limit(times)
    return np.where(((span > limit) | (beyond > limit))[:, None], np.nan, found)


def interpolated_poses(
    times: FloatArray, poses: FloatArray, sample_times: FloatArray
) -> FloatArray:
    """Interpolation of poses (xyz, quat wxyz); NaN in gaps; shape (len(sample_times), 7).

    A single pose applies at all times: it was published once because nothing moves. Quaternions are
    interpolated linearly along the shorter way, which is accurate between adjacent messages.
    """
    if len(poses) == 1:
        return np.tile(poses[0], (len(sample_times), 1))
    order = np.argsort(times, kind="stable")
    times, poses = times[order], poses[order].copy()
    turns = np.einsum("ij,ij->i", poses[1:, 3:], poses[:-1, 3:])
    signs = np.concatenate([[1.0], np.cumprod(np.where(turns < 0, -1.0, 1.0))])
    poses[:, 3:] *= signs[:, None]
    found = rows_at(times, poses, sample_times)
    with np.errstate(invalid="ignore"):
        found[:, 3:] /= np.linalg.norm(found[:, 3:], axis=1, keepdims=True)
    return found
