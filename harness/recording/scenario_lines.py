"""What differs between the scenarios of two runs, line by line of their resolved files."""

from __future__ import annotations

from difflib import SequenceMatcher
from itertools import zip_longest

from harness.recording.run import Run

NONE = "-"
"""Stands for what one of two runs does not have."""
MOST = 20
"""Changes that are listed one by one."""


def line_changes(one: Run, two: Run) -> list[tuple[str, str]]:
    """Each line before and after; the last says how many more there are."""
    ours, theirs = (_lines(run.resolved) for run in (one, two))
    found: list[tuple[str, str]] = []
    matcher = SequenceMatcher(None, ours, theirs, autojunk=False)
    for kind, a, b, c, d in matcher.get_opcodes():
        if kind != "equal":
            found += zip_longest(ours[a:b], theirs[c:d], fillvalue=NONE)
    if len(found) <= MOST:
        return found
    more = f"{len(found) - MOST} more lines"
    return [*found[:MOST], (more, more)]


def _lines(text: str) -> list[str]:
    """Without indentation, the dashes of lists and comments, which say the seeds of steps."""
    lines = (line.strip().removeprefix("- ") for line in text.splitlines())
    return [line for line in lines if line and not line.startswith("#")]
