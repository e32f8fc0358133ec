"""Success rates while samples come in, and which of them are no longer needed."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable

from harness.recording.run import Outcome
from harness.reporting.sampled import SampledRate
from harness.suite.plan import PlannedCase
from harness.suite.rates import Tally
from harness.suite.variation import Variation


class Sampling:
    """Knows after each result which groups are decided; in the order of the samples' numbers.

    With many workers later samples may end first: they count once all before them have, so that
    the end is the same however many work.
    """

    def __init__(self, plan: Iterable[PlannedCase], *, is_part: bool = False) -> None:
        """Count nothing yet.

        Args:
            plan: The cases, samples among them.
            is_part: Whether other parts of the suite hold samples of the same groups; then no rate
                is decided here, and every sample is run.
        """
        self._is_part = is_part
        self._groups: dict[tuple[str, str], _Group] = {}
        self._runs: list[tuple[int, int, _Group | None]] = []  # first index, first place, group
        for index, each in enumerate(plan):
            group = self._group_of(each)
            if not self._runs or self._runs[-1][2] is not group:
                self._runs.append((index, 0 if group is None else group.planned, group))
            if group is not None:
                group.planned += 1

    def _group_of(self, planned: PlannedCase) -> _Group | None:
        key = planned.rate_key
        if key is None:
            return None
        if key not in self._groups:
            self._groups[key] = _Group(planned.header.variation, is_part=self._is_part)
        return self._groups[key]

    def _place(self, index: int) -> tuple[_Group, int] | None:
        """The group of a sample and its place there; None of a case that is no sample."""
        first, place, group = self._runs[bisect_right(self._runs, index, key=_first) - 1]
        return None if group is None else (group, place + index - first)

    def note(self, index: int, outcome: Outcome, digest: str) -> None:
        """Take in an outcome, and the digest of the run; empty where nothing ran."""
        if found := self._place(index):
            group, place = found
            group.note(place, outcome, digest)

    def is_needless(self, index: int) -> bool:
        """Whether a sample no longer counts, or would only repeat another sample's mistake."""
        found = self._place(index)
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
        are_all_sampled = all(group is not None for _, _, group in self._runs)
        for index, outcome in results:
            if outcome in outcomes or (outcome == "passed" and are_all_sampled):
                continue
            if outcome == "failed" and (found := self._place(index)):
                is_alone = self._is_part and not found[0].has_required_rate
                outcomes |= {outcome} if is_alone else set()
            elif outcome != "passed" or self._place(index) is None:
                outcomes.add(outcome)
        return outcomes


def _first(run: tuple[int, int, _Group | None]) -> int:
    return run[0]


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
