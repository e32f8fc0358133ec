"""Results as text for people, on the command line and in pytest."""

from __future__ import annotations

import math
import os
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

from harness.core.amounts import amount, stated_amount
from harness.core.printable import ESC, counted, printable, printable_lines
from harness.recording.step_record import is_nested
from harness.recording.verdict import Measure, Verdict
from harness.reporting.margins import tightest_name
from harness.reporting.progress_events import StepFinished, StepProgress, StepStarted
from harness.reporting.result import CaseResult, StepLine

OUTCOMES = ("error", "invalid", "failed", "passed")


@dataclass(frozen=True)
class Style:
    """How text may look: with colours, with signs beyond ASCII.

    Its control sequences are for `core.printable.terminal_text`, which writes no others.

    Attributes:
        is_verbose: Whether digests and real-time factors are shown.
    """

    has_color: bool = False
    has_signs: bool = False
    is_verbose: bool = False

    @classmethod
    def of(cls, stream: TextIO, *, is_verbose: bool = False) -> Style:
        """Colours on a terminal unless NO_COLOR is set; signs where the encoding has them."""
        try:
            "✓✗…".encode(stream.encoding or "ascii")
            has_signs = True
        except (UnicodeEncodeError, LookupError):
            has_signs = False
        has_color = stream.isatty() and not os.environ.get("NO_COLOR")
        return cls(has_color and os.environ.get("TERM") != "dumb", has_signs, is_verbose)

    def good(self, text: str) -> str:
        """Green."""
        return self._paint("32", text)

    def bad(self, text: str) -> str:
        """Red."""
        return self._paint("31", text)

    def strong(self, text: str) -> str:
        """Bold."""
        return self._paint("1", text)

    def quiet(self, text: str) -> str:
        """Dim."""
        return self._paint("2", text)

    def outcome(self, outcome: str, text: str | None = None) -> str:
        """The outcome's colour; its own name where no text is given."""
        return (self.good if outcome == "passed" else self.bad)(text or outcome)

    def link(self, text: str, address: str) -> str:
        """Text that a terminal opens an address from, where it can (OSC 8)."""
        return f"{ESC}]8;;{address}{ESC}\\{text}{ESC}]8;;{ESC}\\" if self.has_color else text

    def mark(self, is_good: bool) -> str:
        """A tick or a cross."""
        if self.has_signs:
            return self.good("✓") if is_good else self.bad("✗")
        return self.good("ok") if is_good else self.bad("no")

    def _paint(self, code: str, text: str) -> str:
        return f"{ESC}[{code}m{text}{ESC}[0m" if self.has_color else text


PLAIN = Style()


def step_running(event: StepStarted, style: Style = PLAIN) -> str:
    """The line of a step that is under way."""
    dots = " …" if style.has_signs else " ..."
    return f"    {_count(event)}  {printable(event.step)}{dots}  t={event.sim_time:.2f} s"


def step_head(event: StepStarted, depth: int = 0) -> str:
    """The line of a step above the steps nested in it, which has no result yet."""
    return f"    {_count(event)}  {_nested(event.step, depth)}"


def step_done(event: StepFinished, style: Style = PLAIN, depth: int = 0) -> str:
    """The line of a step that is over: sign, number, simulation time; why it failed comes below.

    The speed is how many times faster than the real thing it was, where anything moved.

    Args:
        depth: The number of steps that it is nested in.
    """
    is_good = event.status in {"passed", "expected error"}
    line = f"  {style.mark(is_good)} {_count(event)}  {_nested(event.step, depth)}"
    line += style.quiet(f"  t={event.sim_time:.2f} s")
    if event.speed and style.is_verbose:
        line += style.quiet(f"  {speed_text(event.speed)}")
    if event.status == "expected error":
        line += style.quiet("  failed as expected")
    return line


def _nested(step: str, depth: int) -> str:
    return "  " * depth + printable(step)


def speed_text(speed: float) -> str:
    """A speed factor: `12x real time`, `0.8x real time`."""
    return f"{speed:.0f}x real time" if speed >= 9.5 else f"{speed:.1f}x real time"


def _count(event: StepProgress) -> str:
    width = len(str(event.total))
    if event.index < 0:
        return " " * (2 * width + 1)  # nested in the step above
    return f"{event.index + 1:>{width}}/{event.total}"


def case_line(result: CaseResult, style: Style = PLAIN) -> str:
    """One line of a finished case."""
    outcome = style.outcome(result.outcome, f"{result.outcome:<8}")
    parts = [f"{outcome}{style.strong(result.name)}"]
    if result.outcome in {"passed", "failed"}:
        held = sum(verdict.status == "passed" for verdict in result.verdicts)
        simulated = f"{result.sim_time:.1f} s simulated"
        if style.is_verbose and (wall := sum(result.wall_times.values())):
            simulated += f" at {speed_text(result.sim_time / wall)}"
        parts.append(f"{counted(len(result.steps), 'step')}, {simulated}")
        count = len(result.verdicts)
        holds = "holds" if count == 1 else "hold"
        held_of = f"{held} of {counted(count, 'expectation')} {holds}"
        parts.append(held_of if result.verdicts else "expects nothing")
        if style.is_verbose:
            parts.append(style.quiet(f"digest {result.digest[:12]}"))
    return printable("  ".join(parts))


def failure(
    result: CaseResult, style: Style = PLAIN, *, again: str = "", source: Sequence[str] = ()
) -> str:
    """Why a case did not pass: every cause with its line and numbers, and where the report is.

    Args:
        again: The command that runs exactly this case; empty to leave it out.
        source: Lines of the scenario file, to show those that are spoken of.
    """
    name = f"{result.file} [{result.case}]" if result.case else result.file
    title = f": {result.title}" if not result.file.endswith(result.title) else ""
    lines = [f"{style.outcome(result.outcome, result.outcome.upper())} {name}{title}"]
    lines += [f"  {line}" for cause in causes(result, source) for line in cause.split("\n")]
    if result.report_dir:
        lines.append(f"  report: {report_link(result, style)}")
        lines += [f"  page:   {style.link(page, _uri(page))}" for page in result.further_pages]
    if again:
        lines.append(f"  again:  {again}")
    return _joined(lines)


def report_link(result: CaseResult, style: Style = PLAIN) -> str:
    """Where a case's report is: its page at the moment of the first failure, else its folder."""
    if not result.page:
        return result.report_dir
    place = failure_place(result)
    return style.link(f"{result.page}{place}", f"{_uri(result.page)}{place}")


def _uri(page: str) -> str:
    return Path(page).resolve().as_uri()


def failure_place(result: CaseResult) -> str:
    """The deep link of the first failure: `#t=10.10&expect=4`; empty when there is none.

    A step that failed is explained in the page's tab `planner`.
    """
    if any(step.status == "failed" for step in result.steps):
        return f"#t={result.sim_time:.2f}&tab=planner"
    for number, verdict in enumerate(result.verdicts, start=1):
        if verdict.status != "passed":
            time = "" if math.isnan(verdict.time) else f"t={verdict.time:.2f}&"
            return f"#{time}expect={number}"
    return ""


def causes(result: CaseResult, source: Sequence[str] = ()) -> list[str]:
    """Everything that kept a case from passing; the file's mistakes, else steps, else expectations.

    Each cause is printable: one line, or several of which each is.

    Args:
        source: Lines of the scenario file, to show those that are spoken of.
    """
    found = [str(problem) for problem in result.problems]
    found += [step_failure(result.file, step, source) for step in root_failures(result.steps)]
    found += [
        verdict_failure(result.file, verdict, source)
        for verdict in result.verdicts
        if verdict.status != "passed"
    ]
    if result.outcome == "error" or not found:
        found.append(printable_lines(result.message.rstrip()) or "no cause was reported")
    return found


def root_failures(steps: Sequence[StepLine]) -> list[StepLine]:
    """Failed steps without those that failed because a step nested in them did."""
    failed = [step for step in steps if step.status == "failed"]
    return [
        step
        for step in failed
        if not (step.path and any(is_nested(other.path, step.path) for other in failed))
    ]


def step_failure(file: str, step: StepLine, source: Sequence[str] = ()) -> str:
    """Place, step, error code, message, source line, and the explanation where there is one."""
    place = f"{file}:{step.line}" if step.line else file
    why = ": ".join(part for part in (step.error_code, step.message) if part)
    explained = [f"    {line}" for line in step.explanation]
    return _joined([f"{place}: {step.summary}: {why}", *_excerpt(source, step.line), *explained])


def verdict_failure(file: str, verdict: Verdict, source: Sequence[str] = ()) -> str:
    """Place, expectation, status, why, source line, and everything measured."""
    place = f"{file}:{verdict.line}" if verdict.line else file
    lines = [f"{place}: {verdict.expectation}: {verdict_line(verdict)}"]
    if verdict.status != "not reached":
        lines += _excerpt(source, verdict.line)
    lines += [f"    {measure_text(measure)}" for measure in verdict.measures]
    return _joined(lines)


def verdict_warnings(file: str, verdicts: Iterable[Verdict]) -> tuple[str, ...]:
    """The place, expectation and text of every warning of a file's verdicts."""
    return tuple(
        f"{file}:{verdict.line}: {verdict.expectation}: warning: {warning}"
        if verdict.line
        else f"{file}: {verdict.expectation}: warning: {warning}"
        for verdict in verdicts
        for warning in verdict.warnings
    )


def _excerpt(source: Sequence[str], number: int) -> list[str]:
    is_known = 0 < number <= len(source)
    return [f"{number:>5} | {source[number - 1].expandtabs(4)}"] if is_known else []


def verdict_line(verdict: Verdict) -> str:
    """Status, margin and reason in one line.

    The margin of what holds is that of the required quantity; a tighter one follows.
    """
    text = verdict.status
    if not math.isnan(verdict.margin):
        margin = stated_amount(abs(verdict.margin), verdict.unit)
        tightest = tightest_name(verdict)
        if tightest:
            required = verdict.measures[0]
            gap = stated_amount(abs(required.value - required.limit), required.unit)
            text += f" by {gap} (tightest: {tightest}, by {margin})"
        else:
            text += f" by {margin}"
    if not math.isnan(verdict.time):
        text += f" at t={verdict.time:.3f} s"
    return f"{text}: {verdict.reason}" if verdict.reason else text


def measure_text(measure: Measure) -> str:
    """A measure with its limit, where it has one."""
    if math.isnan(measure.limit):
        where = f" at t={measure.time:.3f} s" + (measure.detail and f" ({measure.detail})")
        return f"{measure.name}: {amount(measure.value, measure.unit)}{where}"
    return str(measure)


def summary(outcomes: Iterable[str], seconds: float, style: Style = PLAIN) -> str:
    """The last line: how many of each outcome, and the wall time."""
    counts = Counter(outcomes)
    parts = [
        style.outcome(outcome, f"{counts[outcome]} {outcome}")
        for outcome in OUTCOMES
        if counts[outcome]
    ]
    text = ", ".join(parts) or "nothing was run"
    return f"{text} of {counted(counts.total(), 'case')} in {seconds:.1f} s"


def repeats(results: Iterable[CaseResult], style: Style = PLAIN) -> str:
    """Whether runs of the same case have the same digest."""
    digests = Counter(result.digest or f"no digest ({result.outcome})" for result in results)
    if len(digests) == 1:
        [(digest, count)] = digests.items()
        return f"{style.mark(True)} {count} runs, one digest: {digest}"
    repeated = "; ".join(f"{count} x {digest}" for digest, count in digests.items())
    return (
        f"{style.mark(False)} {digests.total()} runs, {len(digests)} digests: {repeated}; `harness"
        " compare` prints where two reports part"
    )


def _joined(lines: Iterable[str]) -> str:
    """Lines as one text; what would end a line within one of them is escaped."""
    return "\n".join(map(printable, lines))
