"""The smallest distance among many pairs of shapes over time, measured only where it can matter."""

# coal has no type stubs
# pyright: reportAttributeAccessIssue=false, reportMissingTypeStubs=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
# pyright: reportUnknownArgumentType=false, reportUnknownParameterType=false

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from operator import attrgetter

import coal
import numpy as np

from harness.core.types import BoolArray, FloatArray, IntArray
from harness.session.observation.body_tracks import (
    BodyTrack,
    MovingBody,
    TrackedShape,
    centers_of,
    relative_track,
    travels,
)

STILL = 1e-6  # relative travel below which a distance is not measured again [m]
COAL_TOLERANCE = 1e-6  # how far a measured distance may be above a bound of it [m]
BLOCK = 64  # samples for which the pairs that may be the nearest are chosen at once
MOST_RIVALS = 12  # pairs that are followed at once; with more, they are chosen again earlier


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
        lowest: The smallest of these [m].
    """

    first: TrackedShape
    second: TrackedShape
    seen: BodyTrack
    travel: FloatArray
    least: FloatArray
    lowest: float

    def distance(self, sample: int) -> float:
        """Signed distance at a sample [m]."""
        _SEEN.setTransform(self.seen.rotations[sample], self.seen.translations[sample])
        _RESULT.clear()
        return self._compute(_SEEN * self.first.pose, self.second.pose, _REQUEST, _RESULT)

    @cached_property
    def _compute(self) -> coal.ComputeDistance:
        return coal.ComputeDistance(self.first.geometry, self.second.geometry)


_REQUEST, _RESULT = coal.DistanceRequest(), coal.DistanceResult()
_SEEN = coal.Transform3s()  # set for each measurement: half the time of making another one


def pairs_between(
    firsts: Sequence[MovingBody], second: MovingBody, cutoff: float = np.inf
) -> list[ShapePair]:
    """Shapes of some bodies against shapes of another, in their order.

    Args:
        firsts: The bodies whose shapes come first in a pair; each has some, as the second does.
        second: Another body, at the same samples.
        cutoff: Pairs that are never nearer than this [m], between samples neither, may be left out.
    """
    gaps, is_near = _gaps_at_looks(firsts, second, cutoff)
    found: list[ShapePair] = []
    begin = 0
    for first in firsts:
        near = begin + np.flatnonzero(is_near[begin : begin + len(first.shapes)])
        if len(near):
            shapes = [first.shapes[index] for index in (near - begin).tolist()]
            some = MovingBody(shapes, first.track, first.stretches)
            found += _pairs_of(some, second, gaps[:, :, near], cutoff)
        begin += len(first.shapes)
    return found


def _gaps_at_looks(
    firsts: Sequence[MovingBody], second: MovingBody, cutoff: float
) -> tuple[FloatArray, BoolArray]:
    """Gaps between balls and boxes, and which balls may come nearer to a box than the cutoff.

    Returns:
        The gaps between the boxes about the second body's shapes, and the centres of the balls
        about all K shapes of the first bodies at every look [m], shape (shapes, looks, K); then
        whether a ball may come that near before the last sample, shape (K,).
    """
    looks = second.track.part(second.looks.at)
    centers = np.concatenate([body.centers_at_looks for body in firsts], axis=2)
    turned = np.swapaxes(looks.rotations, 1, 2)
    seen = turned @ (centers - looks.translations[:, :, None])
    gaps = np.array([shape.gap(seen) for shape in second.shapes])
    count = [len(body.shapes) for body in firsts]
    reach = np.repeat([body.reach + second.reach for body in firsts], count, axis=0).T
    radii = np.concatenate([body.radii for body in firsts])
    return gaps, (gaps.min(axis=0) - reach - radii < cutoff).any(axis=0)


def _pairs_of(
    first: MovingBody, second: MovingBody, gaps: FloatArray, cutoff: float
) -> list[ShapePair]:
    """The pairs of two bodies that come nearer than the cutoff; gaps as of `_gaps_at_looks`."""
    seen = relative_track(first.track, second.track)
    travelled = travels(seen, centers_of(seen, first.shapes), first.radii)
    looks = first.looks
    since = travelled - np.repeat(travelled[looks.at], looks.counts, axis=0)
    since += first.radii
    ends = since[looks.at + looks.counts - 1]
    lowest = (gaps - ends).min(axis=1)  # each bound is lowest just before the next look
    margin = np.diff(travelled, axis=0)[looks.follows].max(axis=0, initial=0.0)
    which, other = np.nonzero((lowest - margin < cutoff).T)
    least = np.repeat(gaps[other, :, which], looks.counts, axis=1) - since.T[which]
    return [
        ShapePair(first.shapes[i], second.shapes[j], seen, travelled[:, i], bound, lowest[j, i])
        for i, j, bound in zip(which.tolist(), other.tolist(), least, strict=True)
    ]


def largest_travel(pairs: Sequence[ShapePair], cutoff: float, count: int) -> FloatArray:
    """The most that a pair moves since the sample before [m], shape (count,).

    Pairs count where they may come nearer than the cutoff in between: two bodies that are d1 and d2
    apart and move by s against each other are at least (d1 + d2 - s) / 2 apart.
    """
    moved = np.zeros(count)
    for _, group in groupby(pairs, key=attrgetter("seen")):
        together = list(group)
        least = np.array([pair.least for pair in together])
        steps = np.diff([pair.travel for pair in together])
        is_near = least[:, 1:] + least[:, :-1] - steps < 2 * cutoff
        np.maximum(moved[1:], np.where(is_near, steps, 0.0).max(axis=0), out=moved[1:])
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

    Returns:
        Distances (count,), at most `cutoff`, and indices of pairs (count,), -1 at the cutoff.
    """
    nearest = np.full(count, cutoff)
    which = np.full(count, -1, dtype=np.int64)
    near = np.flatnonzero([pair.lowest - COAL_TOLERANCE < cutoff for pair in pairs])
    if not len(near):
        return nearest, which
    search = _Search([pairs[index] for index in near.tolist()], cutoff)
    sample, best = 0, -1
    while sample < count:
        nearest[sample], best = search.smallest_at(sample, best)
        which[sample] = near[best] if best >= 0 else -1
        sample += 1
        rivals, until = search.rivals_of(best, sample)
        if rivals and until > sample:
            distances, places = search.followed(rivals, sample, until)
            nearest[sample:until] = distances
            which[sample:until] = np.append(near, -1)[places]
            best = places[-1]
        sample = until
    return nearest, which


class _Search:
    """What is known of the distances of some pairs while the samples pass."""

    def __init__(self, pairs: Sequence[ShapePair], cutoff: float) -> None:
        self._pairs = pairs
        self._cutoff = cutoff
        self._travelled = np.column_stack([pair.travel for pair in pairs])  # (N, K)
        self._least = np.column_stack([pair.least for pair in pairs]) - COAL_TOLERANCE
        self._known = [-np.inf] * len(pairs)  # the distance last measured
        self._since = [-np.inf] * len(pairs)  # and the travel then
        self._key = np.full(len(pairs), -np.inf)  # their sum; the bound at j is key - travelled[j]

    def smallest_at(self, sample: int, previous: int) -> tuple[float, int]:
        """The smallest distance at a sample, and its pair; -1 where none is below the cutoff.

        Args:
            previous: The pair that was the smallest before, and most likely is again; -1 if none.
        """
        travelled = self._travelled[sample]
        smallest, best = self._cutoff, -1
        if previous >= 0 and self._measured(previous, sample) < smallest:
            smallest, best = self._known[previous], previous
        bound = np.maximum(self._key - travelled, self._least[sample])
        rivals = (bound < smallest).nonzero()[0]
        bounds = bound[rivals]
        order = bounds.argsort(kind="stable")
        for index, lowest in zip(rivals[order].tolist(), bounds[order].tolist(), strict=True):
            if lowest >= smallest:
                break
            if self._measured(index, sample) < smallest:
                smallest, best = self._known[index], index
        return smallest, best

    def _measured(self, index: int, sample: int) -> float:
        moved = float(self._travelled[sample, index])
        if moved - self._since[index] > STILL:
            distance = self._pairs[index].distance(sample)
            self._known[index], self._since[index] = distance, moved
            self._key[index] = distance + moved
        return self._known[index]

    def rivals_of(self, best: int, sample: int) -> tuple[list[int], int]:
        """The pairs of which one is the smallest from a sample on, and until when.

        Args:
            best: The pair that was the smallest before; -1 if none was.

        Returns:
            The pairs, no more than `MOST_RIVALS` and `best` first; then the first sample at which
            there may be others.
        """
        block = self._travelled[sample : sample + BLOCK]
        largest = np.full(len(block), self._cutoff)
        if best >= 0:
            of_best = block[:, best] + (self._known[best] - self._since[best])
            np.minimum(largest, of_best, out=largest)
        least = self._least[sample : sample + BLOCK]
        is_rival = np.maximum(self._key - block, least) < largest[:, None]
        if best >= 0:
            is_rival[:, best] = False
        if not len(block):
            return [], sample
        begins = np.where(is_rival.any(axis=0), is_rival.argmax(axis=0), len(block))
        rivals = (begins < len(block)).nonzero()[0]
        until = len(block)
        if len(rivals) > MOST_RIVALS:
            rivals = rivals[begins[rivals].argsort(kind="stable")]
            until = int(begins[rivals[MOST_RIVALS]])
            rivals = rivals[:MOST_RIVALS]
        first = [best] if best >= 0 else []
        return [*first, *rivals.tolist()], sample + until

    def followed(
        self, rivals: Sequence[int], sample: int, until: int
    ) -> tuple[list[float], list[int]]:
        """The smallest distances from a sample to before another, and their pairs, of rivals."""
        known = [self._known[index] for index in rivals]
        since = [self._since[index] for index in rivals]
        distance = [self._pairs[index].distance for index in rivals]
        found: list[float] = []
        places: list[int] = []
        best = 0
        for at, moves in enumerate(self._travelled[sample:until, rivals].tolist(), sample):
            smallest, nearest = self._cutoff, -1
            for place in (best, *range(best), *range(best + 1, len(rivals))):
                moved = moves[place] - since[place]
                if known[place] - moved >= smallest:
                    continue
                if moved > STILL:
                    known[place], since[place] = distance[place](at), moves[place]
                if known[place] < smallest:
                    smallest, nearest = known[place], place
            best = max(nearest, 0)
            found.append(smallest)
            places.append(rivals[nearest] if nearest >= 0 else -1)
        for index, value, moved in zip(rivals, known, since, strict=True):
            self._known[index], self._since[index] = value, moved
            self._key[index] = value + moved
        return found, places
