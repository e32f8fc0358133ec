"""Look for failures: low-discrepancy samples first, then an optimiser on the worst margin."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from harness.core.types import FloatArray
from harness.plugins.campaigns.failure_search.closeness import (
    UNKNOWN,
    Closeness,
    Expectation,
    failed_expectations,
    failure_kind,
)
from harness.plugins.campaigns.failure_search.evaluator import Sample
from harness.plugins.campaigns.failure_search.space import Point, SearchSpace
from harness.plugins.campaigns.keys.search import SearchSpec

STEP_SIZE = 0.15  # first standard deviation of the optimiser, as a share of each range
CONFIDENCE = 0.95  # the confidence of the interval of the rate
PATIENCE = 6  # generations without a nearer run, after which the optimiser starts somewhere else

Evaluate = Callable[[Sequence[Point]], list[Sample]]


@dataclass(frozen=True)
class FailureRate:
    """The share of the ranges in which the scenario fails.

    Attributes:
        failed: The number of `total` that failed.
        total: The low-discrepancy samples; samples of the optimiser would count failures twice.
        low: Lower end of the interval of Clopper and Pearson [1].
        high: The upper end; where none failed, the one-sided bound.
        confidence: The confidence of the interval.

    References:
        [1] C. J. Clopper, E. S. Pearson, "The Use of Confidence or Fiducial Limits Illustrated in
            the Case of the Binomial", Biometrika 26(4), 1934.
    """

    failed: int
    total: int
    low: float
    high: float
    confidence: float

    @property
    def sentence(self) -> str:
        """The runs that were not chosen near failures; no rate is said of a search."""
        return f"{self.failed} of {self.total} low-discrepancy samples failed"


@dataclass(frozen=True)
class Exploration:
    """What a search found.

    Attributes:
        start: The low-discrepancy samples, which represent the ranges.
        samples: Every sample, those of the start first.
        kinds: Kind of failure -> its samples, in the order in which the kinds were found.
        first_failure: How many runs the first failure needed; 0: none was found.
    """

    start: tuple[Sample, ...]
    samples: tuple[Sample, ...]
    kinds: dict[str, tuple[Sample, ...]]
    first_failure: int

    @cached_property
    def rate(self) -> FailureRate | None:
        """The rate that the samples of the start show; None without any."""
        from scipy.stats import binomtest

        total, failed = len(self.start), sum(map(_failed, self.start))
        if not total:
            return None
        test = binomtest(failed, total, alternative="two-sided" if failed else "less")
        interval = test.proportion_ci(CONFIDENCE, method="exact")
        return FailureRate(failed, total, float(interval.low), float(interval.high), CONFIDENCE)


def explore(
    space: SearchSpace,
    evaluate: Evaluate,
    is_counted: Callable[[Sample], bool],
    settings: SearchSpec,
    seed: int,
) -> Exploration:
    """Search for failures of different kinds.

    A scrambled Sobol sequence [1] covers the ranges. From its samples that are nearest to failing,
    CMA-ES [2] minimises the worst margin of the expectations that have not failed yet, until each
    has, or the runs are used up.

    Args:
        space: The parameters that vary, with their nominal values.
        evaluate: Runs points; the same points give the same samples.
        is_counted: Whether a run is evidence: not one that is invalid.

    References:
        [1] A. B. Owen, "Scrambling Sobol' and Niederreiter-Xing Points", Journal of Complexity
            14(4), 1998.
        [2] N. Hansen, A. Ostermeier, "Completely Derandomized Self-Adaptation in Evolution
            Strategies", Evolutionary Computation 9(2), 2001.
    """
    shares = _sobol(len(space.parameters), min(settings.start, settings.runs), seed)
    first = evaluate([space.point(row.tolist()) for row in shares])
    search = _Search(space, evaluate, is_counted, settings, list(first))
    search.optimise(shares, np.random.default_rng(seed))
    counted = [each for each in search.samples if is_counted(each)]
    kinds: dict[str, list[Sample]] = {}
    for sample in counted:
        if kind := failure_kind(sample.result):
            kinds.setdefault(kind, []).append(sample)
    number = next(
        (n for n, each in enumerate(search.samples, 1) if is_counted(each) and _failed(each)), 0
    )
    return Exploration(
        tuple(each for each in first if is_counted(each)),
        tuple(search.samples),
        {kind: tuple(samples) for kind, samples in kinds.items()},
        number,
    )


def _failed(sample: Sample) -> bool:
    return sample.result.outcome != "passed"


def _sobol(dimensions: int, count: int, seed: int) -> FloatArray:
    """Scrambled Sobol points, shape (count, dimensions), in [0, 1)."""
    from scipy.stats import qmc

    sequence = qmc.Sobol(dimensions, scramble=True, rng=seed)
    return sequence.random_base2(max(0, (count - 1).bit_length()))[:count]


@dataclass
class _Search:
    """The optimiser's part of a search."""

    space: SearchSpace
    evaluate: Evaluate
    is_counted: Callable[[Sample], bool]
    settings: SearchSpec
    samples: list[Sample]
    failed: set[Expectation] = field(default_factory=set[Expectation])

    def optimise(self, shares: FloatArray, rng: np.random.Generator) -> None:
        """Start from the samples that are nearest to failing, one after the other."""
        counted = [each for each in self.samples if self.is_counted(each)]
        closeness = Closeness([each.result for each in counted], self.settings.minimise)
        for sample in counted:
            self.failed |= failed_expectations(sample.result) if _failed(sample) else set()
        used = set[int]()
        while len(self.samples) < self.settings.runs:
            searched = closeness.searched(self.failed)
            origins = sorted(
                (closeness.of(sample.result, searched), index)
                for index, sample in enumerate(self.samples[: len(shares)])
                if index not in used and self.is_counted(sample)
            )
            if not searched or not origins:
                return
            used.add(origins[0][1])
            self._descend(shares[origins[0][1]], closeness, searched, int(rng.integers(2**31)))

    def _descend(
        self, origin: FloatArray, closeness: Closeness, searched: frozenset[Expectation], seed: int
    ) -> None:
        """Minimise the worst margin from an origin, until something new fails."""
        from cmaes import CMA

        bounds = np.tile([0.0, 1.0], (len(origin), 1))
        size = self.settings.batch
        optimiser = CMA(origin, STEP_SIZE, bounds, seed=seed, population_size=size)
        best, since = np.inf, 0
        while (
            len(self.samples) < self.settings.runs
            and since < PATIENCE
            and not optimiser.should_stop()
        ):
            proposed = [optimiser.ask() for _ in range(optimiser.population_size)]
            proposed = proposed[: self.settings.runs - len(self.samples)]
            batch = self.evaluate([self.space.point(each.tolist()) for each in proposed])
            self.samples += batch
            values = [self._value(each, closeness, searched) for each in batch]
            failed = {
                expectation
                for each in batch
                if self.is_counted(each) and _failed(each)
                for expectation in failed_expectations(each.result)
            }
            if failed & searched:
                self.failed |= failed
                return
            since = 0 if min(values) < best else since + 1
            best = min(best, *values)
            if len(proposed) == optimiser.population_size:
                optimiser.tell(list(zip(proposed, values, strict=True)))

    def _value(
        self, sample: Sample, closeness: Closeness, searched: frozenset[Expectation]
    ) -> float:
        return closeness.of(sample.result, searched) if self.is_counted(sample) else UNKNOWN
