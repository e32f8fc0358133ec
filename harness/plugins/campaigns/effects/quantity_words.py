"""What people call a quantity that varies."""

from __future__ import annotations

from harness.reporting.suite.columns import VariedQuantity


def name_in_words(quantity: VariedQuantity) -> str:
    """Its path in words: `friction of cube` for `objects.cube.friction`."""
    owners = [part for part in quantity.path.split(".") if part not in ("objects", "params")]
    name = owners.pop() if owners else quantity.path
    return " of ".join([name.replace("_", " "), *reversed(owners)])


def axis_name(quantity: VariedQuantity) -> str:
    """The name of its axis, with its unit."""
    name = name_in_words(quantity)
    return f"{name} [{quantity.unit}]" if quantity.unit else name
