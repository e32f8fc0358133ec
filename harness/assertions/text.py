"""Numbers as a verdict's reason says them: millimetres, degrees, newtons."""

from __future__ import annotations

import math


def amount(value: float, unit: str) -> str:
    """A quantity for people: below a metre in mm, angles in degrees."""
    match unit:
        case "m" if abs(value) < 1:
            return f"{_short(value * 1e3)} mm"
        case "rad":
            return f"{_short(math.degrees(value))} deg"
        case "rad/s":
            return f"{_short(math.degrees(value))} deg/s"
        case "m/s" if abs(value) < 1:
            return f"{_short(value * 1e3)} mm/s"
        case "1":
            return _short(value)
        case _:
            return f"{_short(value)} {unit}"


def _short(value: float) -> str:
    if not math.isfinite(value):
        return str(value)
    if 1e-3 <= abs(value) < 0.05:
        return f"{value:.2g}"
    value = 0.0 if abs(value) < 1e-3 else value
    return f"{value:.1f}" if abs(value) < 100 else f"{value:.0f}"
