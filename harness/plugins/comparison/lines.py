"""Two runs side by side, as lines for the terminal."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

from harness.core.amounts import amounts
from harness.plugins.comparison.compare import Change, FirstDifference, RunComparison
from harness.reporting.terminal import PLAIN, Style

HEADINGS = {
    "outcome": "outcome",
    "scenario": "scenario",
    "robot": "robot",
    "seed": "seed",
    "version": "versions",
    "step": "steps",
    "duration": "durations of steps",
    "trajectory": "trajectories",
    "verdict": "verdicts",
    "margin": "margins of expectations that stayed as they were",
    "findings": "findings",
}


def comparison_lines(comparison: RunComparison, style: Style = PLAIN) -> Iterator[str]:
    """What changed, in groups; one line when nothing did."""
    if comparison.is_same:
        yield f"{style.good('same')}  equal digests: commands, signals and verdicts are the same"
    else:
        yield f"{style.bad('different')}  {_parting(comparison.first_difference)}"
    yield from (f"  {each.text}" for each in comparison.farthest)
    for warning in comparison.warnings:
        yield f"{style.bad('changed')}  {warning}"
    order = list(HEADINGS)
    changes = sorted(comparison.changes, key=lambda change: order.index(change.what))
    for what, group in groupby(changes, key=lambda change: change.what):
        yield style.strong(HEADINGS[what])
        for change in group:
            yield f"  {_line(change)}"


def _parting(first: FirstDifference | None) -> str:
    if first is None:
        return "the recorded signals are the same; commands or verdicts differ"
    return parting_text(first)


def parting_text(first: FirstDifference) -> str:
    """Where two recordings part, in words."""
    where = f"in step {first.step}, " if first.step else ""
    if first.signal == "times":
        return f"one run continues {where}after t={first.time:.3f} s"
    values = amounts(first.before, first.after, first.unit)
    shown = " and ".join(value.rstrip() for value in values)
    return f"first {where}at t={first.time:.3f} s: {first.signal} is {shown}"


def _line(change: Change) -> str:
    name = f"{change.name}: " if change.name else ""
    line = f"{name}{change.before}"
    if change.before != change.after:
        line += f" -> {change.after}"
    if not change.difference:
        return line
    if change.what == "trajectory":
        return f"{line}, up to {change.difference}"
    return f"{line} ({change.difference})"
