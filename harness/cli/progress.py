"""Progress while cases run: steps and a status on a terminal, one line for each case elsewhere."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import replace

from harness.cli.output import Output, complain
from harness.reporting.progress_events import (
    Judged,
    ProgressEvent,
    StepFinished,
    StepStarted,
    Working,
)
from harness.reporting.result import CaseResult
from harness.reporting.terminal import Style, case_line, step_done, step_running

Moment = tuple[float, float]  # wall time and simulation time [s]
ENOUGH_FOR_AN_ESTIMATE = 3.0  # [s], before the remaining time is estimated from what is done


class ProgressLines:
    """Shows a case's steps as they begin and end, and the case's outcome.

    One case at a time has its file as a headline and its steps below; with several at the same
    time, every line begins with the case that it belongs to. In a pipe or a file, and with very
    many cases, a case is one line, written when it has ended. On a terminal the last line says
    what is going on now: the step or the part of the report, how far it is, and how many of the
    cases are done.
    """

    def __init__(
        self,
        output: Output,
        cases: Sequence[str],
        *,
        is_side_by_side: bool,
        style: Style,
        is_brief: bool = False,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._output = output
        self._cases = cases
        self._style = style
        self._is_side_by_side = is_side_by_side
        self._is_brief = is_brief or not output.stream.isatty()
        self._clock = clock
        self._headline = -1
        self._noted: set[str] = set()  # every sample of a file has the same
        self._begun: dict[int, list[Moment]] = defaultdict(list)  # steps nest
        self._activities: dict[int, tuple[str, float]] = {}
        self._shown: dict[int, str] = {}  # outcomes that are shown before the report is written
        self._done = 0
        self._start = self._last_end = clock()
        self._output.status(self._status(None, 0))

    def step(self, index: int, event: ProgressEvent) -> None:
        """Take note of a progress event of a running case."""
        if isinstance(event, StepStarted):
            self._begun[index].append((event.wall_time, event.sim_time))
        elif isinstance(event, StepFinished) and not self._is_brief:
            self._begin(index)
            speed = self._speed(index, event)
            self._line(index, step_done(replace(event, speed=speed), self._style))
        elif isinstance(event, Judged) and len(self._cases) == 1:
            self._verdict(index, event.result)
        if not self._output.stream.isatty():
            slow_work_on_stderr(index, event)
        if isinstance(event, StepStarted | Working):
            if not self._is_brief:
                self._begin(index)
            is_frequent = isinstance(event, Working) and event.done > 0
            self._output.status(self._status(event, index), is_frequent=is_frequent)

    def result(self, index: int, result: CaseResult) -> None:
        """Show a case's outcome."""
        self._done += 1
        self._last_end = self._clock()
        if self._shown.get(index) != result.outcome:
            self._verdict(index, result)
        for note in result.notes:
            if note not in self._noted:
                self._noted.add(note)
                for line in f"note: {note}".splitlines():
                    self._line(index, f"  {self._style.quiet(line)}")
        is_last = self._done == len(self._cases)
        self._output.status(None if is_last else self._status(None, index))

    def _verdict(self, index: int, result: CaseResult) -> None:
        """Show a case's outcome, its report written or not."""
        self._shown[index] = result.outcome
        line = case_line(result, self._style)
        if self._is_brief:
            self._line(index, f"  {line}" if self._is_side_by_side else self._named(index, line))
        else:
            self._begin(index)
            self._line(index, f"  {line}")

    def _status(self, event: StepStarted | Working | None, index: int) -> Callable[[], str]:
        """A function that gives the text of the status line at any later moment."""
        begin = now = self._clock()
        if isinstance(event, Working):
            if self._activities.get(index, ("", 0.0))[0] != event.what:
                self._activities[index] = event.what, now
            begin = self._activities[index][1]

        def text() -> str:
            return f"{self._suite_status()}{self._case_status(event, index, begin, now)}"

        return text

    def _suite_status(self) -> str:
        total, done = len(self._cases), self._done
        if total < 2:
            return ""
        left = remaining(self._start, self._last_end, self._clock(), done, total)
        return f"  {done} of {total} runs done{left};"

    def _case_status(
        self, event: StepStarted | Working | None, index: int, begin: float, now: float
    ) -> str:
        """What a run is doing: since when, and since when as far as the event says."""
        time = self._clock()
        passed = f"  {time - begin:.0f} s" if time - begin >= 1.0 else ""
        if event is None:
            return f"  starting{passed}"
        has_headline = not (self._is_brief or self._is_side_by_side)
        name = "    " if has_headline else f"  {self._cases[index]}:  "
        if isinstance(event, StepStarted):
            return f"{name}{step_running(event, self._style).strip()}{passed}"
        count = f", {event.done} of {event.total}" if event.total else ""
        left = remaining(begin, now, time, event.done, event.total)
        return f"{name}{event.what}{count}{passed}{left}"

    def _speed(self, index: int, event: StepFinished) -> float | None:
        """Simulated over wall seconds of a step, its planning included."""
        if not self._begun[index]:
            return None
        wall, simulated = self._begun[index].pop()
        passed = event.wall_time - wall
        return (event.sim_time - simulated) / passed if passed > 0 else None

    def _named(self, index: int, line: str) -> str:
        return f"{self._cases[index]}  {line}"

    def _begin(self, index: int) -> None:
        if not self._is_side_by_side and self._headline != index:
            self._headline = index
            self._output.line(self._style.strong(self._cases[index]))

    def _line(self, index: int, text: str) -> None:
        whose = f"{self._cases[index]}:" if self._is_side_by_side else ""
        self._output.line(f"{whose}{text}")


def slow_work_on_stderr(_index: int, event: ProgressEvent) -> None:
    """Write what takes long on standard error, where there is no status line."""
    if isinstance(event, Working) and event.is_slow:
        complain(event.what)


def remaining(begin: float, last: float, now: float, done: int, total: int) -> str:
    """`, about 40 s left` at the pace so far; empty while there is too little to judge by.

    Args:
        begin: When the first part began [s].
        last: When the last of those that are done ended.
    """
    if not done or done >= total or last - begin < ENOUGH_FOR_AN_ESTIMATE:
        return ""
    left = max(1.0, (last - begin) / done * (total - done) - (now - last))
    return f", about {left / 60:.0f} min left" if left >= 90 else f", about {left:.0f} s left"
