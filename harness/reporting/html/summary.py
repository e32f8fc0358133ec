"""The run in plain HTML: what `page/summary.html` shows where scripts are blocked, and in print."""

from __future__ import annotations

import base64
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from harness.recording.step_record import StepRecord
from harness.recording.stored_run import StoredRun
from harness.recording.verdict import Verdict
from harness.reporting.html.story import depth_of, environment, ordered_steps
from harness.reporting.margins import MOST_USED, deciding_measures, used_allowance
from harness.reporting.terminal import verdict_line

STATUS = {"expected error": "failed as expected"}  # others are words themselves
TONES = {"failed": "bad", "not reached": "open", "not observable": "open"}


@dataclass(frozen=True)
class SummaryPicture:
    """A small picture of a step's end."""

    caption: str
    data: bytes

    @property
    def encoded(self) -> str:
        return base64.b64encode(self.data).decode()


@dataclass(frozen=True)
class Row:
    """A row of a table.

    Attributes:
        tone: Whether it looks good, bad or open.
        source: The line of the file that does not hold, below the cells; empty for none.
        warnings: Further lines below the cells.
    """

    tone: str
    cells: tuple[str, ...]
    source: str = ""
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Table:
    """A table of texts."""

    title: str
    head: tuple[str, ...]
    rows: Sequence[Row]


def header_facts(stored: StoredRun) -> list[tuple[str, str]]:
    """What stands next to the title."""
    run, physics = stored.run, stored.run.versions.get("mujoco", "")
    return [
        ("points", _earned(stored)),
        ("robot", run.robot.name),
        ("seed", str(run.seed) if physics else ""),
        ("simulated" if physics else "recorded", f"{float(run.signals.times[-1]):.1f} s"),
        ("physics", physics and f"MuJoCo {physics}"),
        ("digest", stored.digest[:12]),
        ("file" if physics else "recording", run.file),
        ("case", run.case),
    ]


def _earned(stored: StoredRun) -> str:
    """`9 of 10` points of a run that was graded; empty of others."""
    if all(verdict.earned is None for verdict in stored.verdicts):
        return ""
    earned, worth = (
        sum(getattr(verdict, key) or 0.0 for verdict in stored.verdicts)
        for key in ("earned", "points")
    )
    return f"{earned:g} of {worth:g}"


def summary_facts(stored: StoredRun) -> list[tuple[str, str]]:
    """What stands below the title of the summary."""
    held = sum(verdict.status == "passed" for verdict in stored.verdicts)
    held_of = f"{held} of {len(stored.verdicts)}" if stored.verdicts else "none is stated"
    return [*header_facts(stored), ("expectations that hold", held_of)]


def summary_tables(stored: StoredRun) -> list[Table]:
    """Expectations, steps, findings and environment; without tables that would be empty."""
    expectations = ("", "expectation", "verdict", "used", "line")
    steps = ("", "step", "status", "took", "line", "")
    tables = [
        Table("Expectations", expectations, list(_verdicts(stored))),
        Table("Steps", steps, list(_steps(stored))),
        Table("Findings", ("", "", "time"), list(_findings(stored))),
        Table("Environment", ("", ""), [Row("", row) for row in environment(stored)]),
    ]
    return [table for table in tables if table.rows or table.title == "Steps"]


def _verdicts(stored: StoredRun) -> Iterator[Row]:
    source = stored.run.source.splitlines()
    for number, verdict in enumerate(stored.verdicts, start=1):
        holds, line, credit = verdict.status == "passed", verdict.line, verdict.credit
        yield Row(
            TONES.get(verdict.status, "good"),
            (str(number), f"{verdict.expectation}{credit and f' ({credit})'}",
             verdict_line(verdict), _used(verdict), str(line or "")),
            source="" if holds or not 0 < line <= len(source) else source[line - 1].strip(),
            warnings=tuple(map(str, verdict.warnings)),
        )  # fmt: skip


def _used(verdict: Verdict) -> str:
    share = used_allowance(verdict)
    is_floor = any(each.comparison == ">=" for each in deciding_measures(verdict))
    return "" if share is None or share >= MOST_USED or is_floor else f"{100 * share:.0f} %"


def _steps(stored: StoredRun) -> Iterator[Row]:
    run = stored.run
    for number, step in enumerate(ordered_steps(run), start=1):
        why = "" if step.status == "passed" else step.message
        code = "" if why.startswith(step.error_code) else step.error_code
        yield Row(
            TONES.get(step.status, "good"),
            (str(number), "\u2003" * depth_of(step, run) + step.summary,
             STATUS.get(step.status, step.status), _duration(step), str(step.line or ""),
             ": ".join(filter(None, (code, why)))),
        )  # fmt: skip


def _duration(step: StepRecord) -> str:
    took = step.end_time - step.start_time
    return f"{took:.2f} s" if step.status != "not reached" and math.isfinite(took) else ""


def _findings(stored: StoredRun) -> Iterator[Row]:
    for finding in stored.run.findings:
        time = f"{finding.time:.2f} s" if math.isfinite(finding.time) else ""
        yield Row("open", (finding.kind.replace("_", " "), finding.message, time))
