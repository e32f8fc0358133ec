"""What varies in many runs, and the results, as columns of numbers."""

from __future__ import annotations

import heapq
import math
from array import array
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.core.quantity import split_quantity
from harness.core.types import FloatArray
from harness.reporting.suite.record import SuiteCase

PASSED = -1  # in place of the number of a group of failures
ABSENT, WORD = -1, -2


@dataclass(frozen=True)
class VariedQuantity:
    """A quantity that varies, as numbers.

    Attributes:
        path: Where it stands in the file.
        words: The values of a parameter whose values are no numbers; the numbers count them.
        numbers: A number for each run; NaN where the run does not have the parameter.
    """

    path: str
    unit: str
    words: tuple[str, ...]
    numbers: FloatArray


class _Column:
    """The values of a parameter, in as little memory as numbers take."""

    def __init__(self, missing: int) -> None:
        self.numbers = array("d", [math.nan]) * missing
        self.kinds = array("b", [ABSENT]) * missing
        self.units: list[str] = []
        self.words: dict[str, int] = {}

    def add(self, value: Any) -> None:
        if value is None:
            return self._add(math.nan, ABSENT)
        try:
            number, unit = split_quantity(value)
        except ValueError:
            return self._add(self.words.setdefault(str(value), len(self.words)), WORD)
        if unit not in self.units:
            self.units.append(unit)
        return self._add(number, self.units.index(unit))

    def _add(self, number: float, kind: int) -> None:
        self.numbers.append(number)
        self.kinds.append(kind)

    def parameter(self, path: str) -> VariedQuantity:
        if len(self.units) == 1 and not self.words:
            return VariedQuantity(path, self.units[0], (), np.array(self.numbers))
        words, texts = list(self.words), dict[str, int]()
        numbers = [
            math.nan if kind == ABSENT else texts.setdefault(
                words[int(number)] if kind == WORD else f"{number:g} {self.units[kind]}".rstrip(),
                len(texts),
            )
            for number, kind in zip(self.numbers, self.kinds, strict=True)
        ]  # fmt: skip
        return VariedQuantity(path, "", tuple(texts), np.array(numbers, dtype=float))


class Columns:
    """Everything that the page and the terminal show of many runs together.

    Attributes:
        margins: Text and unit of an expectation -> its finite margins, of valid runs that vary.
        numbers: Indices among all runs of the valid runs that vary; the other columns are of these.
        shares: The worst margin of each as a share of its limit; NaN where there is none.
        groups: Index of each run's cause among `causes`; -1: passed.
        file_numbers: Index of each run's file among `files`.
        without_margin: The number of failures without a finite margin, by expectation.
    """

    def __init__(self, cases: Iterable[SuiteCase] = (), *, most_listed: int = 0) -> None:
        """Read some cases.

        Args:
            most_listed: How many runs are listed: failures, then the nearest to failing.
        """
        self.outcomes = Counter[str]()
        self.causes = Counter[str]()
        self.margins: dict[tuple[str, str], array[float]] = {}
        self.numbers = array("Q")
        self.shares = array("d")
        self.groups = array("l")
        self.file_numbers = array("l")
        self.without_margin = Counter[str]()
        self._files: dict[str, int] = {}
        self._digests: dict[str, str] = {}  # of each file, empty where its runs differ
        self._columns: dict[str, _Column] = {}
        self._most_listed = most_listed
        self._urgent: list[tuple[bool, float, int]] = []  # a heap: the least urgent is first
        self._group_numbers: dict[str, int] = {}
        for case in cases:
            self.add(case)

    def add(self, case: SuiteCase) -> None:
        index, outcome = self.outcomes.total(), case.result.outcome
        self.outcomes[outcome] += 1
        group = PASSED
        if case.cause is not None:
            self.causes[case.cause.group] += 1
            group = self._group_numbers.setdefault(case.cause.group, len(self._group_numbers))
        is_passed, share = case.urgency
        push = heapq.heappush if index < self._most_listed else heapq.heappushpop
        if self._most_listed:
            push(self._urgent, (not is_passed, -share, -index))
        if not case.values or outcome == "invalid":
            return
        for path in case.values:
            if path not in self._columns:
                self._columns[path] = _Column(len(self.numbers))
        for path, column in self._columns.items():
            column.add(case.values.get(path))
        for verdict in case.result.verdicts:
            if math.isfinite(verdict.margin):
                key = verdict.expectation, verdict.unit
                self.margins.setdefault(key, array("d")).append(verdict.margin)
            elif verdict.status == "failed":
                self.without_margin[verdict.expectation] += 1
        self.numbers.append(index)
        self.shares.append(case.share)
        self.groups.append(group)
        file, digest = case.result.file, case.result.digest
        self.file_numbers.append(self._files.setdefault(file, len(self._files)))
        self._digests[file] = digest if self._digests.get(file, digest) == digest else ""

    @property
    def files(self) -> list[str]:
        """The files of the runs that vary, in their order."""
        return list(self._files)

    @property
    def one_run(self) -> Iterator[tuple[str, int]]:
        """Files of which several runs that vary are one and the same, and the number of these."""
        counts = np.bincount(
            np.array(self.file_numbers, dtype=np.int64), minlength=len(self._files)
        )
        for file, count in zip(self._files, counts.tolist(), strict=True):
            if count > 1 and self._digests[file]:
                yield file, count

    @property
    def listed(self) -> list[int]:
        """Indices of the runs that are listed: failures, then the nearest to failing."""
        return [-index for _, _, index in sorted(self._urgent, reverse=True)]

    @property
    def parameters(self) -> list[VariedQuantity]:
        """Everything that varies in some run, in the order in which the runs name it."""
        return [column.parameter(path) for path, column in self._columns.items()]

    @property
    def is_good(self) -> NDArray[np.bool_]:
        """Which of the runs passed."""
        return np.array(self.groups) == PASSED
