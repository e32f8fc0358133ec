"""Simulated time against wall time: paced, measured, reported, and never judged."""

from __future__ import annotations

import time
from dataclasses import dataclass

from harness.plugins.ros.control.cell import TICK

LATE = 0.05  # lag from which a tick, and what arrives in it, counts as late [s]
GIVE_UP = 0.25  # lag that is not made up for any more: simulated time continues from here [s]
SLOW_SHARE = 0.2  # of a session's wall time that is lost before a machine is called slow


@dataclass
class Pace:
    """Lets a tick begin when its wall time has come.

    Attributes:
        factor: Simulated seconds in a wall second.
        late_commands: Commands that arrived while a tick was late.
        worst: The largest lag of a tick [s].
        lost: Wall time that was given up [s].
        due: The moment of `time.monotonic` at which the next tick begins.
    """

    factor: float = 1.0
    ticks: int = 0
    late: int = 0
    late_commands: int = 0
    worst: float = 0.0
    lost: float = 0.0
    due: float = 0.0
    _begin: float = 0.0

    def start(self) -> None:
        """Begin a session now."""
        self.due = self._begin = time.monotonic()

    def next(self) -> None:
        """Let the next tick begin when its wall time has come."""
        self.due += TICK / self.factor

    @property
    def is_due(self) -> bool:
        """Whether the next tick is to begin."""
        return time.monotonic() >= self.due

    def tick(self) -> None:
        """A tick begins; note how late."""
        lag = time.monotonic() - self.due
        self.ticks += 1
        self.worst = max(self.worst, lag)
        self.late += lag > LATE
        if lag > GIVE_UP:
            self.lost += lag
            self.due += lag

    def pause(self, seconds: float) -> None:
        """Leave out wall time in which simulated time stood still on purpose."""
        self.due += seconds
        self._begin += seconds

    def command(self) -> None:
        """A command arrived."""
        self.late_commands += time.monotonic() - self.due > LATE

    @property
    def is_slow(self) -> bool:
        """Whether the machine could not keep the pace."""
        return self.lost > SLOW_SHARE * max(time.monotonic() - self._begin, 1.0)

    def text(self) -> str:
        """One sentence for a person."""
        text = (
            f"{self.ticks * TICK:.1f} s of simulated time at {self.factor:g} times wall time:"
            f" {self.late} of {self.ticks} updates and {self.late_commands} commands were more than"
            f" {1e3 * LATE:.0f} ms late (at most {1e3 * self.worst:.0f} ms)"
        )
        return f"{text}; {self.lost:.1f} s were lost" if self.lost else text
