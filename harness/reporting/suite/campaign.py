"""The part of a suite's page about what varies: a map of the runs, margins, and sensitivities."""

from __future__ import annotations

import json
import math
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from urllib.parse import quote

import numpy as np

from harness.core.types import FloatArray
from harness.reporting.suite.columns import PASSED, Columns, VariedQuantity
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


def campaign_html(columns: Columns, cases: Sequence[SuiteCase], folder: Path) -> str:
    """Map, distribution of margins and sensitivities; empty where too little varies.

    Args:
        folder: Where the page will stand; links are relative to it.
    """
    parameters = [each for each in columns.parameters if each.is_varying]
    if len(columns.numbers) < FEWEST_RUNS or not parameters:
        return ""
    drawn = _map(columns, parameters, cases, folder)
    return drawn + _margins(columns) + _sensitivities(columns, parameters)


def _map(
    columns: Columns, parameters: Sequence[VariedQuantity], cases: Sequence[SuiteCase], folder: Path
) -> str:
    runs = len(columns.numbers)
    failed, passed = (
        np.flatnonzero(which).tolist() for which in (~columns.is_good, columns.is_good)
    )
    shown_failed = _evenly(failed, MOST_POINTS // 2)
    shown_passed = _evenly(passed, MOST_POINTS - len(shown_failed))
    shown = sorted([*shown_failed, *shown_passed])
    names = list(columns.causes)
    causes = Counter(columns.groups[i] for i in failed)
    common = [group for group, _ in causes.most_common(MOST_CAUSES)]
    places = {group: place for place, group in enumerate(common)} | {PASSED: PASSED}
    data = {
        "parameters": [
            {"name": each.path, "unit": each.unit, "words": each.words} for each in parameters
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
                *_name_and_link(cases[columns.numbers[i]], folder),
            ]
            for i in shown
        ],
    }
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":")).replace("<", "\\u003c")
    number = f"{runs} runs"
    if len(shown) < runs:
        number = f"{len(shown)} of {runs} runs are drawn, chosen evenly"
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


def _name_and_link(case: SuiteCase, folder: Path) -> tuple[str, str]:
    target = case.result.page or case.result.report_dir
    if not target:
        return case.result.case, ""
    path = Path(os.path.relpath(Path(target).resolve(), folder.resolve())).as_posix()
    return case.result.case, quote(path)


def _short(number: float) -> float | None:
    return float(f"{number:.5g}") if math.isfinite(number) else None


def _margins(columns: Columns) -> str:
    """A histogram of the margins of each expectation; those with failures first."""
    found = ((key, np.array(values)) for key, values in columns.margins.items())
    varying = [(key, values) for key, values in found if np.ptp(values) > 0]
    varying.sort(key=lambda each: each[1].min() >= 0)
    if not varying:
        return ""
    blocks = "".join(_histogram(*key, values) for key, values in varying[:MOST_HISTOGRAMS])
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


def _sensitivities(columns: Columns, parameters: Sequence[VariedQuantity]) -> str:
    shares = sensitivities(columns, parameters)
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


def sensitivities(columns: Columns, parameters: Sequence[VariedQuantity]) -> Mapping[str, float]:
    """How much of the variance of the worst margin each parameter explains alone, from 0 to 1.

    The runs are divided into groups of equal size by the parameter; the share is epsilon squared
    [1], the variance between the groups without what chance puts there. Where margins do not vary,
    outcomes are used.

    References:
        [1] T. L. Kelley, "An Unbiased Correlation Ratio Measure", Proceedings of the National
            Academy of Sciences 21(9), 1935.
    """
    measured = np.array(columns.shares)
    if len(np.unique(measured[np.isfinite(measured)])) < 2:
        measured = columns.is_good.astype(float)
    return {each.path: _explained(each, measured) for each in parameters}


def _explained(parameter: VariedQuantity, measured: FloatArray) -> float:
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
