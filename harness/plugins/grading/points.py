"""The points that verdicts earn; needs none of the packages that read recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from harness.plugins.grading.credit import FULL, Credit
from harness.recording.run import Run
from harness.recording.verdict import Verdict


@dataclass(frozen=True)
class Graded:
    """An expectation's verdict, and what it is worth.

    Attributes:
        points: The points that can be earned; 0 where only other rows have points.
        earned: The points that were earned.
        withheld: The doubts about the recording for which points are withheld.
        is_measured: Whether what the recording shows was measured; distances are not where points
            are withheld.
    """

    verdict: Verdict
    points: float
    earned: float
    withheld: tuple[str, ...] = ()
    is_measured: bool = True

    @property
    def is_withheld(self) -> bool:
        """Whether points are withheld that the recording may have earned."""
        return bool(self.withheld) and (self.verdict.status == "passed" or not self.is_measured)


@dataclass(frozen=True)
class Grade:
    """The grade of a recording.

    Attributes:
        run: The recording, as far as it goes; None where nothing of a run was kept.
        rows: One an expectation, in file order.
        notes: What a person should know of the recording.
    """

    run: Run | None
    rows: tuple[Graded, ...]
    notes: tuple[str, ...]

    @property
    def points(self) -> float:
        """Points that can be earned."""
        return sum(row.points for row in self.rows)

    @property
    def earned(self) -> float:
        """Points that are earned."""
        return sum(row.earned for row in self.rows)

    @property
    def withheld(self) -> float:
        """Points that are withheld, because what the recording shows is doubtful."""
        return sum(row.points for row in self.rows if row.is_withheld)

    @property
    def is_full(self) -> bool:
        """Whether every point is earned."""
        return bool(self.rows) and all(row.earned == row.points for row in self.rows)

    @property
    def open(self) -> float:
        """Points of what this recording cannot show: neither earned nor lost."""
        unknown = (row for row in self.rows if row.verdict.status == "not observable")
        return sum(row.points for row in unknown if row.is_measured)


def graded(verdicts: Sequence[Verdict], credit: Credit = FULL) -> tuple[Graded, ...]:
    """The `points` of each expectation; one each where no expectation states any."""
    has_points = any(verdict.points is not None for verdict in verdicts)
    worth = [(verdict.points or 0.0) if has_points else 1.0 for verdict in verdicts]
    return tuple(
        Graded(verdict, points, points * credit.share if verdict.status == "passed" else 0.0)
        for verdict, points in zip(verdicts, worth, strict=True)
    )
