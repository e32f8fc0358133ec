"""The part of a suite's page about what varies: a map of the runs, margins, and sensitivities."""

from __future__ import annotations

import json
import math
import os
from collections import Counter
from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path
from urllib.parse import quote

import numpy as np

from harness.core.types import FloatArray
from harness.reporting.suite.columns import PASSED, Columns, VariedQuantity
from harness.reporting.suite.record import SuiteCase
from harness.reporting.suite.sensitivity import FEWEST_RUNS, FileSensitivity, sensitivities

MOST_POINTS = 10_000
"""Runs that the map draws; of more, an even choice of the passed and of the failed ones."""

MOST_CAUSES = 10
MOST_HISTOGRAMS = 12
BINS = 24
MOST_FILES = 5
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
    return drawn + _margins(columns) + _sensitivities(columns)


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
    """A histogram of the margins of each expectation and unit; those with failures first.

    Margins that do not vary say nothing, except those of failures.
    """
    found = {key: np.array(values) for key, values in columns.margins.items()}
    chosen = {key: each for key, each in found.items() if np.ptp(each) > 0 or each.min() < 0}
    failed = {key[0] for key, values in found.items() if values.min() < 0}
    failed |= columns.without_margin.keys()
    keys = sorted(chosen, key=lambda key: (key[0] not in failed, _first(found, key[0])))
    blocks = "".join(_histogram(*key, chosen[key]) for key in keys[:MOST_HISTOGRAMS])
    more = len(keys) - MOST_HISTOGRAMS
    rest = f'<p class="quiet">{more} more expectations</p>' if more > 0 else ""
    rest += "".join(
        f'<p class="quiet">{escape(expectation)}: {count} more failed without a margin</p>'
        for expectation, count in columns.without_margin.most_common(MOST_HISTOGRAMS)
    )
    if not blocks and not rest:
        return ""
    return (
        '<section class="panel"><h2>Margins <span class="key">left of the line: failed</span></h2>'
        f'<div class="margins">{blocks}{rest}</div></section>'
    )


def _first(keys: Iterable[tuple[str, str]], expectation: str) -> int:
    """The place of an expectation, so that its units stand next to each other."""
    return next(place for place, key in enumerate(keys) if key[0] == expectation)


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


def _sensitivities(columns: Columns) -> str:
    files = [each for each in sensitivities(columns) if each.runs < FEWEST_RUNS or each.effects]
    blocks = "".join(_effects(each, len(columns.files)) for each in files if each.effects)
    few = [f"{each.file} ({each.runs})" for each in files if not each.effects]
    if few:
        names = ", ".join(few[:MOST_FILES])
        names += f" and {len(few) - MOST_FILES} more files" if len(few) > MOST_FILES else ""
        blocks += (
            f'<p class="quiet">Too few runs, fewer than {FEWEST_RUNS} of a file: {escape(names)}'
            "</p>"
        )
    return (
        '<section class="panel"><h2>Sensitivity <span class="key">share of the variance that each'
        " parameter explains alone, among the runs of a file</span></h2>"
        f'<div class="effects">{blocks}</div></section>'
    )


def _effects(sensitivity: FileSensitivity, files: int) -> str:
    """The effects in one file; its name is shown where there are several."""
    name = f"<b>{escape(sensitivity.file)}</b> " if files > 1 else ""
    rows = "".join(
        f'<li><span>{escape(each.path)}</span><span class="quiet unknown">{escape(each.reason)}'
        "</span></li>"
        if each.share is None
        else f'<li><span>{escape(each.path)}</span><span class="bar" role="img" aria-label='
        f'"{each.share:.0%}"><i class="effect" style="width:{100 * each.share:.1f}%"></i></span>'
        f'<span class="number">{each.share:.0%}</span></li>'
        for each in sensitivity.effects
    )
    said = f"variance of the {sensitivity.measured} in {sensitivity.runs} runs"
    return f'<div>{name}<span class="quiet">{said}</span></div><ol>{rows}</ol>'
