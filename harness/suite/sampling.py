"""Success rates while samples come in, and which of them are no longer needed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from harness.recording.run import Outcome
from harness.reporting.result import CaseResult
from harness.reporting.sampled import SampledRate
from harness.suite.plan import PlannedCase
from harness.suite.rates import Tally


class Sampling:
    """Knows after each result which groups are decided; in the order of the samples' numbers.

    With many workers later samples may end first: they count once all before them have, so that
    the end is the same however many work.
    """

    def __init__(self, plan: Sequence[PlannedCase], *, is_part: bool = False) -> None:
        """Count nothing yet.

        Args:
            plan: The cases, samples among them.
            is_part: Whether other parts of the suite hold samples of the same groups; then no rate
                is decided here, and every sample is run.
        """
        self._is_part = is_part
        self._groups: dict[tuple[str, str], _Group] = {}
        self._places: dict[int, tuple[_Group, int]] = {}
        for index, each in enumerate(plan):
            if each.rate_key is not None:
                group = self._groups.setdefault(each.rate_key, _Group(each, is_part=is_part))
                self._places[index] = group, group.planned
                group.planned += 1

    def note(self, index: int, outcome: Outcome, digest: str) -> None:
        """Take in an outcome, and the digest of the run; empty where nothing ran."""
        if index in self._places:
            group, place = self._places[index]
            group.note(place, outcome, digest)

    def is_needless(self, index: int) -> bool:
        """Whether a sample no longer counts, or would only repeat another sample's mistake."""
        if index not in self._places:
            return False
        group, place = self._places[index]
        return group.is_needless(place)

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

    def counted(self, results: Mapping[int, CaseResult]) -> dict[int, CaseResult]:
        """Results without those of samples after an early stop."""
        return {index: each for index, each in results.items() if not self.is_needless(index)}

    def outcomes(self, results: Mapping[int, CaseResult]) -> list[Outcome]:
        """Outcomes of the cases, with groups of samples in place of failed samples."""
        outcomes: list[Outcome] = [group.outcome for group in self.groups()]
        for index, result in self.counted(results).items():
            is_sample = index in self._places
            is_alone = self._is_part and is_sample and not self._places[index][0].has_required_rate
            if not is_sample or is_alone or result.outcome in ("invalid", "error"):
                outcomes.append(result.outcome)
        return outcomes


class _Group:
    """Samples that share a rate.

    Attributes:
        planned: Number of samples in the plan.
        tally: Count of the first samples without a missing number, invalid ones left out.
        invalid: Samples that could not be run; they are no evidence about the rate.
        has_required_rate: Whether the file has an `expect_rate`; else every sample must pass.
    """

    def __init__(self, sample: PlannedCase, *, is_part: bool) -> None:
        variation = sample.variation
        self.planned = 0
        self.has_required_rate = variation.at_least is not None
        stop_early = variation.stop_early and not is_part
        self.tally = Tally(variation.at_least, variation.confidence, stop_early=stop_early)
        self._outcomes: dict[int, tuple[Outcome, str]] = {}
        self._next = 0
        self.invalid = 0

    def note(self, place: int, outcome: Outcome, digest: str) -> None:
        self._outcomes[place] = outcome, digest
        self.invalid += outcome == "invalid"
        while self._next in self._outcomes:
            counted, of_run = self._outcomes[self._next]
            if counted != "invalid":
                self.tally.add(counted == "passed", of_run)
            self._next += 1

    def is_needless(self, place: int) -> bool:
        if self.invalid:
            return place not in self._outcomes
        return self.tally.is_decided and place >= self.tally.total
