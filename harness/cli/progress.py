"""Progress while cases run: steps and a status on a terminal, one line for each case elsewhere."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from harness.cli.output import Output, complain
from harness.cli.work_bar import pace, remaining
from harness.core.printable import columns_of, cropped, printable
from harness.reporting.progress_events import (
    Judged,
    ProgressEvent,
    StepFinished,
    StepStarted,
    Working,
)
from harness.reporting.result import CaseResult
from harness.reporting.terminal import Style, case_line, step_done, step_head, step_running

NARROWEST = 20  # characters that are left for what a case is doing, else it is not shown


@dataclass
class _OpenStep:
    """A step that has begun and has not ended.

    Attributes:
        has_head: Whether its line stands above those of the steps nested in it.
        is_explained: Whether a step nested in it failed, whose line says why.
    """

    begin: StepStarted
    has_head: bool = False
    is_explained: bool = False


class ProgressLines:
    """Shows a case's steps as they begin and end, and the case's outcome.

    One case at a time has its file as a headline and its steps below, each above those that are
    nested in it; with several at the same time, every line begins with the case that it belongs to.
    In a pipe or a file, and with very many cases, a case is one line, written when it has ended; a
    folded case, such as a sample whose rate is printed at the end, is none if it passed. On
    a terminal the last line says what is going on now: the step or the part of the report, how far
    it is, and how many of the cases are done.
    """

    def __init__(
        self,
        output: Output,
        cases: Sequence[str],
        *,
        is_side_by_side: bool,
        style: Style,
        is_brief: bool = False,
        is_folded: Callable[[int], bool] = lambda _index: False,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._output = output
        self._cases = cases
        self._style = style
        self._is_side_by_side = is_side_by_side
        self._is_brief = is_brief or not output.stream.isatty()
        self._is_folded = is_folded
        self._clock = clock
        self._headline = -1
        self._noted: set[str] = set()  # every sample of a file has the same
        self._open: dict[int, list[_OpenStep]] = defaultdict(list)  # the innermost step is last
        self._activities: dict[int, tuple[str, float]] = {}
        self._shown: dict[int, str] = {}  # outcomes that are shown before the report is written
        self._done = 0
        self._start = self._last_end = clock()
        self._output.status(self._status(None, 0))

    def step(self, index: int, event: ProgressEvent) -> None:
        """Take note of a progress event of a running case."""
        if isinstance(event, StepStarted):
            self._step_begins(index, event)
        elif isinstance(event, StepFinished):
            self._step_ends(index, event)
        elif isinstance(event, Judged) and len(self._cases) == 1:
            self._verdict(index, event.result)
        if not self._output.stream.isatty():
            slow_work_on_stderr(index, event)
        if isinstance(event, StepStarted | Working):
            if not self._hides_steps(index):
                self._begin(index)
            is_frequent = isinstance(event, Working) and event.done > 0
            self._output.status(self._status(event, index), is_frequent=is_frequent)

    def result(self, index: int, result: CaseResult) -> None:
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

    def _step_begins(self, index: int, event: StepStarted) -> None:
        """Show the steps that a step is nested in, before its own line."""
        outer = self._open[index]
        for depth, each in enumerate(outer):
            if not (each.has_head or self._hides_steps(index)):
                each.has_head = True
                self._begin(index)
                self._line(index, step_head(each.begin, depth))
        outer.append(_OpenStep(event))

    def _step_ends(self, index: int, event: StepFinished) -> None:
        """Show how a step ended, unless the lines of the steps nested in it do."""
        outer = self._open[index]
        step = outer.pop() if outer else None
        is_good = event.status in {"passed", "expected error"}
        if outer and event.status == "failed":
            outer[-1].is_explained = True
        is_shown = step is not None and step.has_head and (is_good or step.is_explained)
        if self._hides_steps(index) or is_shown:
            return
        self._begin(index)
        speed = None if step is None else _speed(step.begin, event)
        self._line(index, step_done(replace(event, speed=speed), self._style, len(outer)))

    def _hides_steps(self, index: int) -> bool:
        return self._is_brief or self._is_folded(index)

    def _verdict(self, index: int, result: CaseResult) -> None:
        """Show a case's outcome, its report written or not."""
        self._shown[index] = result.outcome
        if result.outcome == "passed" and self._is_folded(index):
            return
        line = case_line(result, self._style)
        if self._hides_steps(index):
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
            suite = self._suite_status()
            room = self._output.columns - 1 - columns_of(suite)
            case = printable(self._case_status(event, index, begin, now))
            return suite + (cropped(case, room) if room >= NARROWEST else "")

        return text

    def _suite_status(self) -> str:
        total, done = len(self._cases), self._done
        if total < 2:
            return ""
        times = self._start, self._last_end, self._clock()
        room = self._output.columns - 3
        return f"  {pace(*times, done, total, has_signs=self._style.has_signs, room=room)}"

    def _case_status(
        self, event: StepStarted | Working | None, index: int, begin: float, now: float
    ) -> str:
        """What a run is doing: since when, and since when as far as the event says."""
        time = self._clock()
        passed = f"  {time - begin:.0f} s" if time - begin >= 1.0 else ""
        if event is None:
            return f"  starting{passed}"
        has_headline = not (self._hides_steps(index) or self._is_side_by_side)
        name = "    " if has_headline else f"  {self._cases[index]}:  "
        if isinstance(event, StepStarted):
            return f"{name}{step_running(event, self._style).strip()}{passed}"
        count = f", {event.done} of {event.total}" if event.total else ""
        left = remaining(begin, now, time, event.done, event.total)
        return f"{name}{event.what}{count}{passed}{left}"

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


def _speed(begin: StepStarted, end: StepFinished) -> float | None:
    """Simulated over wall seconds of a step, its planning included."""
    passed = end.wall_time - begin.wall_time
    return (end.sim_time - begin.sim_time) / passed if passed > 0 else None
