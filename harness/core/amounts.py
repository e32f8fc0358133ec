"""Numbers for people: millimetres, degrees, newtons; digits until two of them differ."""

from __future__ import annotations

import math

from harness.core.quantity import distinct

FINEST = 1e-3  # [mm, mm/s, N ...], what is smaller is written as 0
FINEST_ANGLE = 1e-4  # [deg]


def amount(value: float, unit: str, more_digits: int = 0) -> str:
    """A quantity for people: below a metre in mm, angles in degrees."""
    match unit:
        case "m" if abs(value) < 1:
            return f"{_short(value * 1e3, more_digits)} mm"
        case "rad":
            return f"{_short(math.degrees(value), more_digits, FINEST_ANGLE)} deg"
        case "rad/s":
            return f"{_short(math.degrees(value), more_digits)} deg/s"
        case "m/s" if abs(value) < 1:
            return f"{_short(value * 1e3, more_digits)} mm/s"
        case "1":
            return _short(value, more_digits)
        case _:
            return f"{_short(value, more_digits)} {unit}"


def amounts(value: float, limit: float, unit: str) -> tuple[str, str]:
    """A quantity and what it is compared with, in digits that differ where the two do."""
    return distinct(value, limit, lambda number, more: amount(number, unit, more))


def is_exact(value: float, limit: float, unit: str) -> bool:
    """Whether an error is so small that people read it as none: it is written as 0."""
    return amounts(value, limit, unit)[0].partition(" ")[0] == "0"


def percentages(value: float, limit: float) -> tuple[str, str]:
    """Two shares in percent, in digits that differ where the two do."""
    return distinct(value, limit, lambda share, more: f"{100 * share:.{1 + more}f} %")


def _short(value: float, more_digits: int, finest: float = FINEST) -> str:
    if not math.isfinite(value):
        return str(value)
    if more_digits:
        return f"{value:#.{3 + more_digits}g}"
    if 1e-3 <= abs(value) < 0.995:
        return f"{value:.2g}"
    if finest <= abs(value) < 1e-3:
        return f"{value:.4f}"
    if abs(value) < finest:
        return "0"
    return f"{value:.1f}" if abs(value) < 100 else f"{value:.0f}"
