"""The run in plain HTML: read where scripts are blocked, and printed."""

from __future__ import annotations

import base64
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape

from harness.recording.step_record import StepRecord
from harness.recording.stored_run import StoredRun
from harness.recording.verdict import Measure, Verdict
from harness.reporting.html.story import depth_of, environment, ordered_steps
from harness.reporting.margins import allowance_used
from harness.reporting.terminal import verdict_line

STATUS = {
    "passed": "passed",
    "expected error": "failed as expected",
    "failed": "failed",
    "not reached": "not reached",
}


@dataclass(frozen=True)
class SummaryPicture:
    """A small picture of a step's end.

    Attributes:
        data: A WebP file's bytes.
    """

    caption: str
    data: bytes


def summary_html(stored: StoredRun, pictures: Sequence[SummaryPicture]) -> str:
    """Verdict, facts, pictures, expectations, steps, findings; no script, nothing fetched."""
    run = stored.run
    return "\n".join(
        [
            '<section id="summary" aria-label="Summary">',
            f"<h1>{outcome_pill(stored)} {escape(run.scenario)}</h1>",
            _facts(stored),
            _early_end(stored),
            _pictures(pictures),
            '<div id="paper-plots"></div>',
            _verdicts(stored),
            _steps(stored),
            _findings(stored),
            _environment(stored),
            "</section>",
        ]
    )


def outcome_pill(stored: StoredRun) -> str:
    """The outcome as a coloured word."""
    tone = "good" if stored.outcome == "passed" else "bad"
    return f'<span class="pill {tone}">{escape(stored.outcome.upper())}</span>'


def header_facts(stored: StoredRun) -> list[tuple[str, str]]:
    """What stands next to the title."""
    run = stored.run
    return [
        ("robot", run.robot.name),
        ("seed", str(run.seed)),
        ("simulated", f"{float(run.signals.times[-1]):.1f} s"),
        ("physics", f"MuJoCo {run.versions['mujoco']}" if "mujoco" in run.versions else ""),
        ("digest", stored.digest[:12]),
        ("file", run.file),
        ("case", run.case),
    ]


def _facts(stored: StoredRun) -> str:
    held = sum(verdict.status == "passed" for verdict in stored.verdicts)
    said = f"{held} of {len(stored.verdicts)}" if stored.verdicts else "none is stated"
    facts = [*header_facts(stored), ("expectations that hold", said)]
    cells = "".join(
        f"<span>{escape(name)} <b>{escape(value)}</b></span> " for name, value in facts if value
    )
    return f'<p class="facts">{cells}</p>'


def _early_end(stored: StoredRun) -> str:
    if not stored.run.ended_early:
        return ""
    return f'<p class="why">The run ended early: {escape(stored.run.ended_early)}</p>'


def _pictures(pictures: Sequence[SummaryPicture]) -> str:
    figures = [
        f'<figure><img alt="" src="data:image/webp;base64,{base64.b64encode(each.data).decode()}">'
        f"<figcaption>{escape(each.caption)}</figcaption></figure>"
        for each in pictures
    ]
    return f'<div class="pictures">{"".join(figures)}</div>' if figures else ""


def _verdicts(stored: StoredRun) -> str:
    source = stored.run.source.splitlines()

    def said(verdict: Verdict) -> str:
        """The line of the file that does not hold."""
        is_known = verdict.status != "passed" and 0 < verdict.line <= len(source)
        line = f"<code>{escape(source[verdict.line - 1].strip())}</code>" if is_known else ""
        return line + "".join(f"<p>warning: {escape(str(each))}</p>" for each in verdict.warnings)

    rows = [
        _row(
            "good" if verdict.status == "passed" else "bad",
            str(number), verdict.expectation, verdict_line(verdict), _used(verdict.measures[:1]),
            str(verdict.line or ""), below=said(verdict),
        )
        for number, verdict in enumerate(stored.verdicts, start=1)
    ]  # fmt: skip
    head = ("", "expectation", "verdict", "used", "line")
    return _table("Expectations", head, rows) if rows else ""


def _used(measures: Iterable[Measure]) -> str:
    shares = [allowance_used(measure) for measure in measures]
    return "".join(f"{100 * share:.0f} %" for share in shares if share is not None and share < 100)


def _steps(stored: StoredRun) -> str:
    run = stored.run

    def step_text(step: StepRecord) -> str:
        why = "" if step.status == "passed" else step.message
        code = "" if why.startswith(step.error_code) else step.error_code
        return ": ".join(part for part in (code, why) if part)

    rows = [
        _row(
            {"failed": "bad", "not reached": "open"}.get(step.status, "good"),
            str(number), "\u2003" * depth_of(step, run) + step.summary, STATUS[step.status],
            _duration(step), str(step.line or ""), step_text(step),
        )
        for number, step in enumerate(ordered_steps(run), start=1)
    ]  # fmt: skip
    return _table("Steps", ("", "step", "status", "took", "line", ""), rows)


def _duration(step: StepRecord) -> str:
    took = step.end_time - step.start_time
    return f"{took:.2f} s" if step.status != "not reached" and math.isfinite(took) else ""


def _findings(stored: StoredRun) -> str:
    rows = [
        _row("open", finding.kind.replace("_", " "), finding.message,
             f"{finding.time:.2f} s" if math.isfinite(finding.time) else "")
        for finding in stored.run.findings
    ]  # fmt: skip
    return _table("Findings", ("", "", "time"), rows) if rows else ""


def _environment(stored: StoredRun) -> str:
    rows = [_row("", name, value) for name, value in environment(stored)]
    return _table("Environment", ("", ""), rows)


def _table(title: str, head: Sequence[str], rows: Sequence[str]) -> str:
    cells = "".join(f'<th scope="col">{escape(name)}</th>' for name in head)
    return (
        f'<table class="summary-{title.lower()}"><caption>{title}</caption>'
        f"<thead><tr>{cells}</tr></thead><tbody>{''.join(rows)}</tbody></table>"
    )


def _row(tone: str, *cells: str, below: str = "") -> str:
    """A row of texts, and perhaps one of markup below it."""
    row = f'<tr class="{tone}">{"".join(f"<td>{escape(cell)}</td>" for cell in cells)}</tr>'
    more = f'<tr class="{tone}"><td></td><td colspan="{len(cells) - 1}">{below}</td></tr>'
    return f"{row}{more}" if below else row
