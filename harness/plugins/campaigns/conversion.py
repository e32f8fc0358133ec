"""Conversion of units."""

from __future__ import annotations

from harness.language.files.mistakes import MistakeError
from harness.language.units import MEANINGS, in_si


def conversion_factor(unit: str, target: str) -> float | None:
    """The factor from one unit to another; None where they measure different things.

    Args:
        unit: A unit, or empty text for the SI unit of what `target` measures.
        target: A unit, or empty text for the SI unit of what `unit` measures.
    """
    if unit == target:
        return 1.0
    for si_unit in MEANINGS:
        try:
            factors = [
                1.0 if not each else in_si(f"1 {each}", (si_unit,)) for each in (unit, target)
            ]
        except MistakeError:
            continue
        return factors[0] / factors[1]
    return None
