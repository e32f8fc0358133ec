"""Distances at every sample of a run from those measured at a part of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from harness.core.types import BoolArray, FloatArray, IntArray
from harness.recording.run import AttachmentRecord, ObjectRecord

SPACING = 0.005
"""Time between samples that are measured [s]; linear in between.

A distance that changes with an acceleration a is off by at most a * SPACING^2 / 8: 0.03 mm in free
fall, less for an arm, a few per cent of a penetration's depth. Where another pair of shapes becomes
the nearest in between it comes out too small, never too large. Around its smallest value every
sample is measured.
"""
LARGEST_ERROR = 0.002
"""A distance is nowhere smaller than recorded by more than this [m].

Where bodies move so fast that it could be, by the bound of their motion, every sample is measured;
where it could be between two samples too, positions between them are interpolated, and the smallest
distance counts for the sample before.
"""
PART = 5.0  # time of a run that is measured at once [s]
AROUND = 2  # samples before and after each coming and going that are measured
MOST_PARTS = 200  # positions between two samples: enough for 800 m/s at 1 ms

MOST_PARTS_PER_SAMPLE, FEW_PARTS = 10, 20_000
"""Positions between samples, on average over a run: 20 m/s all along at 1 ms; and as many as are
measured in any case. Where everything jumps all the time, they are further apart than
`LARGEST_ERROR`: the time that a recording takes is linear in its messages."""


def knots(
    times: FloatArray, objects: Sequence[ObjectRecord], attachments: Sequence[AttachmentRecord]
) -> IntArray:
    """Samples to measure: one every SPACING, and those around every coming and going."""
    count = len(times)
    chosen = np.zeros(count, dtype=bool)
    chosen[:: _stride(_timestep(times))] = True
    chosen[-1] = True
    changes = [time for record in objects for span in record.present for time in span]
    changes += [time for held in attachments for time in (held.start_time, held.end_time)]
    for time in changes:
        middle = int(np.searchsorted(times, time))
        chosen[max(0, middle - AROUND) : middle + AROUND + 1] = True
    return np.flatnonzero(chosen)


def parts_of_run(times: FloatArray, samples: IntArray) -> list[IntArray]:
    """The measured samples of each part of `PART` seconds; the parts share the samples between.

    Measuring one part after the other bounds the memory that a long run takes.
    """
    length = _stride(_timestep(times)) * round(PART / SPACING)
    last = len(times) - 1
    bounds = [*range(0, max(last, 1), length), last]
    at = np.searchsorted(samples, bounds)
    return [samples[first : last + 1] for first, last in pairwise(at.tolist())]


def _stride(timestep: float) -> int:
    """The number of samples from one that is measured to the next."""
    return max(1, round(SPACING / timestep))


def _timestep(times: FloatArray) -> float:
    return float(times[1] - times[0]) if len(times) > 1 else SPACING


def around_smallest(
    clearances: Mapping[tuple[str, str], FloatArray], samples: IntArray, count: int
) -> IntArray:
    """Every sample between the neighbours of each distance's smallest measured value."""
    chosen = np.zeros(count, dtype=bool)
    for distances in clearances.values():
        if np.isfinite(distances).any():
            place = int(np.nanargmin(distances))
            first, last = samples[max(0, place - 1)], samples[min(len(samples) - 1, place + 1)]
            chosen[first : last + 1] = True
    return np.flatnonzero(chosen)


def largest_dip(dips: Mapping[tuple[str, str], FloatArray]) -> FloatArray:
    """The largest of several pairs' possible dips after each sample but the last [m]."""
    return np.max(list(dips.values()), axis=0) if dips else np.zeros(0)


def inside_of(samples: IntArray, chosen: BoolArray) -> IntArray:
    """Every sample from one measured sample to the next, in the chosen intervals."""
    begins = np.flatnonzero(chosen)
    ends = zip(samples[begins].tolist(), samples[begins + 1].tolist(), strict=True)
    parts = [np.arange(first, last + 1, dtype=np.int64) for first, last in ends]
    return np.concatenate([*parts, np.zeros(0, dtype=np.int64)]).astype(np.int64)


def parts_of(samples: IntArray, dips: FloatArray, count: int) -> tuple[IntArray, FloatArray]:
    """Positions between samples and the next ones: the sample before each, and the share.

    Args:
        samples: The samples after which bodies move that far, fewer than `count`.
        dips: The length by which a distance may be smaller after each of them [m].
    """
    needed = np.ceil(dips / LARGEST_ERROR)
    limits = np.arange(MOST_PARTS, 0, -1)
    most = max(MOST_PARTS_PER_SAMPLE * count, FEW_PARTS)
    fits = [np.minimum(needed, limit).sum() <= most for limit in limits]
    counts = np.clip(needed, 1, limits[int(np.argmax(fits))]).astype(int)
    owners = np.repeat(samples, counts)
    shares: list[FloatArray] = [np.arange(1, n + 1) / (n + 1) for n in counts.tolist()]
    return owners, np.concatenate(shares)


def between(samples: IntArray, distances: FloatArray, count: int) -> FloatArray:
    """Distances at all samples, linear between measured ones; NaN next to a missing one."""
    everywhere = np.arange(count)
    after = np.clip(_count_below(samples, count), 0, len(samples) - 1)
    before = np.where(samples[after] == everywhere, after, np.maximum(after - 1, 0))
    missing: BoolArray = np.isnan(distances[before]) | np.isnan(distances[after])
    known = np.flatnonzero(~np.isnan(distances))
    if not len(known):
        return np.full(count, np.nan)
    filled = np.interp(everywhere, samples[known], distances[known])
    filled[missing] = np.nan
    return filled


def nearest_measured(
    samples: IntArray, links: IntArray, distances: FloatArray, cutoff: float
) -> IntArray:
    """The link found at the measured sample before each sample, or after it; -1 at the cutoff."""
    below = _count_below(samples, len(distances) + 1)
    before = links[np.maximum(below[1:] - 1, 0)]
    after = links[np.clip(below[:-1], 0, len(samples) - 1)]
    found = np.where(before >= 0, before, after)
    return np.where(distances < cutoff, found, -1)


def _count_below(samples: IntArray, count: int) -> IntArray:
    """How many of some samples come before each of the first `count`, shape (count,)."""
    below = np.zeros(count + 1, dtype=np.int64)
    below[samples + 1] = 1
    return np.cumsum(below)[:count]
