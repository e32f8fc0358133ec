"""Which parameters explain the failures of a file's runs, or their margins where none failed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.core.types import FloatArray, IntArray
from harness.reporting.suite.columns import Columns, VariedQuantity

FEWEST_RUNS = 8  # with fewer runs no effect can be shown
FEWEST_FAILURES = 3  # with fewer, what is named may be one coincidence
LEVEL = 0.05  # chance of such an effect of any parameter below which one is named
RESHUFFLES = 1999  # permutations of a test: they resolve a hundredth of `LEVEL`
NEGLIGIBLE = 0.05  # of the limit: margins that differ by less are a flat curve
MOST_RUNS = 1000  # failed runs, and passed runs, that a test looks at; of more, an even choice


@dataclass(frozen=True)
class Effect:
    """The association of one parameter with the outcome, or with the margin.

    Attributes:
        share: Its strength from 0 to 1; None where these runs cannot show it. Of a number and the
            outcome, it is the share of pairs of a failed and a passed run in which the failed one
            has the lower value (or the higher one, or the one nearer to an end of the range or to
            its middle), less the share of the other pairs. Else it is the correlation of the ranks,
            or the correlation ratio of words.
        reason: Why there is no share; empty where there is one.
        chance: The probability that chance gives any parameter of the file as clear an effect.
        words: How the failed runs differ, or how the margin depends on the parameter.
        causes: The causes whose failures it explains, where runs failed for several causes.
        explained: The number of these failures.
    """

    path: str
    share: float | None
    reason: str = ""
    chance: float = 1.0
    words: str = ""
    causes: tuple[str, ...] = ()
    explained: int = 0

    @property
    def is_shown(self) -> bool:
        """Whether the effect is more than chance gives."""
        return self.share is not None and self.chance < LEVEL

    @property
    def dependence(self) -> str:
        """How margins depend on it: `smaller with larger values of friction`."""
        if "its range" in self.words:
            return self.words.replace("its range", f"the range of {self.path}")
        return f"{self.words} of {self.path}"


@dataclass(frozen=True)
class FileSensitivity:
    """The effects of everything that varies among the runs of one file.

    Attributes:
        measured: What is explained: `outcome` where some runs failed, else `worst margin`.
        failures: The number of failed runs.
        causes: The number of causes for which they failed.
        effects: The clearest one first; empty where the file has too few runs.
        margins: The least and the largest worst margin, as shares of the limit, where these are
            explained.
    """

    file: str
    runs: int
    measured: str = ""
    failures: int = 0
    effects: Sequence[Effect] = ()
    causes: int = 1
    margins: tuple[float, float] = (-math.inf, math.inf)

    @property
    def conclusion(self) -> str:
        """What the runs show, in a sentence."""
        what = "these failures" if self.measured == "outcome" else "the margins"
        found = [each for each in self.effects if each.is_shown]
        low, high = self.margins
        if high - low < NEGLIGIBLE:
            return f"The worst margins hardly differ: {low:.1%} to {high:.1%} of the limit."
        if not found:
            return f"No parameter explains {what}: none has an effect beyond chance."
        if self.causes > 1:
            parts = [f"{each.path} ({each.words}) explains {each.explained}" for each in found]
            return f"Of {self.failures} failures {' and '.join(parts)}."
        if self.measured != "outcome":
            return f"The margins are {' and '.join(each.dependence for each in found)}."
        shown = [f"{each.path} ({each.words})" for each in found]
        verb = "explains" if len(shown) == 1 else "explain"
        few = self.failures < FEWEST_FAILURES
        doubt = f": a lead, as fewer than {FEWEST_FAILURES} runs failed; draw more" if few else ""
        return f"{' and '.join(shown)} {verb} {what}{doubt}."


def sensitivities(columns: Columns) -> Iterator[FileSensitivity]:
    """Test each parameter among the runs of one file, in the order of the files.

    The statistic is a rank correlation, of the parameter or of its distance from its middle, or of
    words the correlation ratio. Permutations of the outcomes give its distribution by chance, and
    Westfall and Young's step with the smallest probability accounts for the number of parameters
    [1]. The permutations are always the same. Where runs failed for several causes, each cause is
    tested against the runs that passed, and its probabilities are multiplied by their number.

    References:
        [1] P. H. Westfall and S. S. Young, "Resampling-Based Multiple Testing", Wiley, 1993.
    """
    files = np.array(columns.file_numbers)
    shares, is_good = np.array(columns.shares), columns.is_good
    for number, file in enumerate(columns.files):
        chosen = np.flatnonzero(files == number)
        if len(chosen) < FEWEST_RUNS:
            yield FileSensitivity(file, len(chosen))
            continue
        failures = int((~is_good[chosen]).sum())
        has_both = 0 < failures < len(chosen)
        if has_both:
            values = (~is_good).astype(float)
            chosen = np.sort(np.concatenate([evenly(chosen[is_good[chosen] == each])
                                             for each in (False, True)]))  # fmt: skip
        else:
            values = shares
            chosen = evenly(chosen[np.isfinite(shares[chosen])], 2 * MOST_RUNS)
            if len(chosen) and 0 < np.ptp(shares[chosen]) < NEGLIGIBLE:
                yield _flat(columns, file, chosen, failures)
                continue
        causes = _causes(columns, chosen) if has_both else {}
        if len(causes) > 1:
            effects = _effects_by_cause(columns, chosen, causes)
        else:
            effects = _effects(columns.parameters, chosen, values[chosen], is_outcome=has_both)
        measured = "outcome" if has_both else "worst margin"
        runs = int((files == number).sum())
        yield FileSensitivity(file, runs, measured, failures, effects, max(1, len(causes)))


def _flat(columns: Columns, file: str, chosen: IntArray, failures: int) -> FileSensitivity:
    """Runs whose margins no parameter changes much, however regularly it does."""
    shares = np.array(columns.shares)[chosen]
    effects = [
        Effect(each.path, None, "the margins hardly differ")
        for each in columns.parameters
        if len(np.unique(each.numbers[chosen][np.isfinite(each.numbers[chosen])])) > 1
    ]
    margins = float(shares.min()), float(shares.max())
    return FileSensitivity(file, len(chosen), "worst margin", failures, effects, margins=margins)


def _causes(columns: Columns, chosen: IntArray) -> dict[str, IntArray]:
    """The failed runs of each cause, the most frequent cause first."""
    names, groups = list(columns.causes), np.array(columns.groups)[chosen]
    found = {names[group]: chosen[groups == group] for group in np.unique(groups[groups >= 0])}
    return dict(sorted(found.items(), key=lambda each: -len(each[1])))


def _effects_by_cause(
    columns: Columns, chosen: IntArray, causes: Mapping[str, IntArray]
) -> list[Effect]:
    """The effects of parameters on failures of any cause, those that explain most first."""
    passed = chosen[columns.is_good[chosen]]
    found: dict[str, list[tuple[str, Effect]]] = {}
    for cause, failed in causes.items():
        runs = np.sort(np.concatenate([passed, failed]))
        values = np.isin(runs, failed).astype(float)
        for each in _effects(columns.parameters, runs, values, is_outcome=True):
            chance = min(1.0, each.chance * len(causes))
            found.setdefault(each.path, []).append((cause, replace(each, chance=chance)))
    merged = [_merged(each, causes) for each in found.values()]
    return sorted(merged, key=lambda each: (-each.explained, each.share is None, each.chance))


def _merged(effects: Sequence[tuple[str, Effect]], causes: Mapping[str, IntArray]) -> Effect:
    """The clearest effect of a parameter on one of the causes, with all causes that it explains."""
    shown = tuple(cause for cause, each in effects if each.is_shown)
    clearest = min((each for _, each in effects), key=lambda each: each.chance)
    explained = sum(len(causes[cause]) for cause in shown)
    return replace(clearest, causes=shown, explained=explained)


def evenly(indices: IntArray, most: int = MOST_RUNS) -> IntArray:
    """At most a given number of the indices, at even distances."""
    if len(indices) <= most:
        return indices
    return indices[np.linspace(0, len(indices) - 1, most).astype(int)]


def _effects(
    parameters: Sequence[VariedQuantity], chosen: IntArray, values: FloatArray, *, is_outcome: bool
) -> list[Effect]:
    """The effects of the parameters that vary among some runs, the clearest one first."""
    of_nothing: list[Effect] = []
    scores: list[tuple[VariedQuantity, FloatArray]] = []
    ranks = _ranks(values)
    for each in parameters:
        numbers = each.numbers[chosen]
        known = np.isfinite(numbers)
        distinct = np.unique(numbers[known])
        if len(distinct) < 2:
            continue
        if len(values) and not np.ptp(values):
            what = "outcome" if is_outcome else "worst margin"
            of_nothing.append(Effect(each.path, None, f"every run has the same {what}"))
        elif known.sum() < FEWEST_RUNS or (each.words and 2 * len(distinct) > known.sum()):
            of_nothing.append(Effect(each.path, None, f"too few runs: {known.sum()}"))
        else:
            scores.append((each, _scores(each, numbers, known)))
    if not scores:
        return of_nothing
    chances = _chances([score for _, score in scores], ranks)
    effects = [
        _effect(each, score, each.numbers[chosen], values, ranks, chance, is_outcome=is_outcome)
        for (each, score), chance in zip(scores, chances, strict=True)
    ]
    effects.sort(key=lambda each: (each.chance, -(each.share or 0.0)))
    return [*effects, *of_nothing]


def _scores(parameter: VariedQuantity, numbers: FloatArray, known: NDArray[np.bool_]) -> FloatArray:
    """Columns of length 1, (runs, k): a number's ranks and folded ranks, or words' indicators."""
    if parameter.words:
        words = np.unique(numbers[known])
        groups = (numbers[:, None] == words[None, :]).astype(float)
        return groups / np.sqrt(groups.sum(axis=0))
    columns = np.zeros((len(numbers), 2))
    columns[known, 0] = _ranks(numbers[known])
    columns[known, 1] = np.abs(columns[known, 0])
    columns[known, 1] -= columns[known, 1].mean()
    lengths = np.linalg.norm(columns, axis=0)
    return columns / np.where(lengths > 0, lengths, 1.0)


def _ranks(values: FloatArray) -> FloatArray:
    """Ranks around 0; equal values have their mean rank."""
    _, places, counts = np.unique(values, return_inverse=True, return_counts=True)
    last = np.cumsum(counts)
    return (last - (counts - 1) / 2)[places] - (len(values) + 1) / 2


def _statistics(scores: Sequence[FloatArray], ranks: FloatArray) -> FloatArray:
    """How clear each parameter's effect is, (permutations, parameters).

    Args:
        scores: Columns of each parameter, (runs, k).
        ranks: Ranks of the explained values, (permutations, runs).
    """
    found: list[FloatArray] = []
    for score in scores:
        products = np.abs(ranks @ score)
        of_words = bool((score >= 0).all())
        found.append(np.sqrt((products**2).sum(axis=1)) if of_words else products.max(axis=1))
    return np.stack(found, axis=1)


def _chances(scores: Sequence[FloatArray], ranks: FloatArray) -> FloatArray:
    """The probability that chance gives any parameter as clear an effect, for each parameter."""
    rng = np.random.default_rng(0)
    shuffled = rng.permuted(np.tile(ranks, (RESHUFFLES, 1)), axis=1)
    statistics = np.round(_statistics(scores, np.vstack([ranks, shuffled])), 9)
    alone = np.empty_like(statistics)
    for column, values in enumerate(statistics.T):
        alone[:, column] = 1 - np.searchsorted(np.sort(values), values) / len(values)
    smallest: FloatArray = alone.min(axis=1)
    return np.array([(smallest <= each).mean() for each in alone[0]])


def _effect(
    parameter: VariedQuantity,
    score: FloatArray,
    numbers: FloatArray,
    values: FloatArray,
    ranks: FloatArray,
    chance: float,
    *,
    is_outcome: bool,
) -> Effect:
    products = ranks @ score / np.linalg.norm(ranks)
    if parameter.words:
        share = float(np.sqrt((products**2).sum()))
        words = np.unique(numbers[np.isfinite(numbers)])
        means = [float(values[numbers == each].mean()) for each in words]
        worst = int(np.argmax(means) if is_outcome else np.argmin(means))
        of_worst = values[numbers == words[worst]]
        name = parameter.words[int(words[worst])]
        text = f"smallest with the value {name}"
        if is_outcome:
            text = f"{int(of_worst.sum())} of {len(of_worst)} failed with {name}"
        return Effect(parameter.path, min(1.0, share), "", float(chance), text)
    is_folded = abs(products[1]) > abs(products[0])
    is_larger = products[int(is_folded)] > 0
    if not is_outcome:
        text = ("larger" if is_larger else "smaller") + " with larger values"
        if is_folded:
            text = ("larger" if is_larger else "smaller") + " towards the ends of its range"
        return Effect(parameter.path, float(abs(products[int(is_folded)])), "", float(chance), text)
    text = ("higher" if is_larger else "lower") + " in failed runs"
    if is_folded:
        text = f"nearer to {'the ends' if is_larger else 'the middle'} of its range in failed runs"
    column = score[:, int(is_folded)][np.isfinite(numbers)]
    return Effect(
        parameter.path, _pairs(column, values[np.isfinite(numbers)] > 0), "", float(chance), text
    )


def _pairs(scores: FloatArray, is_failed: NDArray[np.bool_]) -> float:
    """The share of pairs whose failed run is higher, less that of those where it is lower."""
    failed, passed = int(is_failed.sum()), int((~is_failed).sum())
    if not failed or not passed:
        return 0.0
    total = _ranks(scores)[is_failed].sum()
    return float(abs(2 * total / (failed * passed)))
