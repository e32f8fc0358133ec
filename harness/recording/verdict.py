"""The verdict on one expectation: its status, its numbers and how much it observed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from harness.core.amounts import amounts
from harness.core.types import Floats

VerdictStatus = Literal["passed", "failed", "not reached", "not observable"]


@dataclass(frozen=True)
class Measure:
    """A measured quantity against its limit.

    Attributes:
        name: What was measured: `TCP position error`.
        value: The value in `unit`.
        limit: What it is compared with, in `unit`; NaN where there is none.
        comparison: How value must stand to limit.
        unit: `m`, `rad`, `s`, `N`, `1`.
        time: Simulation time of the sample [s].
        detail: The joint, link or pair that was measured.
        expected: Where in the world something was to be (xyz), where the value is a distance.
        actual: Where it was (xyz).
        ceiling: The largest value that can be measured, in `unit`, as 1 is of a share; inf where
            there is none.
        plot: The plot of the report that shows the quantity; empty where none does.
    """

    name: str
    value: float
    limit: float
    comparison: Literal["<=", ">=", "=="]
    unit: str
    time: float
    detail: str = ""
    expected: Floats = ()
    actual: Floats = ()
    ceiling: float = float("inf")
    plot: str = ""

    def __str__(self) -> str:
        where = f" ({self.detail})" if self.detail else ""
        bound = {"<=": "at most", ">=": "at least", "==": "exactly"}[self.comparison]
        value, limit = amounts(self.value, self.limit, self.unit)
        return f"{self.name}: {value} ({bound} {limit}) at t={self.time:.3f} s{where}"


@dataclass(frozen=True)
class Observed:
    """How much of a run a verdict is based on.

    Attributes:
        samples: Samples of the window at which the expectation applies and its value is known.
        unknown: Samples at which it applies and its value is not known.
        pairs: Pairs of bodies whose contact or distance it reads; None where it reads none.
        premises: Samples at which the premise of a formula's implication holds, the least of its
            implications; None without one.
    """

    samples: int
    unknown: int = 0
    pairs: int | None = None
    premises: int | None = None


@dataclass(frozen=True)
class VerdictWarning:
    """Why a verdict that passed shows less than it seems to.

    Attributes:
        name: One of a few fixed names: `already true at the start`, `premise never held`.
        message: One sentence with the numbers.
    """

    name: str
    message: str

    def __str__(self) -> str:
        return f"{self.name}: {self.message}"


@dataclass(frozen=True)
class Verdict:
    """The result of an expectation.

    Attributes:
        expectation: Its text, one line: `never: collision between robot and Table`.
        margin: How far from flipping, in `unit`; positive when passed, negative when failed.
        time: The sample that decided it [s]; NaN when none did.
        line: The line in the scenario file; 0 if unknown.
        step: Id of the step it stands on; empty for the whole run.
        reason: One sentence with the numbers, for a failure why.
        measures: What was measured at the deciding sample.
        observed: How much it is based on; None where nothing could be judged.
        points: The points that it is worth; None where the file states none.
        warnings: Why it shows less than it seems to; `--strict` turns them into failures.
        earned: The points that a grader awarded; None of a run that is not graded.
    """

    expectation: str
    status: VerdictStatus
    margin: float = float("nan")
    unit: str = ""
    time: float = float("nan")
    line: int = 0
    step: str = ""
    reason: str = ""
    measures: tuple[Measure, ...] = ()
    points: float | None = None
    observed: Observed | None = None
    warnings: tuple[VerdictWarning, ...] = ()
    earned: float | None = None

    @property
    def credit(self) -> str:
        """`4 of 5 points`, or what it is worth; empty where it is worth nothing."""
        if not self.points:
            return ""
        if self.earned is None:
            return f"{self.points:g} point{'' if self.points == 1 else 's'}"
        return f"{self.earned:g} of {self.points:g} points"
