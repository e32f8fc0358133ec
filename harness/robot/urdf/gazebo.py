"""Friction of links in a URDF's `<gazebo reference="LINK">` elements."""

from __future__ import annotations

import math

from harness.language.base import LARGEST_NUMBER
from harness.language.files.xml_file import XmlElement

COEFFICIENTS = ("mu1", "mu2")  # Sliding friction along the two directions of a surface


def link_frictions(root: XmlElement) -> dict[str, float]:
    """The sliding friction coefficient by link: the smaller of its two directions.

    A value that is no number is left out, as these elements are for another program.
    """
    found: dict[str, float] = {}
    for item in root.findall("gazebo"):
        values = [
            value
            for tag in COEFFICIENTS
            for child in item.findall(tag)
            if (value := _coefficient(child.get("value") or child.text)) is not None
        ]
        if values and item.get("reference"):
            found[item.get("reference")] = min(values)
    return found


def _coefficient(text: str) -> float | None:
    """A coefficient of friction; None for a text that is none."""
    try:
        value = float(text)
    except ValueError:
        return None
    return min(value, LARGEST_NUMBER) if value >= 0 and not math.isnan(value) else None
