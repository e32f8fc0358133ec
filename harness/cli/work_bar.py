"""The status line of work in parts: a bar, the rate and the remaining time."""

from __future__ import annotations

import math
import sys
import time

from harness.cli.output import output

ENOUGH_FOR_AN_ESTIMATE = 3.0  # [s], before pace and remaining time are known from what is done
BAR_WIDTH = 10  # characters: with counts and remaining time it fits into 40 columns


class WorkBar:
    """Shows how far a command is, on a terminal; each stage of it counts its own parts.

    An instance is called with the name of a stage, the number of its parts that are done, and the
    number of all.
    """

    def __init__(self) -> None:
        from harness.reporting.terminal import Style

        self._has_signs = Style.of(sys.stdout).has_signs
        self._stage = self._note = ""
        self._done = self._total = self._known = 0
        self._begin = self._last = time.monotonic()

    def __call__(self, stage: str, done: int, total: int, note: str = "") -> None:
        """Show the work at a number of parts, with a note at its end."""
        now = time.monotonic()
        is_new = stage != self._stage
        if is_new:
            self._stage, self._begin, self._known = stage, now, done
        self._done, self._total, self._last, self._note = done, total, now, note
        output().status(self._text, is_frequent=not is_new)

    def _text(self) -> str:
        now = time.monotonic()
        times, parts = (self._begin, self._last, now), (self._done, self._total)

        def bar(room: int) -> str:
            return pace(*times, *parts, known=self._known, has_signs=self._has_signs, room=room)

        columns, head = output().columns - 1, f"  {self._stage}: "
        text = f"{head}{bar(columns - len(head) - len(self._note))}{self._note}"
        return text if len(text) <= columns else f"  {bar(columns - 2)}"


def pace(
    begin: float,
    last: float,
    now: float,
    done: int,
    total: int,
    *,
    known: int = 0,
    has_signs: bool,
    room: float = math.inf,
) -> str:
    """`####------ 3 of 8, about 25 s left, 12 a minute`; where it is too long without its ends.

    Args:
        begin: When the first part began [s].
        last: When the last of those that are done ended [s].
        known: How many of those that are done were so before the first part began.
        has_signs: Whether the terminal has signs beyond ASCII.
        room: How many characters have room; the remaining time is left out last.
    """
    full, empty = "█░" if has_signs else "#-"
    filled = BAR_WIDTH * min(done, total) // max(1, total)
    bar = f"{full * filled}{empty * (BAR_WIDTH - filled)} "
    text = f"{done} of {total}{remaining(begin, last, now, done - known, total - known)}"
    rate_text = ""
    if done > known and last - begin >= ENOUGH_FOR_AN_ESTIMATE:
        rate = (done - known) / (last - begin)
        if rate >= 2:
            rate_text = f", {rate:.0f} a second"
        elif 60 * rate >= 1:
            rate_text = f", {60 * rate:.0f} a minute"
    choices = (f"{bar}{text}{rate_text}", f"{bar}{text}")
    return next((each for each in choices if len(each) <= room), text)


def remaining(begin: float, last: float, now: float, done: int, total: int) -> str:
    """`, about 40 s left` at the pace so far; empty while there is too little to judge by.

    Args:
        begin: When the first part began [s].
        last: When the last of those that are done ended [s].
    """
    if not done or done >= total or last - begin < ENOUGH_FOR_AN_ESTIMATE:
        return ""
    left = max(1.0, (last - begin) / done * (total - done) - (now - last))
    return f", about {left / 60:.0f} min left" if left >= 90 else f", about {left:.0f} s left"
