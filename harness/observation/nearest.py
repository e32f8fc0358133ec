"""The smallest distance among many pairs of shapes over time, measured only where it can matter."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import coal
import numpy as np

from harness.core.types import FloatArray, IntArray
from harness.observation.body_tracks import BodyTrack, TrackedShape, centers_of, travels

STILL = 1e-6
"""Relative travel below which a distance is not measured again [m]."""

LOOKS = 8
"""Samples from one at which the gap of ball and box is computed to the next."""

_FIRST_CHUNK, _LARGEST_CHUNK = 8, 512  # samples looked ahead at once


@dataclass(frozen=True, eq=False)
class ShapePair:
    """Two shapes whose distance is measured.

    Attributes:
        first: A shape of the moving body.
        second: A shape of the other.
        seen: Track of the first's body as seen from the second's, shape (N, ...).
        travel: What `travels` says of `first`, shape (N,).
        least: A lower bound of the distance [m], shape (N,): the gap between the ball about `first`
            and the box about `second` at an earlier sample, less the travel since.
    """

    first: TrackedShape
    second: TrackedShape
    seen: BodyTrack
    travel: FloatArray
    least: FloatArray

    def distance(self, sample: int) -> float:
        """Signed distance at a sample [m]."""
        seen = coal.Transform3s(self.seen.rotations[sample], self.seen.translations[sample])
        a, b = self.first, self.second
        _RESULT.clear()
        return coal.distance(a.geometry, seen * a.pose, b.geometry, b.pose, _REQUEST, _RESULT)


_REQUEST, _RESULT = coal.DistanceRequest(), coal.DistanceResult()


def pairs_between(
    first: Sequence[TrackedShape],
    second: Sequence[TrackedShape],
    seen: BodyTrack,
    cutoff: float = np.inf,
) -> list[ShapePair]:
    """Shapes of one body against shapes of another, in their order.

    Args:
        first: The shapes of the moving body.
        second: The shapes of the other.
        seen: Track of the first body as seen from the second.
        cutoff: Pairs that are never nearer than this [m], between samples neither, may be left out.
    """
    if not first or not second:
        return []
    centers, radii = centers_of(seen, first), np.array([shape.radius for shape in first])
    travelled = travels(seen, centers, radii)
    since = travelled - np.repeat(travelled[::LOOKS], LOOKS, axis=0)[: len(travelled)]
    margin = np.diff(travelled, axis=0).max(axis=0, initial=0.0)
    found: list[tuple[int, ShapePair]] = []
    for b in second:
        gaps = np.repeat(b.gap(centers[::LOOKS]), LOOKS, axis=0)[: len(travelled)]
        least = gaps - since - radii
        near = np.flatnonzero(least.min(axis=0) - margin < cutoff).tolist()
        found += [(i, ShapePair(first[i], b, seen, travelled[:, i], least[:, i])) for i in near]
    return [pair for _, pair in sorted(found, key=lambda each: each[0])]


def largest_travel(pairs: Sequence[ShapePair], cutoff: float, count: int) -> FloatArray:
    """The most that a pair moves since the sample before [m], shape (count,).

    Pairs count where they may come nearer than the cutoff in between: two bodies that are d1 and d2
    apart and move by s against each other are at least (d1 + d2 - s) / 2 apart.
    """
    moved = np.zeros(count)
    for pair in pairs:
        steps = np.diff(pair.travel)
        is_near = pair.least[1:] + pair.least[:-1] - steps < 2 * cutoff
        moved[1:] = np.maximum(moved[1:], np.where(is_near, steps, 0.0))
    return moved


def smallest_distances(
    pairs: Sequence[ShapePair], cutoff: float, count: int
) -> tuple[FloatArray, IntArray]:
    """The smallest distance over the pairs at every sample, and which pair it was.

    Conservative advancement: a pair measured at distance d is at least d minus what it has
    travelled since, so it is measured again only when that could be the smallest, or below the
    cutoff. The result is exact to `STILL` wherever it is below the cutoff.

    Args:
        pairs: All over the same samples, none absent.
        cutoff: Larger distances are reported as the cutoff [m].
        count: The number of samples.

    Returns:
        Distances (count,), at most `cutoff`, and indices of pairs (count,), -1 at the cutoff.
    """
    nearest = np.full(count, cutoff)
    which = np.full(count, -1, dtype=np.int64)
    first = np.array([pair.distance(0) if pair.least.min() < cutoff else np.inf for pair in pairs])
    total = np.array([pair.travel[-1] for pair in pairs])
    near = np.flatnonzero(first - total < cutoff)
    if not len(near):
        return nearest, which
    kept = [pairs[index] for index in near.tolist()]
    travelled = np.column_stack([pair.travel for pair in kept])  # (N, K)
    known: list[float] = first[near].tolist()  # the distance last measured
    at = [0] * len(kept)  # and the sample
    key = first[near]  # known + travel then: the lower bound at j is key - travelled[j]
    sample, best_pair = 0, -1

    def measured(index: int) -> float:
        if travelled[sample, index] - travelled[at[index], index] > STILL:
            known[index] = distance = kept[index].distance(sample)
            at[index] = sample
            key[index] = distance + travelled[sample, index]
        return known[index]

    while sample < count:
        previous, best, best_pair = best_pair, cutoff, -1
        if previous >= 0 and measured(previous) < best:  # most likely the smallest again
            best, best_pair = known[previous], previous
        bound = key - travelled[sample]
        rivals = np.flatnonzero(bound < best)
        bounds = bound[rivals]
        order = bounds.argsort(kind="stable")
        for index, lowest in zip(rivals[order].tolist(), bounds[order].tolist(), strict=True):
            if lowest >= best:
                break
            if measured(index) < best:
                best, best_pair = known[index], index
        until = _unchanged_until(sample, best_pair, best, key, travelled, at, cutoff)
        nearest[sample:until] = best
        which[sample:until] = near[best_pair] if best_pair >= 0 else -1
        sample = until
    return nearest, which


def _unchanged_until(
    sample: int,
    best_pair: int,
    best: float,
    key: FloatArray,
    travelled: FloatArray,
    at: Sequence[int],
    cutoff: float,
) -> int:
    """The first sample after this one at which something has to be measured again."""
    count, after, chunk = len(travelled), sample + 1, _FIRST_CHUNK
    base = np.inf if best_pair < 0 else travelled[at[best_pair], best_pair] + STILL
    if after < count and best_pair >= 0 and travelled[after, best_pair] > base:
        return after
    while after < count:
        block = travelled[after : after + chunk]
        lower = key - block
        if best_pair >= 0:
            lower[:, best_pair] = np.inf
            stop = (lower.min(axis=1) < best) | (block[:, best_pair] > base)
        else:
            stop = lower.min(axis=1) < cutoff
        if stop.any():
            return after + int(np.argmax(stop))
        after += len(block)
        chunk = min(2 * chunk, _LARGEST_CHUNK)
    return count
