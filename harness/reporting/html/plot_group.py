"""A group of series that one plot shows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from harness.core.types import FloatArray

MOST_SERIES = 10  # curves of a plot that colours keep apart


@dataclass(frozen=True, eq=False)
class Limit:
    """A dashed line.

    Attributes:
        series: The series that the limit belongs to; None for all.
    """

    value: float
    series: int | None = None


@dataclass(frozen=True, eq=False)
class Group:
    """Series of one plot, shape (samples,) each.

    Attributes:
        least: The smallest range of values that the plot shows, in its unit; less is noise.
        measure: Name of the measures whose limits the plot shows; empty for none.
        factor: The factor from the measure's unit to the plot's.
        is_signed: Whether such a limit holds for both signs.
    """

    id: str
    title: str
    unit: str
    series: Mapping[str, FloatArray]
    limits: Sequence[Limit] = field(default_factory=list[Limit])
    least: float = 1.0
    measure: str = ""
    factor: float = 1.0
    is_signed: bool = False
