"""A result as Jupyter shows it: outcome, verdicts, picture, and the address of its page."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from pathlib import Path

from harness.recording.verdict import Verdict
from harness.reporting.html import bundle
from harness.reporting.result import CaseResult
from harness.reporting.suite.failure_picture import deciding_picture
from harness.reporting.terminal import causes, failure_place, verdict_line

FOLDER = bundle.FOLDER.with_name("notebook")
WIDTH = 320  # [pixels]


def result_html(result: CaseResult) -> str:
    """A fragment of HTML; every text of the run stays text."""
    picture = deciding_picture(result, WIDTH)
    address = Path(result.page).resolve().as_uri() + failure_place(result) if result.page else ""
    return (
        bundle.templates(FOLDER)
        .get_template("result.html")
        .render(
            result=result,
            picture=base64.b64encode(picture).decode() if picture else "",
            table=verdict_table(result.verdicts),
            causes=causes(result) if result.outcome != "passed" else [],
            address=address,
        )
    )


def verdict_table(verdicts: Sequence[Verdict]) -> str:
    """A table of verdicts, those that do not hold first."""
    rows = sorted(verdicts, key=lambda verdict: verdict.status == "passed")
    template = bundle.templates(FOLDER).get_template("verdicts.html")
    return template.render(rows=[(each, verdict_line(each)) for each in rows])
