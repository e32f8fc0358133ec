"""Recorded signals with fewer samples, none of the extremes left out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.types import FloatArray, IntArray
from harness.reporting.html.packing import Packer, differences

MISSING = 65535
LARGEST = MISSING - 1


@dataclass(frozen=True, eq=False)
class Thinned:
    """The lowest and the highest sample of every stretch of time, in the order they came.

    Attributes:
        bin: Samples in a stretch.
        offsets: The offsets of each kept sample from its stretch's start, shape (series, 2 *
            stretches).
        values: The values, shape (series, 2 * stretches); NaN where a stretch has none.
    """

    bin: int
    offsets: IntArray
    values: FloatArray


def thin(columns: FloatArray, stretches: int) -> Thinned:
    """Keep two samples of every stretch.

    Args:
        columns: The series as rows, shape (series, samples).
        stretches: The approximate number of stretches.
    """
    series, samples = columns.shape
    size = max(2, -(-samples // stretches))
    count = max(1, -(-samples // size))
    padded = np.empty((series, count * size))
    padded[:, :samples] = columns
    padded[:, samples:] = columns[:, -1:]
    blocks = padded.reshape(series, count, size)
    missing = np.isnan(blocks)
    if missing.any():
        lowest = np.where(missing, np.inf, blocks).argmin(axis=2)
        highest = np.where(missing, -np.inf, blocks).argmax(axis=2)
    else:
        lowest, highest = blocks.argmin(axis=2), blocks.argmax(axis=2)
    offsets = np.sort(np.stack([lowest, highest], axis=2), axis=2)
    values = np.take_along_axis(blocks, offsets, axis=2)
    return Thinned(size, offsets.reshape(series, -1), values.reshape(series, -1))


def pack(thinned: Thinned, name: str, packer: Packer) -> list[dict[str, float]]:
    """Put thinned series into the page's data; returns the lowest value and range of each."""
    known = np.where(np.isnan(thinned.values), np.inf, thinned.values).min(axis=1)
    low = np.where(np.isfinite(known), known, 0.0)
    top = np.where(np.isnan(thinned.values), -np.inf, thinned.values).max(axis=1)
    size = np.where(np.isfinite(top), top, 0.0) - low
    scale = np.where(size > 0, size, 1.0)[:, None]
    share = (thinned.values - low[:, None]) / scale
    stored = np.where(np.isnan(share), MISSING, np.rint(share * LARGEST))
    packer.add(f"{name}.offsets", differences(thinned.offsets))
    packer.add(f"{name}.values", differences(stored))
    return [{"low": float(one), "size": float(span)} for one, span in zip(low, size, strict=True)]
