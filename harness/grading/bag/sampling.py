"""Interpolation of recorded rows, except in gaps."""

from __future__ import annotations

import numpy as np

from harness.core.types import FloatArray

LONGEST_GAP = 1.5
"""Longest time between two messages, or beyond the first and last, over which a value is known [s].

A topic at 1 Hz has no gaps.
"""


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
    return np.where(((span > LONGEST_GAP) | (beyond > LONGEST_GAP))[:, None], np.nan, found)


def poses_at(times: FloatArray, poses: FloatArray, sample_times: FloatArray) -> FloatArray:
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
