"""A result as Jupyter shows it: outcome, verdicts, picture, and the address of its page."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from html import escape
from pathlib import Path

from harness.recording.verdict import Verdict
from harness.reporting.result import CaseResult
from harness.reporting.suite.failure_picture import deciding_picture
from harness.reporting.terminal import causes, failure_place, verdict_line

WIDTH = 320  # [pixels]
COLUMNS = "display:flex;flex-wrap:wrap;gap:8px 16px;align-items:flex-start"
PILL = "padding:2px 10px;border-radius:99px;color:#fff"
COLORS = {True: "#1a7f37", False: "#cf222e"}  # read on light and on dark pages


def result_html(result: CaseResult) -> str:
    """A fragment of HTML; every text of the run stays text."""
    color = COLORS[result.outcome == "passed"]
    parts = [
        f'<p><b style="{PILL};background:{color}">{escape(result.outcome)}</b>'
        f" <b>{escape(result.name)}</b> \N{MIDDLE DOT} {result.sim_time:.1f} s simulated</p>"
    ]
    columns: list[str] = []
    if picture := deciding_picture(result, WIDTH):
        shown = base64.b64encode(picture).decode()
        columns.append(f'<img alt="{escape(result.name)}" src="data:image/webp;base64,{shown}">')
    if result.verdicts:
        columns.append(verdict_table(result.verdicts))
    parts.append(f'<div style="{COLUMNS}">{"".join(columns)}</div>')
    if result.outcome != "passed":
        found = escape("\n".join(causes(result)))
        is_open = " open" if any(step.status == "failed" for step in result.steps) else ""
        summary = "everything that was found"
        parts.append(
            f'<details{is_open}><summary style="cursor:pointer">{summary}</summary>'
            f'<pre style="white-space:pre-wrap">{found}</pre></details>'
        )
    if result.page:
        address = Path(result.page).resolve().as_uri() + failure_place(result)
        name = escape(result.page)
        parts.append(f'<p><a href="{escape(address)}" title="{name}">open the replay</a></p>')
    return "".join(parts)


def verdict_table(verdicts: Sequence[Verdict]) -> str:
    """A table of verdicts, those that do not hold first."""
    rows = "".join(
        f'<tr><td style="color:{COLORS[each.status == "passed"]}">{escape(each.status)}</td>'
        f'<td style="text-align:left">{escape(each.expectation)}</td>'
        f'<td style="text-align:left">{escape(verdict_line(each))}</td></tr>'
        for each in sorted(verdicts, key=lambda verdict: verdict.status == "passed")
    )
    return f'<table style="flex:1 1 320px;margin:0">{rows}</table>'
