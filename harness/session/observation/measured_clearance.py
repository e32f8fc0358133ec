"""Distances of each pair of bodies, and the nearest links, at the measured samples of a run."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field

import numpy as np

from harness.core.types import BoolArray, FloatArray, IntArray, Pair


@dataclass(eq=False)
class MeasuredClearance:
    """What was measured at some samples, in their order.

    Attributes:
        distances: Distance of each pair [m], NaN while either is absent, shape (count,).
        links: Index of the nearest link, -1 where there is none, shape (count,).
        travels: The most that the bodies moved against each other since the sample before [m],
            shape (count,).
        only: The pairs that are measured; None measures all.
        stretches: The number of the stretch of consecutive samples that each is in, shape (count,);
            None where all are one.
    """

    count: int
    distances: dict[Pair, FloatArray] = field(default_factory=dict[Pair, FloatArray])
    links: dict[Pair, IntArray] = field(default_factory=dict[Pair, IntArray])
    travels: dict[Pair, FloatArray] = field(default_factory=dict[Pair, FloatArray])
    only: Collection[Pair] | None = None
    stretches: IntArray | None = None

    @classmethod
    def joined(cls, parts: Sequence[MeasuredClearance]) -> MeasuredClearance:
        """What was measured in consecutive parts; each begins with the last sample of another."""
        whole = cls(1 + sum(part.count - 1 for part in parts))
        begin = 0
        for part in parts:
            skipped = min(begin, 1)
            rows = np.arange(begin + skipped, begin + part.count)
            for key, distances in part.distances.items():
                links = part.links[key][skipped:] if key in part.links else None
                travels = part.travels[key][skipped:]
                whole.put(key, rows, distances[skipped:], links, travels)
            begin += part.count - 1
        return whole

    def stretches_of(self, rows: BoolArray) -> IntArray | None:
        """The numbers of the stretches of some samples."""
        return None if self.stretches is None else self.stretches[rows]

    def put(
        self,
        key: Pair,
        rows: BoolArray | IntArray,
        distances: FloatArray,
        links: IntArray | None,
        travels: FloatArray,
    ) -> None:
        """Set what was measured of a pair at some samples; the others are absent until set."""
        if key not in self.distances:
            self.distances[key] = np.full(self.count, np.nan)
            self.travels[key] = np.zeros(self.count)
        self.distances[key][rows] = distances
        self.travels[key][rows] = travels
        if links is not None:
            if key not in self.links:
                self.links[key] = np.full(self.count, -1, dtype=np.int64)
            self.links[key][rows] = links

    def refined(self, finer: MeasuredClearance, samples: IntArray, near: IntArray) -> IntArray:
        """Merge measurements at further samples; returns all samples in order."""
        merged = np.union1d(samples, near)
        old, new = np.searchsorted(merged, samples), np.searchsorted(merged, near)
        for key, values in self.distances.items():
            whole = np.full(len(merged), np.nan)
            whole[old] = values
            whole[new] = finer.distances.get(key, np.nan)
            self.distances[key] = whole
        for key, values in self.links.items():
            indices = np.full(len(merged), -1, dtype=np.int64)
            indices[old] = values
            indices[new] = finer.links.get(key, -1)
            self.links[key] = indices
        follows = np.diff(near, prepend=-2) == 1  # the others' travel is since an earlier one
        for key, values in self.travels.items():
            travel = np.zeros(len(merged))
            travel[old] = values
            if key in finer.travels:
                travel[new[follows]] = finer.travels[key][follows]
            self.travels[key] = travel
        self.count = len(merged)
        return merged

    def dips(self) -> dict[Pair, FloatArray]:
        """The most by which each distance may be smaller between two samples than at both [m].

        Two bodies that are d1 and d2 apart at the ends of an interval in which they move by s
        against each other are at least (d1 + d2 - s) / 2 apart in it.
        """
        return {
            key: np.nan_to_num((self.travels[key][1:] - np.abs(np.diff(values))) / 2)
            for key, values in self.distances.items()
        }
