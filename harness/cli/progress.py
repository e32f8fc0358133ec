"""Lines of progress while cases run: steps on a terminal, one line a case elsewhere."""

from __future__ import annotations

import shutil
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from typing import TextIO

from harness.reporting.result import CaseResult, ProgressEvent
from harness.reporting.terminal import Style, case_line, step_done, step_running

CLEAR_LINE = "\r\x1b[2K"

Moment = tuple[float, float]
"""Wall time and simulation time [s]."""


class ProgressLines:
    """Tells a case's steps as they begin and end, and the case's outcome.

    One case at a time has its file as a headline and its steps below; of several side by side,
    every line begins with the case it belongs to. Where nobody watches, in a pipe or a file, and
    of very many cases, a case is one line, told when it has ended.
    """

    def __init__(
        self,
        stream: TextIO,
        cases: Sequence[str],
        *,
        is_side_by_side: bool,
        style: Style,
        is_brief: bool = False,
    ) -> None:
        self._stream = stream
        self._cases = cases
        self._style = style
        self._is_side_by_side = is_side_by_side
        self._is_brief = is_brief or not stream.isatty()
        self._rewrites = stream.isatty() and style.has_color and not is_side_by_side
        self._headline = -1
        self._noted: set[str] = set()  # every sample of a file has the same
        self._begun: dict[int, list[Moment]] = defaultdict(list)  # steps nest

    def step(self, index: int, event: ProgressEvent) -> None:
        """Take note of a sign of life."""
        if self._is_brief:
            return
        if event.kind == "step_started":
            self._begun[index].append((event.wall_time, event.sim_time))
            if self._rewrites:
                self._begin(index)
                width = shutil.get_terminal_size().columns
                self._stream.write(f"{CLEAR_LINE}{step_running(event, self._style)[: width - 1]}")
                self._stream.flush()
        elif event.kind == "step_finished":
            self._begin(index)
            speed = self._speed(index, event)
            self._line(index, step_done(replace(event, speed=speed), self._style))

    def result(self, index: int, result: CaseResult) -> None:
        """Tell a case's outcome."""
        line = case_line(result, self._style)
        if self._is_brief:
            self._line(index, f"  {line}" if self._is_side_by_side else self._named(index, line))
        else:
            self._begin(index)
            self._line(index, f"  {line}")
        for note in result.notes:
            if note not in self._noted:
                self._noted.add(note)
                self._line(index, f"  {self._style.quiet(f'note: {note}')}")

    def _speed(self, index: int, event: ProgressEvent) -> float | None:
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
            self._stream.write(f"{self._style.strong(self._cases[index])}\n")

    def _line(self, index: int, text: str) -> None:
        clear = CLEAR_LINE if self._rewrites else ""
        whose = f"{self._cases[index]}:" if self._is_side_by_side else ""
        self._stream.write(f"{clear}{whose}{text}\n")
        self._stream.flush()
