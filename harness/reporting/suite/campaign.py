"""The part of a suite's page about what varies: a map of the runs, margins, and sensitivities."""

from __future__ import annotations

import json
import math
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np

from harness.core.quantity import split_quantity
from harness.core.types import FloatArray
from harness.reporting.margins import margin_share, worst
from harness.reporting.suite.cause import cause_of
from harness.reporting.suite.record import SuiteCase

FEWEST_RUNS = 8
"""With fewer runs a table shows all there is to see."""

MOST_POINTS = 10_000
"""Runs that the map draws; of more, an even choice of the passed and of the failed ones."""

MOST_CAUSES = 10
MOST_HISTOGRAMS = 12
BINS = 24
SENSITIVITY_BINS = 8
WIDTH, HEIGHT = 260, 64  # [pixels]


@dataclass(frozen=True)
class Parameter:
    """A quantity that varies, as numbers.

    Attributes:
        path: Where it stands in the file.
        unit: The unit of the numbers.
        words: The values of a parameter whose values are no numbers; the numbers count them.
        numbers: A number for each run; NaN where the run does not have the parameter.
    """

    path: str
    unit: str
    words: tuple[str, ...]
    numbers: FloatArray


def campaign_html(cases: Sequence[SuiteCase], folder: Path) -> str:
    """Map, distribution of margins and sensitivities; empty where too little varies.

    Args:
        cases: The cases of the suite.
        folder: Where the page will stand; links are relative to it.
    """
    runs = [each for each in cases if each.values and each.result.outcome != "invalid"]
    parameters = [each for each in parameters_of(runs) if len(set(each.numbers.tolist())) > 1]
    if len(runs) < FEWEST_RUNS or not parameters:
        return ""
    return _map(runs, parameters, folder) + _margins(runs) + _sensitivities(runs, parameters)


def parameters_of(runs: Sequence[SuiteCase]) -> list[Parameter]:
    """Everything that varies in some run, in the order in which the runs name it."""
    paths = dict.fromkeys(path for each in runs for path in each.values)
    return [_parameter(path, [each.values.get(path) for each in runs]) for path in paths]


def _parameter(path: str, values: Sequence[Any]) -> Parameter:
    try:
        pairs = [None if value is None else split_quantity(value) for value in values]
    except ValueError:
        pairs = []
    units = {pair[1] for pair in pairs if pair is not None}
    if len(units) == 1:
        numbers = [math.nan if pair is None else pair[0] for pair in pairs]
        return Parameter(path, units.pop(), (), np.array(numbers))
    words = tuple(dict.fromkeys(str(value) for value in values if value is not None))
    places = {word: float(index) for index, word in enumerate(words)}
    numbers = [math.nan if value is None else places[str(value)] for value in values]
    return Parameter(path, "", words, np.array(numbers))


def _map(runs: Sequence[SuiteCase], parameters: Sequence[Parameter], folder: Path) -> str:
    failed = [index for index, each in enumerate(runs) if each.result.outcome != "passed"]
    passed = [index for index, each in enumerate(runs) if each.result.outcome == "passed"]
    shown_failed = _evenly(failed, MOST_POINTS // 2)
    shown_passed = _evenly(passed, MOST_POINTS - len(shown_failed))
    shown = sorted([*shown_failed, *shown_passed])
    causes = Counter(cause.group for i in failed if (cause := cause_of(runs[i].result)))
    names = [group for group, _ in causes.most_common(MOST_CAUSES)]
    data = {
        "parameters": [
            {"name": each.path, "unit": each.unit, "words": each.words} for each in parameters
        ],
        "causes": names,
        "weights": [
            len(passed) / max(1, len(shown_passed)),
            len(failed) / max(1, len(shown_failed)),
        ],
        "points": [_point(i, runs[i], parameters, names, folder) for i in shown],
    }
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":")).replace("<", "\\u003c")
    number = f"{len(runs)} runs"
    if len(shown) < len(runs):
        number = f"{len(shown)} of {len(runs)} runs are drawn, chosen evenly"
    return (
        '<section class="panel" id="map" hidden><h2>Map of the runs'
        f' <span class="key">{number} · click a run to open it</span></h2>'
        '<div class="axes"><label>Across <select name="x"></select></label>'
        '<label>Up <select name="y"></select></label>'
        '<label>Show <select name="kind"><option value="runs">runs</option>'
        '<option value="rate">failure rate</option></select></label>'
        '<output aria-live="polite"></output></div>'
        '<canvas role="img" aria-label="Runs over two parameters; the table of cases has the same'
        ' data" tabindex="0"></canvas><div class="legend"></div>'
        f'<script type="application/json">{text}</script></section>'
    )


def _evenly(indices: Sequence[int], most: int) -> list[int]:
    """At most so many of the indices, at even distances."""
    if len(indices) <= most:
        return list(indices)
    return [indices[index * len(indices) // most] for index in range(most)]


def _point(
    index: int,
    run: SuiteCase,
    parameters: Sequence[Parameter],
    causes: Sequence[str],
    folder: Path,
) -> list[object]:
    """Numbers of the parameters, share of the margin, cause (-1: passed), name and link."""
    cause = cause_of(run.result)
    group = -1 if cause is None else len(causes)
    if cause is not None and cause.group in causes:
        group = causes.index(cause.group)
    target = run.result.page or run.result.report_dir
    link = ""
    if target:
        path = Path(os.path.relpath(Path(target).resolve(), folder.resolve())).as_posix()
        link = quote(path)
    numbers = [_short(each.numbers[index]) for each in parameters]
    return [*numbers, _short(_share(run)), group, run.result.case, link]


def _share(run: SuiteCase) -> float:
    nearest = worst(run.result.verdicts)
    return math.nan if nearest is None else margin_share(nearest)


def _short(number: float) -> float | None:
    return float(f"{number:.5g}") if math.isfinite(number) else None


def _margins(runs: Sequence[SuiteCase]) -> str:
    """A histogram of the margins of each expectation; those with failures first."""
    found: dict[tuple[str, str], list[float]] = {}
    for run in runs:
        for verdict in run.result.verdicts:
            if math.isfinite(verdict.margin):
                key = verdict.expectation, verdict.unit
                found.setdefault(key, []).append(verdict.margin)
    varying = [(key, values) for key, values in found.items() if max(values) > min(values)]
    varying.sort(key=lambda each: min(each[1]) >= 0)
    if not varying:
        return ""
    blocks = "".join(
        _histogram(*key, np.array(values)) for key, values in varying[:MOST_HISTOGRAMS]
    )
    more = len(varying) - MOST_HISTOGRAMS
    rest = f'<p class="quiet">{more} more expectations</p>' if more > 0 else ""
    return (
        '<section class="panel"><h2>Margins <span class="key">left of the line: failed</span></h2>'
        f'<div class="margins">{blocks}{rest}</div></section>'
    )


def _histogram(expectation: str, unit: str, values: FloatArray) -> str:
    low, high = min(0.0, float(values.min())), max(0.0, float(values.max()))
    counts, edges = np.histogram(values, bins=BINS, range=(low, high))
    step, tallest = WIDTH / BINS, int(counts.max())
    bars = "".join(
        f'<rect class="{"bad" if (edges[i] + edges[i + 1]) / 2 < 0 else "good"}" x="{i * step:.1f}"'
        f' y="{HEIGHT - HEIGHT * count / tallest:.1f}" width="{step - 1:.1f}"'
        f' height="{HEIGHT * count / tallest:.1f}"/>'
        for i, count in enumerate(counts.tolist())
        if count
    )
    zero = WIDTH * -low / (high - low)
    suffix = "" if unit == "1" else f" {escape(unit)}"
    failed = int((values < 0).sum())
    said = (
        f"{len(values)} margins from {values.min():.3g} to {values.max():.3g}{suffix}, median"
        f" {np.median(values):.3g}{suffix}; {failed} below zero"
    )
    return (
        f'<figure><figcaption>{escape(expectation)}<div class="quiet">{said}</div></figcaption>'
        f'<svg class="histogram" preserveAspectRatio="none" role="img" aria-label="{said}"'
        f' viewBox="-1 -2 {WIDTH + 2} {HEIGHT + 3}">{bars}'
        f'<line x1="{zero:.1f}" x2="{zero:.1f}" y1="-2" y2="{HEIGHT}"/></svg>'
        f'<div class="ends"><span>{low:.3g}</span><span>{high:.3g}{suffix}</span></div></figure>'
    )


def _sensitivities(runs: Sequence[SuiteCase], parameters: Sequence[Parameter]) -> str:
    shares = sensitivities(runs, parameters)
    rows = "".join(
        f'<li><span>{escape(path)}</span><span class="bar" role="img" aria-label="{share:.0%}">'
        f'<i class="effect" style="width:{100 * share:.1f}%"></i></span>'
        f'<span class="number">{share:.0%}</span></li>'
        for path, share in sorted(shares.items(), key=lambda item: -item[1])
    )
    return (
        '<section class="panel"><h2>Sensitivity <span class="key">share of the worst margin&#x27;s'
        " variance that each parameter explains alone</span></h2>"
        f'<ol class="effects">{rows}</ol></section>'
    )


def sensitivities(
    runs: Sequence[SuiteCase], parameters: Sequence[Parameter]
) -> Mapping[str, float]:
    """How much of the variance of the worst margin each parameter explains alone, from 0 to 1.

    The runs are divided into groups of equal size by the parameter; the share is epsilon squared
    [1], the variance between the groups without what chance puts there. Where margins do not vary,
    outcomes are used.

    References:
        [1] T. L. Kelley, "An Unbiased Correlation Ratio Measure", Proceedings of the National
            Academy of Sciences 21(9), 1935.
    """
    measured = np.array([_share(each) for each in runs])
    if len(set(measured[np.isfinite(measured)].tolist())) < 2:
        measured = np.array([float(each.result.outcome == "passed") for each in runs])
    return {each.path: _explained(each, measured) for each in parameters}


def _explained(parameter: Parameter, measured: FloatArray) -> float:
    known = np.isfinite(parameter.numbers) & np.isfinite(measured)
    numbers, values = parameter.numbers[known], measured[known]
    distinct = np.unique(numbers)
    if len(values) < FEWEST_RUNS or len(distinct) < 2 or not np.var(values):
        return 0.0
    if len(distinct) <= SENSITIVITY_BINS:
        groups = [values[numbers == each] for each in distinct]
    else:
        count = min(SENSITIVITY_BINS, len(values) // 4)
        groups = np.array_split(values[np.argsort(numbers, kind="stable")], count)
    within = sum(float(((group - group.mean()) ** 2).sum()) for group in groups)
    total = float(((values - values.mean()) ** 2).sum())
    freedom = (len(values) - 1) / max(1, len(values) - len(groups))
    return max(0.0, 1 - within / total * freedom)
