"""The smallest distance among many pairs of shapes over time, measured only where it can matter."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import coal
import numpy as np

from harness.core.types import FloatArray, IntArray
from harness.observation.body_tracks import BodyTrack, TrackedShape, travel

STILL = 1e-6
"""Relative travel below which a distance is not measured again [m]."""

_FIRST_CHUNK, _LARGEST_CHUNK = 8, 512  # samples looked ahead at once


@dataclass(frozen=True, eq=False)
class ShapePair:
    """Two shapes whose distance is measured.

    Attributes:
        first: A shape of the moving body.
        second: A shape of the other.
        seen: Track of the first's body as seen from the second's, shape (N, ...).
        travel: What `travel` says of `first`, shape (N - 1,).
    """

    first: TrackedShape
    second: TrackedShape
    seen: BodyTrack
    travel: FloatArray

    def distance(self, sample: int) -> float:
        """Signed distance at a sample [m]."""
        seen = coal.Transform3s(self.seen.rotations[sample], self.seen.translations[sample])
        a, b = self.first, self.second
        _RESULT.clear()
        return coal.distance(a.geometry, seen * a.pose, b.geometry, b.pose, _REQUEST, _RESULT)


_REQUEST, _RESULT = coal.DistanceRequest(), coal.DistanceResult()


@dataclass(frozen=True, eq=False)
class Measured:
    """What is known of P pairs after a sample, from which the next samples are measured.

    Attributes:
        distances: The distances last measured [m], shape (P,).
        travels: How far the pairs had travelled when they were measured [m], shape (P,).
        travelled: How far the pairs have travelled at the sample [m], shape (P,).
        nearest: The pair that was the nearest at the sample; -1 for none below the cutoff.
    """

    distances: FloatArray
    travels: FloatArray
    travelled: FloatArray
    nearest: int


@dataclass(frozen=True, eq=False)
class SmallestDistances:
    """The smallest distance among pairs at N samples.

    Attributes:
        distances: The smallest distances [m], at most the cutoff, shape (N,).
        pairs: Indices of the nearest pairs, -1 at the cutoff, shape (N,).
        moved: The most that any of the pairs moves since the sample before [m], shape (N,).
        measured: What is known after the last sample.
    """

    distances: FloatArray
    pairs: IntArray
    moved: FloatArray
    measured: Measured


def pairs_between(
    first: Sequence[TrackedShape], second: Sequence[TrackedShape], seen: BodyTrack
) -> list[ShapePair]:
    """Every shape of one body against every shape of another."""
    return [
        ShapePair(a, b, seen, travelled)
        for a in first
        for travelled in [travel(seen, a)]
        for b in second
    ]


def smallest_distances(
    pairs: Sequence[ShapePair], cutoff: float, before: Measured | None = None
) -> SmallestDistances:
    """The smallest distance over the pairs at every sample, and which pair it was.

    Conservative advancement: a pair measured at distance d is at least d minus what it has
    travelled since, so it is measured again only when that could be the smallest, or below the
    cutoff. The result is exact to `STILL` wherever it is below the cutoff.

    A run may be measured in parts, which have one sample in common; the result is the same to the
    last bit wherever it is divided.

    Args:
        pairs: All over the same samples, none absent.
        cutoff: Larger distances are reported as the cutoff [m].
        before: What is known at the first sample, which is the last one of the part before; None
            at the begin. The result leaves that sample out.
    """
    begin = 0 if before is None else 1
    if before is None:
        still = np.zeros(len(pairs))
        before = Measured(np.array([pair.distance(0) for pair in pairs]), still, still, -1)
    steps = np.column_stack([pair.travel for pair in pairs])
    travelled = np.cumsum(np.vstack([before.travelled, steps]), axis=0)  # (N, P)
    moved = np.zeros(len(travelled))
    moved[1:] = np.diff(travelled, axis=0).max(axis=1)
    lowest = before.distances + before.travels - travelled[-1]
    near = np.flatnonzero((lowest < cutoff) | (np.arange(len(pairs)) == before.nearest))
    search = _Search(
        [pairs[index] for index in near.tolist()],
        travelled[:, near],
        before.distances[near].tolist(),
        before.travels[near],
        int(np.searchsorted(near, before.nearest)) if before.nearest >= 0 else -1,
    )
    distances, which = search.run(begin, cutoff)
    known, at = before.distances.copy(), before.travels.copy()
    known[near], at[near] = search.known, search.at
    number = np.append(near, -1)  # of a pair among all; -1 stays -1
    after = Measured(known, at, travelled[-1], int(number[search.nearest]))
    return SmallestDistances(distances, number[which], moved[begin:], after)


@dataclass(eq=False)
class _Search:
    """A search for the nearest of the K pairs that may come nearer than the cutoff.

    Attributes:
        pairs: The pairs of shapes among which it searches.
        travelled: How far each has travelled at every sample [m], shape (N, K).
        known: The distance of each that was last measured [m].
        at: How far each had travelled then [m], shape (K,).
        nearest: The nearest pair at the last sample; -1 for none.
    """

    pairs: Sequence[ShapePair]
    travelled: FloatArray
    known: list[float]
    at: FloatArray
    nearest: int

    def run(self, begin: int, cutoff: float) -> tuple[FloatArray, IntArray]:
        """Smallest distances from a sample on and the pairs that have them."""
        travelled, known, at, kept = self.travelled, self.known, self.at, self.pairs
        count, sample, best_pair = len(travelled), begin, self.nearest
        nearest = np.full(count, cutoff)
        which = np.full(count, -1, dtype=np.int64)
        if not kept:
            return nearest[begin:], which[begin:]
        key = np.array(known) + at  # the lower bound at j is key - travelled[j]

        def measured(index: int) -> float:
            if travelled[sample, index] - at[index] > STILL:
                known[index] = distance = kept[index].distance(sample)
                at[index] = travelled[sample, index]
                key[index] = distance + travelled[sample, index]
            return known[index]

        while sample < count:
            previous, best, best_pair = best_pair, cutoff, -1
            if previous >= 0 and measured(previous) < best:  # most likely the smallest again
                best, best_pair = known[previous], previous
            bound = key - travelled[sample]
            rivals = (bound < best).nonzero()[0]
            bounds = bound[rivals]
            order = bounds.argsort(kind="stable")
            for index, lowest in zip(rivals[order].tolist(), bounds[order].tolist(), strict=True):
                if lowest >= best:
                    break
                if measured(index) < best:
                    best, best_pair = known[index], index
            until = _unchanged_until(sample, best_pair, best, key, travelled, at, cutoff)
            nearest[sample:until] = best
            which[sample:until] = best_pair
            sample = until
        self.nearest = best_pair
        return nearest[begin:], which[begin:]


def _unchanged_until(
    sample: int,
    best_pair: int,
    best: float,
    key: FloatArray,
    travelled: FloatArray,
    at: FloatArray,
    cutoff: float,
) -> int:
    """The first sample after this one at which something has to be measured again."""
    count, after, chunk = len(travelled), sample + 1, _FIRST_CHUNK
    base = np.inf if best_pair < 0 else at[best_pair] + STILL
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
