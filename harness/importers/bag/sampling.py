"""Recorded rows at other times than their own, but never where nothing was recorded."""

from __future__ import annotations

import numpy as np

from harness.core.types import FloatArray

LONGEST_GAP = 1.5
"""Between two messages, or beyond the first and last, over which a value is known [s]: a topic at
1 Hz has no gaps."""


def rows_at(times: FloatArray, rows: FloatArray, wanted: FloatArray) -> FloatArray:
    """Rows between those recorded, in a straight line; NaN in gaps; shape (len(wanted), width).

    Args:
        times: Of the rows [s], in any order; of equal ones the first counts.
        rows: Shape (N, width).
        wanted: Rising [s].
    """
    times, first = np.unique(times, return_index=True)
    rows = rows[first]
    after = np.clip(np.searchsorted(times, wanted), 0, len(times) - 1)
    before = np.clip(np.searchsorted(times, wanted, side="right") - 1, 0, len(times) - 1)
    span = times[after] - times[before]
    share = np.where(span > 0, (wanted - times[before]) / np.where(span > 0, span, 1.0), 0.0)
    found = rows[before] + share[:, None] * (rows[after] - rows[before])
    beyond = np.maximum(times[0] - wanted, wanted - times[-1])
    return np.where(((span > LONGEST_GAP) | (beyond > LONGEST_GAP))[:, None], np.nan, found)


def poses_at(times: FloatArray, poses: FloatArray, wanted: FloatArray) -> FloatArray:
    """Poses (xyz, quat wxyz) between those recorded; NaN in gaps; shape (len(wanted), 7).

    A single pose holds for ever: it was published once because nothing moves. Between two the
    quaternion goes the short way, which for neighbours of a recording is as good as an arc.
    """
    if len(poses) == 1:
        return np.tile(poses[0], (len(wanted), 1))
    order = np.argsort(times, kind="stable")
    times, poses = times[order], poses[order].copy()
    turns = np.einsum("ij,ij->i", poses[1:, 3:], poses[:-1, 3:])
    signs = np.concatenate([[1.0], np.cumprod(np.where(turns < 0, -1.0, 1.0))])
    poses[:, 3:] *= signs[:, None]
    found = rows_at(times, poses, wanted)
    with np.errstate(invalid="ignore"):
        found[:, 3:] /= np.linalg.norm(found[:, 3:], axis=1, keepdims=True)
    return found
