"""Success rates of samples: interval, sequential test, and which samples are still needed."""

from __future__ import annotations

import math
from collections.abc import Iterable

from harness.core.proportion import wilson_interval
from harness.recording.run import Outcome
from harness.reporting.sampled import RateVerdict, SampledRate, SuccessRate
from harness.suite.plan import PlannedCase
from harness.suite.variation import Variation


def log_evidence_against(passed: int, total: int, rate: float) -> float:
    """Log of how much likelier the samples are under some other rate, all alike, than under one.

    The mixture likelihood ratio with a uniform prior: under `rate` it exceeds 1 / a at any time
    with a probability of at most a, however often one looks [1].

    References:
        [1] H. Robbins, "Statistical Methods Related to the Law of the Iterated Logarithm",
            Annals of Mathematical Statistics 41(5), 1970.
    """
    failed = total - passed
    mixture = math.lgamma(passed + 1) + math.lgamma(failed + 1) - math.lgamma(total + 2)
    if (rate >= 1.0 and failed) or (rate <= 0.0 and passed):
        return math.inf
    under = (passed * math.log(rate) if passed else 0.0) + (
        failed * math.log1p(-rate) if failed else 0.0
    )
    return mixture - under


def decided(passed: int, total: int, at_least: float, confidence: float) -> RateVerdict:
    """Whether the sequential test has decided, after some samples in their order."""
    if not total or log_evidence_against(passed, total, at_least) < -math.log(1 - confidence):
        return "open"
    return "shown" if passed / total > at_least else "refuted"


class Tally:
    """Samples counted one after the other, in the order of their numbers.

    Attributes:
        passed: The number of `total` that passed.
        total: Samples that count; samples after an early stop do not.
    """

    def __init__(self, at_least: float | None, confidence: float, *, stop_early: bool) -> None:
        """Count nothing yet.

        Args:
            at_least: Rate to be shown; None: every one must pass.
            stop_early: Whether the sequential test may end the sampling.
        """
        self.passed, self.total = 0, 0
        self.is_decided = False
        self._at_least, self._confidence, self._stop_early = at_least, confidence, stop_early
        self._first_digest = ""
        self._are_alike = True

    @property
    def is_one_run(self) -> bool:
        """Whether several samples were one and the same run: nothing that matters varied."""
        return self.total > 1 and self._are_alike

    def add(self, is_good: bool, digest: str) -> None:
        """Count the next sample; equal digests decide nothing, however many there are."""
        if self.is_decided:
            return
        self.passed += is_good
        self.total += 1
        self._first_digest = self._first_digest or digest
        self._are_alike &= bool(digest) and digest == self._first_digest
        if self._at_least is not None and self._stop_early and not self.is_one_run:
            verdict = decided(self.passed, self.total, self._at_least, self._confidence)
            self.is_decided = verdict != "open"

    def rate(self, planned: int, invalid: int = 0) -> SuccessRate:
        """What the samples show; none show nothing.

        Args:
            planned: Number of samples without an early stop.
            invalid: Samples that could not be run, which do not count.
        """
        passed, total, required = self.passed, self.total, self._at_least
        low, high = wilson_interval(passed, total, self._confidence)
        verdict: RateVerdict = "open"
        if total and required is None:
            verdict = "shown" if passed == total else "refuted"
        elif not total or required is None or self.is_one_run:
            pass
        elif self.is_decided:
            verdict = decided(passed, total, required, self._confidence)
        elif low >= required:
            verdict = "shown"
        elif high < required:
            verdict = "refuted"
        early = self.is_decided and total < planned
        return SuccessRate(
            passed,
            total,
            low,
            high,
            self._confidence,
            required,
            verdict,
            early,
            invalid=invalid,
            is_one_run=self.is_one_run,
        )


class Sampling:
    """Knows after each result which groups are decided; in the order of the samples' numbers.

    With many workers later samples may end first: they count once all before them have, so that
    the end is the same however many work.
    """

    def __init__(self, plan: Iterable[PlannedCase], *, is_part: bool = False) -> None:
        """Count nothing yet.

        Args:
            is_part: Whether other parts of the suite hold samples of the same groups; then no rate
                is decided here, and every sample is run.
        """
        self._is_part = is_part
        self._groups: dict[tuple[str, str], _Group] = {}
        self._places: list[tuple[_Group, int] | None] = []  # None of a case that is no sample
        for each in plan:
            group = self._group_of(each)
            self._places.append(None if group is None else (group, group.planned))
            if group is not None:
                group.planned += 1

    def _group_of(self, planned: PlannedCase) -> _Group | None:
        key = planned.rate_key
        if key is None:
            return None
        if key not in self._groups:
            self._groups[key] = _Group(planned.header.variation, is_part=self._is_part)
        return self._groups[key]

    def note(self, index: int, outcome: Outcome, digest: str) -> None:
        """Take in an outcome, and the digest of the run; empty where nothing ran."""
        if found := self._places[index]:
            group, place = found
            group.note(place, outcome, digest)

    def is_needless(self, index: int) -> bool:
        """Whether a sample no longer counts, or would only repeat another sample's mistake."""
        found = self._places[index]
        return found is not None and found[0].is_needless(found[1])

    def groups(self) -> list[SampledRate]:
        """Every group with its rate, from the first samples without a missing number.

        A part of a suite decides no rates.
        """
        if self._is_part:
            return []
        found: list[SampledRate] = []
        for key, group in self._groups.items():
            rate = group.tally.rate(group.planned, group.invalid)
            outcome: Outcome = "passed" if rate.verdict == "shown" else "failed"
            found.append(SampledRate(*key, rate, outcome))
        return found

    def outcomes(self, results: Iterable[tuple[int, Outcome]]) -> set[Outcome]:
        """Outcomes of cases that count, with groups of samples in place of failed samples."""
        outcomes: set[Outcome] = {group.outcome for group in self.groups()}
        are_all_sampled = all(self._places)
        for index, outcome in results:
            if outcome in outcomes or (outcome == "passed" and are_all_sampled):
                continue
            if outcome == "failed" and (found := self._places[index]):
                is_alone = self._is_part and not found[0].has_required_rate
                outcomes |= {outcome} if is_alone else set()
            elif outcome != "passed" or self._places[index] is None:
                outcomes.add(outcome)
        return outcomes


class _Group:
    """Samples that share a rate.

    Attributes:
        planned: Number of samples in the plan.
        tally: Count of the first samples without a missing number, invalid ones left out.
        invalid: Samples that could not be run; they are no evidence about the rate.
        has_required_rate: Whether the file has an `expect_rate`; else every sample must pass.
    """

    def __init__(self, variation: Variation, *, is_part: bool) -> None:
        self.planned = 0
        self.has_required_rate = variation.at_least is not None
        stop_early = variation.stop_early and not is_part
        self.tally = Tally(variation.at_least, variation.confidence, stop_early=stop_early)
        self._waiting: dict[int, tuple[Outcome, str]] = {}  # samples before them are missing
        self._next = 0
        self.invalid = 0

    def note(self, place: int, outcome: Outcome, digest: str) -> None:
        self._waiting[place] = outcome, digest
        self.invalid += outcome == "invalid"
        while self._next in self._waiting:
            counted, of_run = self._waiting.pop(self._next)
            if counted != "invalid":
                self.tally.add(counted == "passed", of_run)
            self._next += 1

    def is_needless(self, place: int) -> bool:
        if self.invalid:
            return place >= self._next and place not in self._waiting
        return self.tally.is_decided and place >= self.tally.total
