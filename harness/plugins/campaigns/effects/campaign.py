"""The part of a suite's page about what varies: a map of the runs, margins, and sensitivities."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.amounts import amount
from harness.core.printable import counted
from harness.core.types import FloatArray, IntArray
from harness.plugins.campaigns.effects.curves import Curve, curve_of
from harness.plugins.campaigns.effects.quantity_words import axis_name, name_in_words
from harness.plugins.campaigns.effects.sensitivity import (
    FEWEST_RUNS,
    FileSensitivity,
    evenly,
    sensitivities,
)
from harness.reporting.suite.columns import PASSED, Columns, VariedQuantity
from harness.reporting.suite.record import SuiteCase
from harness.reporting.suite.tables import one_run_lines

MOST_POINTS = 10_000  # on the map; of more, an even choice of the passed and of the failed

MOST_CAUSES = 10  # with a colour of their own; the rest is one group
MOST_HISTOGRAMS = 12  # of quantities on the page, the decisive ones first
BINS = 24  # of a histogram, about 10 pixels wide each
MOST_FILES = 5  # named above the map
WIDTH, HEIGHT = 260, 64  # [pixels]


@dataclass(frozen=True)
class Histogram:
    """The margins of an expectation in one unit.

    Attributes:
        text: What is drawn, in words.
        bars: Tone, place and height of each bar that is not empty [pixels].
        zero: Where the line at margin 0 stands [pixels].
        low: The lower end in words.
        high: The upper end in words, with its unit.
    """

    expectation: str
    text: str
    bars: Sequence[tuple[str, float, float]]
    zero: float
    low: str
    high: str
    width: int = WIDTH
    height: int = HEIGHT
    bar_width: float = WIDTH / BINS - 1


@dataclass(frozen=True)
class Campaign:
    """What the page shows of runs that vary.

    Attributes:
        map: What the script draws.
        count: How many runs are drawn, in words.
        remarks: What the histograms leave out, a sentence each.
        sensitivities: The files with enough runs.
        curves: File and path of a parameter -> how its runs depend on it.
        names: Path of a parameter -> its name in words, with its unit.
        one_run: A sentence for each file whose runs are all one and the same.
        too_few: The other files, in words; empty where there is none.
        fewest: The number of runs that are enough.
        has_files: Whether the runs are of several files.
    """

    map: Mapping[str, Any]
    count: str
    histograms: Sequence[Histogram]
    remarks: Sequence[str]
    sensitivities: Sequence[FileSensitivity]
    too_few: str
    has_files: bool
    curves: Mapping[tuple[str, str], Curve]
    names: Mapping[str, str]
    one_run: Sequence[str]
    fewest: int = FEWEST_RUNS


def campaign_of(columns: Columns, cases: Sequence[SuiteCase], folder: Path) -> Campaign | None:
    """Map, distribution of margins and sensitivities; None where too little varies.

    Args:
        folder: Where the page will stand; links are relative to it.
    """
    parameters = [each for each in columns.parameters if len(np.unique(each.numbers)) > 1]
    if len(columns.numbers) < FEWEST_RUNS or not parameters:
        return None
    found = list(sensitivities(columns))
    ranked = [effect.path for each in found for effect in each.effects if effect.share is not None]
    parameters.sort(
        key=lambda each: ranked.index(each.path) if each.path in ranked else len(ranked)
    )
    drawn, count = _map(columns, parameters, cases, folder)
    histograms, remarks = _margins(columns)
    few = [f"{each.file} ({each.runs})" for each in found if each.runs < FEWEST_RUNS]
    names = ", ".join(few[:MOST_FILES])
    names += f" and {len(few) - MOST_FILES} more files" if len(few) > MOST_FILES else ""
    shown = [each for each in found if each.effects]
    return Campaign(
        drawn, count, histograms, remarks, shown, names, len(columns.files) > 1,
        dict(_curves(columns, parameters, shown)),
        {each.path: axis_name(each) for each in parameters},
        list(one_run_lines(columns)),
    )  # fmt: skip


def _curves(
    columns: Columns, parameters: Sequence[VariedQuantity], found: Sequence[FileSensitivity]
) -> Iterator[tuple[tuple[str, str], Curve]]:
    """The curve of each parameter among the runs of each file."""
    files, is_good = np.array(columns.file_numbers), columns.is_good
    for each in found:
        chosen = np.flatnonzero(files == columns.files.index(each.file))
        shares = None if each.measured == "outcome" else np.array(columns.shares)
        causes = {effect.path: effect.causes for effect in each.effects}
        for parameter in parameters:
            runs = _without_other_causes(columns, chosen, causes.get(parameter.path, ()))
            curve = curve_of(parameter, runs, is_good, shares)
            if curve is not None:
                yield (each.file, parameter.path), curve


def _without_other_causes(columns: Columns, chosen: IntArray, causes: Sequence[str]) -> IntArray:
    """The runs that passed or failed for these causes; all of them where none is named."""
    if not causes:
        return chosen
    names = list(columns.causes)
    kept = [PASSED, *(names.index(cause) for cause in causes)]
    return chosen[np.isin(np.array(columns.groups)[chosen], kept)]


def _map(
    columns: Columns, parameters: Sequence[VariedQuantity], cases: Sequence[SuiteCase], folder: Path
) -> tuple[Mapping[str, Any], str]:
    """What the script draws, and how many runs that is."""
    runs = len(columns.numbers)
    failed, passed = (np.flatnonzero(which) for which in (~columns.is_good, columns.is_good))
    shown_failed = evenly(failed, MOST_POINTS // 2)
    shown_passed = evenly(passed, MOST_POINTS - len(shown_failed))
    shown: list[int] = np.union1d(shown_failed, shown_passed).tolist()
    names = list(columns.causes)
    causes = Counter(columns.groups[i] for i in failed)
    common = [group for group, _ in causes.most_common(MOST_CAUSES)]
    places = {group: place for place, group in enumerate(common)} | {PASSED: PASSED}
    data = {
        "parameters": [
            {"name": name_in_words(each), "unit": each.unit, "words": each.words}
            for each in parameters
        ],
        "causes": [names[group] for group in common],
        "weights": [
            len(passed) / max(1, len(shown_passed)),
            len(failed) / max(1, len(shown_failed)),
        ],
        "points": [
            [
                *(_short(each.numbers[i]) for each in parameters),
                _short(columns.shares[i]),
                places.get(columns.groups[i], len(common)),
                (case := cases[columns.numbers[i]]).result.case,
                case.link(folder),
            ]
            for i in shown
        ],
    }
    if len(shown) < runs:
        return data, f"{len(shown)} of {runs} runs are drawn, chosen evenly"
    return data, f"{runs} runs"


def _short(number: float) -> float | None:
    return float(f"{number:.5g}") if math.isfinite(number) else None


def _margins(columns: Columns) -> tuple[list[Histogram], list[str]]:
    """A histogram of the margins of each expectation and unit; those with failures first.

    Margins that do not vary say nothing, except those of failures.
    """
    found = {key: np.array(values) for key, values in columns.margins.items()}
    chosen = {key: each for key, each in found.items() if np.ptp(each) > 0 or each.min() < 0}
    failed = {key[0] for key, values in found.items() if values.min() < 0}
    failed |= columns.without_margin.keys()
    order = [expectation for expectation, _ in found]  # its units stand next to each other
    keys = sorted(chosen, key=lambda key: (key[0] not in failed, order.index(key[0])))
    more = len(keys) - MOST_HISTOGRAMS
    remarks = [f"{more} more expectations"] if more > 0 else []
    remarks += [
        f"{expectation}: {count} more failed without a margin"
        for expectation, count in columns.without_margin.most_common(MOST_HISTOGRAMS)
    ]
    return [_histogram(*key, chosen[key]) for key in keys[:MOST_HISTOGRAMS]], remarks


def _histogram(expectation: str, unit: str, values: FloatArray) -> Histogram:
    low, high = min(0.0, float(values.min())), max(0.0, float(values.max()))
    span = f"from {amount(values.min(), unit)} to {amount(values.max(), unit)}, median"
    if is_alike := bool(np.ptp(values) == 0):
        span = "all" if len(values) > 1 else "of"
    text = f"{counted(len(values), 'margin')}, {span} {amount(float(np.median(values)), unit)};"
    text += f" {int((values < 0).sum())} below zero"
    bars = [] if is_alike else list(_bars(values, low, high))
    zero = WIDTH * -low / (high - low)
    return Histogram(expectation, text, bars, zero, amount(low, unit), amount(high, unit))


def _bars(values: FloatArray, low: float, high: float) -> Iterator[tuple[str, float, float]]:
    counts, edges = np.histogram(values, bins=BINS, range=(low, high))
    tallest = int(counts.max())
    for index, count in enumerate(counts.tolist()):
        if count:
            tone = "bad" if edges[index] + edges[index + 1] < 0 else "good"
            yield tone, index * WIDTH / BINS, HEIGHT * count / tallest
