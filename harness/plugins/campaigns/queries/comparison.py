"""Two campaigns on the same conditions: changed outcomes, and paired margins."""

from __future__ import annotations

import math
import sqlite3
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from statistics import NormalDist
from typing import Any

from harness.core.types import FloatArray
from harness.suite.discovery import UsageError

LEVEL = 0.05  # probability of calling equal campaigns different
POWER = 0.8  # probability with which the smallest detectable drop would have been detected

MOST_NAMES = 5  # of cases in a sentence
RUNS = "FROM main.runs a, second.runs b"


@dataclass(frozen=True)
class PairedMargin:
    """How the margin of an expectation changed from one campaign to the other.

    Attributes:
        pairs: Pairs of runs in which both have the margin.
        median: Median of second minus first; negative where the second is nearer to failing.
        p_value: Wilcoxon's signed-rank test [1] of no change; 1 where all margins are equal.

    References:
        [1] F. Wilcoxon, "Individual Comparisons by Ranking Methods", Biometrics Bulletin 1(6),
            1945.
    """

    expectation: str
    unit: str
    pairs: int
    median: float
    p_value: float


@dataclass(frozen=True)
class CampaignComparison:
    """What two campaigns on the same conditions show.

    Attributes:
        pairs: Runs with the same file, case and seed in both.
        unpaired: Runs of either that have no counterpart.
        passed: How many of the pairs passed in the first and in the second.
        broken: Pairs that passed in the first only.
        repaired: Pairs that passed in the second only.
        p_value: Exact McNemar test [1] of equal success rates.
        detectable_drop: Smallest drop of the success rate that this many pairs detect with 80 %
            probability [2]; NaN without pairs.
        identical: Pairs with the same digest.
        margins: How the margins changed, one for each expectation.
        broken_names: The first cases that passed in the first only.

    References:
        [1] Q. McNemar, "Note on the Sampling Error of the Difference Between Correlated
            Proportions or Percentages", Psychometrika 12(2), 1947.
        [2] R. J. Connor, "Sample Size for Testing Differences in Proportions for the Paired-Sample
            Design", Biometrics 43(1), 1987.
    """

    pairs: int
    unpaired: int
    passed: tuple[int, int]
    broken: int
    repaired: int
    p_value: float
    detectable_drop: float
    identical: int
    margins: tuple[PairedMargin, ...]
    broken_names: tuple[str, ...]

    @property
    def is_worse(self) -> bool:
        """Whether the second campaign has a lower success rate, beyond chance."""
        return self.broken > self.repaired and self.p_value < LEVEL


def compare_campaigns(first: sqlite3.Connection, other: Path) -> CampaignComparison:
    """Compare a campaign with another one; runs with the same file, case and seed are pairs.

    Where each campaign has one scenario file, the files may be called differently.

    Args:
        first: The database of the first campaign.
        other: The database file of the second campaign, which is up to date.

    Raises:
        UsageError: The campaigns have no run in common.
    """
    first.execute("ATTACH ? AS second", (str(other),))
    try:
        files = [
            [row[0] for row in first.execute(f"SELECT DISTINCT file FROM {name}runs LIMIT 2")]
            for name in ("main.", "second.")
        ]
        same_file = "1" if [len(each) for each in files] == [1, 1] else "a.file = b.file"
        paired = (
            f"a.name = b.name AND a.seed = b.seed AND {same_file}"
            " AND a.outcome != 'invalid' AND b.outcome != 'invalid'"
        )
        return _compared(first, paired)
    finally:
        first.commit()
        first.execute("DETACH second")


def _compared(database: sqlite3.Connection, paired: str) -> CampaignComparison:
    """Compare; `paired` is the condition for runs `a` and `b` of the two to be a pair."""
    from scipy.stats import binomtest

    joined = f"{RUNS} WHERE {paired}"

    counts = {
        (bool(one), bool(two)): number
        for one, two, number in database.execute(
            f"SELECT a.outcome = 'passed', b.outcome = 'passed', count(*) {joined} GROUP BY 1, 2"
        )
    }
    both, broken = counts.get((True, True), 0), counts.get((True, False), 0)
    repaired = counts.get((False, True), 0)
    pairs = sum(counts.values())
    sizes = [
        database.execute(f"SELECT count(*) FROM {name}.runs").fetchone()[0]
        for name in ("main", "second")
    ]
    if not pairs:
        raise UsageError("the campaigns have no run of the same file, case and seed in common")
    changed = broken + repaired
    same = database.execute(f"SELECT count(*) {joined} AND a.digest = b.digest").fetchone()[0]
    names = database.execute(
        f"SELECT a.file, a.name {joined} AND a.outcome = 'passed' AND b.outcome != 'passed'"
        " ORDER BY a.number LIMIT ?",
        (MOST_NAMES,),
    )
    return CampaignComparison(
        pairs,
        sum(sizes) - 2 * pairs,
        (both + broken, both + repaired),
        broken,
        repaired,
        float(binomtest(broken, changed).pvalue) if changed else 1.0,
        detectable_drop(pairs, min(broken, repaired) / pairs),
        same,
        tuple(_paired_margins(database, paired)),
        tuple(f"{file} [{name}]" if name else file for file, name in names),
    )


def _paired_margins(database: sqlite3.Connection, paired: str) -> Iterator[PairedMargin]:
    """One for each expectation; a number for each pair is in memory."""
    import numpy as np

    margins = (
        f"{RUNS}, main.verdicts u, second.verdicts v WHERE {paired} AND u.key = a.key"
        " AND v.key = b.key AND u.number = v.number AND u.unit = v.unit"
        " AND u.margin IS NOT NULL AND v.margin IS NOT NULL"
    )
    kinds = database.execute(
        f"SELECT u.number, u.line, u.unit, min(u.expectation) {margins} GROUP BY 1, 2, 3"
    ).fetchall()
    for number, line, unit, expectation in kinds:
        found = database.execute(
            f"SELECT v.margin - u.margin {margins} AND u.number = ? AND u.line = ? AND u.unit = ?",
            (number, line, unit),
        )
        differences = np.fromiter((row[0] for row in found), float)
        p_value = _wilcoxon(differences)
        yield PairedMargin(
            expectation, unit, len(differences), float(np.median(differences)), p_value
        )


def _wilcoxon(differences: FloatArray) -> float:
    """The p-value of Wilcoxon's test of no change."""
    from scipy.stats import wilcoxon

    if not differences.any():
        return 1.0
    tested: Any = wilcoxon(differences)
    return float(tested.pvalue)


def detectable_drop(pairs: int, opposite: float) -> float:
    """The smallest drop of the success rate that McNemar's test detects with 80 % probability.

    Args:
        pairs: The number of pairs.
        opposite: The share of pairs that change against the drop.
    """
    if not pairs:
        return math.nan
    level, power = NormalDist().inv_cdf(1 - LEVEL / 2), NormalDist().inv_cdf(POWER)

    def is_detected(drop: float) -> bool:
        changed = min(1.0, 2 * opposite + drop)
        spread = power * math.sqrt(max(0.0, changed - drop * drop))
        return pairs * drop * drop >= (level * math.sqrt(changed) + spread) ** 2

    low, high = 0.0, 1.0
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (low, middle) if is_detected(middle) else (middle, high)
    return high
