"""Success rates while samples come in, and which of them are no longer needed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from harness.recording.run import Outcome
from harness.reporting.result import CaseResult
from harness.reporting.sampled import SampledRate
from harness.suite.plan import PlannedCase
from harness.suite.rates import decided, rate_of

Key = tuple[str, str]


class Sampling:
    """Knows after each result which groups are decided; in the order of the samples' numbers.

    With many workers later samples may end first: they count once all before them have, so that
    the end is the same however many work.
    """

    def __init__(self, plan: Sequence[PlannedCase]) -> None:
        self._plan = plan
        self._groups: dict[Key, list[int]] = {}
        for index, each in enumerate(plan):
            if each.rate_key is not None:
                self._groups.setdefault(each.rate_key, []).append(index)
        self._outcomes: dict[int, Outcome] = {}
        self._ends: dict[Key, int] = {}
        self._invalid: set[Key] = set()

    def note(self, index: int, outcome: Outcome) -> None:
        """Take in an outcome."""
        self._outcomes[index] = outcome
        key = self._plan[index].rate_key
        variation = self._plan[index].variation
        if key is not None and outcome == "invalid":
            self._invalid.add(key)
        if key is None or key in self._ends or variation.at_least is None:
            return
        if not variation.stop_early:
            return
        outcomes = self._prefix(key)
        passed = 0
        for count, is_good in enumerate(outcomes, start=1):
            passed += is_good
            if decided(passed, count, variation.at_least, variation.confidence) != "open":
                self._ends[key] = count
                return

    def is_needless(self, index: int) -> bool:
        """Whether a sample would not count any more, or tell but the mistake of another."""
        key = self._plan[index].rate_key
        if key is None:
            return False
        if key in self._invalid:
            return index not in self._outcomes
        return key in self._ends and index in self._groups[key][self._ends[key] :]

    def groups(self) -> list[SampledRate]:
        """Every group with its rate, from the samples that came in without a gap."""
        found: list[SampledRate] = []
        for key, indices in self._groups.items():
            variation = self._plan[indices[0]].variation
            rate = rate_of(
                self._prefix(key),
                variation.at_least,
                variation.confidence,
                stop_early=variation.stop_early,
                wanted=len(indices),
            )
            outcome: Outcome = "passed" if rate.verdict == "shown" else "failed"
            found.append(SampledRate(*key, rate, outcome))
        return found

    def counted(self, results: Mapping[int, CaseResult]) -> dict[int, CaseResult]:
        """Results without those of samples behind an early end."""
        return {index: each for index, each in results.items() if not self.is_needless(index)}

    def outcomes(self, results: Mapping[int, CaseResult]) -> list[Outcome]:
        """What the whole comes to: cases, and groups of samples in place of failed samples."""
        told: list[Outcome] = [group.outcome for group in self.groups()]
        for index, result in self.counted(results).items():
            if self._plan[index].rate_key is None or result.outcome in ("invalid", "error"):
                told.append(result.outcome)
        return told

    def _prefix(self, key: Key) -> list[bool]:
        """Whether samples passed, in order, up to the first that has not come in."""
        outcomes: list[bool] = []
        for index in self._groups[key]:
            if index not in self._outcomes:
                break
            outcomes.append(self._outcomes[index] == "passed")
        return outcomes
