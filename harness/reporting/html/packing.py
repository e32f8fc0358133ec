"""Numbers as few bytes for the page's `payload.js`; thinned series keep their extremes."""

from __future__ import annotations

import base64
import gzip
import json
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.types import FloatArray, IntArray

Array = np.ndarray[Any, Any]
ALIGNMENT = 8  # [bytes], of an array of doubles in the page's data
LEVEL = 7  # deflate level: 9 takes twice as long and saves a hundredth


class Packer:
    """Named buffers after a JSON head."""

    def __init__(self) -> None:
        self._places: dict[str, tuple[int, int]] = {}
        self._parts: list[bytes] = []
        self._length = 0

    @property
    def names(self) -> list[str]:
        """The names of the buffers that were put in."""
        return list(self._places)

    def add(self, name: str, data: Array | bytes) -> str:
        """Put a buffer in; returns its name."""
        raw = data if isinstance(data, bytes) else np.ascontiguousarray(data).tobytes()
        self._places[name] = (self._length, len(raw))
        padded = raw + bytes(-len(raw) % ALIGNMENT)
        self._parts.append(padded)
        self._length += len(padded)
        return name

    def text(self, run: Mapping[str, Any]) -> str:
        """Everything as base64 text; equal bytes for equal content, no half characters."""
        head = json.dumps(
            {"buffers": self._places, "run": run},
            ensure_ascii=False, allow_nan=False, separators=(",", ":"),
        ).encode(errors="replace")  # fmt: skip
        head += b" " * (-(len(head) + 4) % ALIGNMENT)
        whole = b"".join([struct.pack("<I", len(head)), head, *self._parts])
        return base64.b64encode(gzip.compress(whole, LEVEL, mtime=0)).decode("ascii")


def differences(columns: Array) -> Array:
    """16-bit numbers as differences down each column, modulo 65536, shape (columns, rows)."""
    return (np.diff(columns.astype(np.int64), axis=1, prepend=0) & 0xFFFF).astype(np.uint16)


def zigzag(values: Array) -> Array:
    """Differences of whole numbers, small ones of either sign as small numbers."""
    steps = np.diff(values.ravel().astype(np.int64), prepend=0)
    coded = (steps << 1) ^ (steps >> 63)
    return coded.astype(np.uint32 if len(coded) and coded.max() > 0xFFFF else np.uint16)


MISSING = 65535  # the largest number of 16 bits, in place of NaN
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
