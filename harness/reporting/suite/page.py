"""The page of a suite: every row is plain HTML, which a script filters, sorts and groups."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from string import Template
from urllib.parse import quote

from harness.recording.verdict import Verdict
from harness.reporting.html import bundle
from harness.reporting.html.bundle import content_policy
from harness.reporting.margins import allowance_used
from harness.reporting.result import CaseResult
from harness.reporting.sampled import SampledRate, missed, rate_text, short_value
from harness.reporting.shared_work import shared_words
from harness.reporting.suite.campaign import campaign_html
from harness.reporting.suite.columns import Columns
from harness.reporting.suite.history import Key
from harness.reporting.suite.record import SuiteCase, SuiteRecord
from harness.reporting.suite.tables import table_lines
from harness.reporting.terminal import OUTCOMES, Style, failure_place

FOLDER = Path(__file__).with_name("page")
SIGNS = Style(has_signs=True)
MOST_ROWS = 2000
REFRESH = '<meta http-equiv="refresh" content="5">'
"""Loads the page of a running suite again."""

HISTORY_HEAD = '<th scope="col" class="history">Worst margin over runs</th>'
SPARK_WIDTH, SPARK_HEIGHT = 90, 20  # [pixels]


def suite_html(
    record: SuiteRecord,
    columns: Columns,
    folder: Path,
    history: Mapping[Key, Sequence[float | None]] | None = None,
) -> str:
    """One self-contained page; links to the cases' pages are relative to its folder.

    Args:
        columns: What varies in its cases, with at most `MOST_ROWS` listed.
        folder: Where the page will stand.
    """
    total, passed = len(record.cases), columns.outcomes["passed"]
    rows = [_row(i, record.cases[i], folder, history) for i in columns.listed]
    skeleton, script = _read("suite.html"), _read("suite.js") + _read("campaign.js")
    style = bundle.theme() + _read("suite.css")
    return Template(skeleton).substitute(
        policy=content_policy(skeleton, script=script, style=style),
        title="; ".join(filter(None, (f"{passed} of {total} passed", missed(record.rates)))),
        style=style,
        script=script,
        refresh=REFRESH if record.progress else "",
        pill="good" if record.outcome == "passed" else "bad",
        outcome=escape(f"running: {record.progress}" if record.progress else record.outcome),
        interrupted="".join(
            f" · {escape(each)}"
            for each in (*["interrupted"][: record.is_interrupted], *record.missing_parts)
        ),
        outcomes=_outcomes(columns),
        causes=_causes(columns),
        rates=_rates(record.rates),
        campaign=_shared(columns) + campaign_html(columns, record.cases, folder),
        table=_varied(columns),
        unlisted=_unlisted(total - len(rows)),
        rows="\n".join(rows),
        history=HISTORY_HEAD if history else "",
    )


def _unlisted(count: int) -> str:
    if not count:
        return ""
    return (
        f'<p class="quiet unlisted">{count} more cases are not listed: failures come first, then'
        " what is nearest to failing. <code>harness results DIR</code> queries all of them.</p>"
    )


def _outcomes(columns: Columns) -> str:
    counts = columns.outcomes
    return "".join(
        f'<button type="button" data-outcome="{name}" aria-pressed="false">'
        f'<i class="sign {name}"></i>{counts[name]} {name}</button>'
        for name in reversed(OUTCOMES)
        if counts[name]
    )


def _causes(columns: Columns) -> str:
    found = columns.causes
    if not found:
        return ""
    lines = "".join(
        f'<li><button type="button" data-cause="{escape(group)}" aria-pressed="false">'
        f"<b>{count}</b> {escape(group)}</button></li>"
        for group, count in found.most_common()
    )
    return f'<section class="panel" id="causes"><h2>Causes</h2><ol>{lines}</ol></section>'


def _rates(rates: Sequence[SampledRate]) -> str:
    """A row each, those that are not confirmed first."""
    if not rates:
        return ""
    rows = "".join(_rate(each) for each in sorted(rates, key=lambda each: each.outcome == "passed"))
    return (
        '<section class="panel"><h2>Success rates of samples <span class="key">bar: interval'
        " · stroke: measured · blue: required</span></h2>"
        f'<div class="rates">{rows}</div></section>'
    )


def _rate(sampled: SampledRate) -> str:
    rate, name = sampled.rate, f"{sampled.file} {sampled.group}".strip()
    share = rate.passed / rate.total if rate.total else 0.0
    required = "" if rate.at_least is None else (
        f'<i class="required" style="left:{100 * rate.at_least:.2f}%"></i>'
    )  # fmt: skip
    said = rate_text("", rate).partition(": ")[2]
    group = f' <span class="tag">{escape(sampled.group)}</span>' if sampled.group else ""
    return (
        f'<button type="button" class="rate {sampled.outcome}" data-rate="{escape(name.lower())}"'
        f' title="Show its samples"><i class="sign {sampled.outcome}"></i>'
        f'<span class="interval" aria-hidden="true">'
        f'<i class="reach" style="left:{100 * rate.low:.2f}%;'
        f'width:{100 * (rate.high - rate.low):.2f}%"></i>'
        f'<i class="share" style="left:{100 * share:.2f}%"></i>{required}</span>'
        f"<span><b>{escape(Path(sampled.file).name)}</b>{group}"
        f'<span class="quiet"> {escape(said)}</span></span></button>'
    )


def _varied(columns: Columns) -> str:
    """A block for each quantity that varies; they flow side by side."""
    blocks: list[str] = []
    for line in table_lines(columns, SIGNS):
        if line.startswith(" "):
            blocks[-1] += f"\n{escape(line)}"
        else:
            blocks.append(escape(line))
    if not blocks:
        return ""
    inner = "".join(f"<pre>{block}</pre>" for block in blocks)
    heading = "<h2>By what varies</h2>"
    return f'<section class="panel">{heading}<div class="varied">{inner}</div></section>'


def _row(
    index: int, case: SuiteCase, folder: Path, history: Mapping[Key, Sequence[float | None]] | None
) -> str:
    result = case.result
    nearest, cause, share = case.nearest, case.cause, case.share
    name = escape(f"{result.title} [{result.case}]" if result.case else result.title)
    link = _link(result, folder)
    title = f'<a href="{escape(link)}">{name}</a>' if link else name
    words = " ".join((result.title, result.case, result.file, *case.tags, *case.verifies))
    tags = "".join(f'<span class="tag">{escape(each)}</span>' for each in case.tags)
    said = cause.said if cause else ""
    line = ""
    if history:
        earlier = history.get((result.file, result.case), ())
        line = _sparkline([*earlier, None if nearest is None else share])
        line = f'<td class="history">{line}</td>'
    return (
        f'<tr data-index="{index}" data-outcome="{result.outcome}"'
        f' data-cause="{escape(cause.group) if cause else ""}"'
        f' data-share="{share if math.isfinite(share) else 9}"'
        f' data-name="{escape(result.title.lower())}" data-time="{result.sim_time:.3f}"'
        f' data-words="{escape(f"{words} {said}".lower())}">'
        f'<td><i class="sign {result.outcome}"></i><span class="quiet">{result.outcome}</span></td>'
        f'<td>{title}{tags}<div class="quiet">{escape(result.file)}{_drawn(case)}'
        f"{_taken(result)}</div>"
        f'<div class="why">{escape(said)}</div></td>'
        f"<td>{_margin(nearest)}</td>"
        f'{line}<td class="number">{result.sim_time:.1f} s</td>'
        f'<td class="number">{result.seed}</td>'
        f'<td class="number">{escape(result.digest[:12])}</td></tr>'
    )


def _shared(columns: Columns) -> str:
    """What the cases took from each other; empty where they took nothing."""
    sentence = columns.shared.sentence()
    return f'<p class="quiet">{escape(sentence)}</p>' if sentence else ""


def _taken(result: CaseResult) -> str:
    """What a case took from others."""
    words = shared_words(result.shared)
    return f" · from other cases: {escape(words)}" if words else ""


def _drawn(case: SuiteCase) -> str:
    """What varies in a case, with the values that it has."""
    values = ", ".join(f"{path} {short_value(value)}" for path, value in case.values.items())
    return f' <span class="drawn">{escape(values)}</span>' if values else ""


def _margin(nearest: Verdict | None) -> str:
    """The worst margin, and as on the page of a run how much of the allowance was used."""
    if nearest is None:
        return ""
    kind = "good" if nearest.status == "passed" else "bad"
    unit = "" if nearest.unit == "1" else f" {nearest.unit}"
    used = allowance_used(nearest.measures[0]) if nearest.measures else None
    bar = "" if used is None else (
        f'<span class="bar" role="img" aria-label="{100 * used:.0f} % of the allowance used"'
        f' title="{100 * used:.0f} % of the allowance used"><i class="{kind}" style="width:'
        f'{min(100.0, max(2.0, 100 * used)):.1f}%"></i></span>'
    )  # fmt: skip
    return (
        f'{bar}<span class="number">{nearest.margin:.4g}{escape(unit)}</span>'
        f'<div class="quiet">{escape(nearest.expectation)}</div>'
    )


def _sparkline(shares: Sequence[float | None]) -> str:
    """Worst margins over runs as a small line; the middle is where an expectation flips.

    Heights are square roots: what happens near the middle is what matters.
    """
    known = [(index, share) for index, share in enumerate(shares) if share is not None]
    if len(known) < 2:
        return ""
    step = SPARK_WIDTH / (len(shares) - 1)
    points = " ".join(
        f"{index * step:.1f},{SPARK_HEIGHT * (1 - _root(share)) / 2:.1f}" for index, share in known
    )
    said = f"worst margin in {len(known)} runs, now {known[-1][1]:.0%} of its limit"
    middle = SPARK_HEIGHT / 2
    return (
        f'<svg class="spark" role="img" aria-label="{said}" viewBox="-2 -2 {SPARK_WIDTH + 4} '
        f'{SPARK_HEIGHT + 4}" width="{SPARK_WIDTH}" height="{SPARK_HEIGHT}"><title>{said}</title>'
        f'<line x1="0" x2="{SPARK_WIDTH}" y1="{middle}" y2="{middle}"/>'
        f'<polyline points="{points}"/></svg>'
    )


def _root(share: float) -> float:
    return math.copysign(math.sqrt(abs(share)), share)


def _link(result: CaseResult, folder: Path) -> str:
    """The case's page at its first failure, from the suite's page; its folder where it has none."""
    target = result.page or result.report_dir
    if not target:
        return ""
    path = Path(os.path.relpath(Path(target).resolve(), folder.resolve())).as_posix()
    return f"{quote(path)}{failure_place(result) if result.page else ''}"


def _read(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8")
