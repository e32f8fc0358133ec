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
COLORS = {True: "#1a7f37", False: "#cf222e"}  # read on light and on dark pages


def result_html(result: CaseResult) -> str:
    """A fragment of HTML; every text of the run stays text."""
    parts = [
        f'<p><b style="color:{COLORS[result.outcome == "passed"]}">{escape(result.outcome)}</b>'
        f" {escape(result.name)} \N{MIDDLE DOT} {result.sim_time:.1f} s simulated</p>"
    ]
    if picture := deciding_picture(result, WIDTH):
        shown = base64.b64encode(picture).decode()
        parts.append(f'<img alt="{escape(result.name)}" src="data:image/webp;base64,{shown}">')
    if result.verdicts:
        parts.append(verdict_table(result.verdicts))
    if result.outcome != "passed":
        parts.append(
            f'<pre style="white-space:pre-wrap">{escape(chr(10).join(causes(result)))}</pre>'
        )
    if result.page:
        address = Path(result.page).resolve().as_uri() + failure_place(result)
        parts.append(f'<p><a href="{escape(address)}">{escape(result.page)}</a></p>')
    return "".join(parts)


def verdict_table(verdicts: Sequence[Verdict]) -> str:
    """A table of verdicts, those that do not hold first."""
    rows = "".join(
        f'<tr><td style="color:{COLORS[each.status == "passed"]}">{escape(each.status)}</td>'
        f'<td style="text-align:left">{escape(each.expectation)}</td>'
        f'<td style="text-align:left">{escape(verdict_line(each))}</td></tr>'
        for each in sorted(verdicts, key=lambda verdict: verdict.status == "passed")
    )
    return f"<table>{rows}</table>"
