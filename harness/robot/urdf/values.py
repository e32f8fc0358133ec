"""Numbers and poses of a robot's XML, with located errors."""

from __future__ import annotations

import math

from harness.core.geometry import Rgba
from harness.core.spatial import SE3
from harness.language.base import LARGEST_NUMBER, SMALLEST_SIZE
from harness.language.files.xml_file import XmlElement

Three = tuple[float, float, float]


def number(element: XmlElement, name: str, default: float | None = None) -> float:
    """A finite number in an attribute, which is required without a default."""
    text = element.need(name) if default is None else element.get(name, repr(default))
    if name not in element.attributes and default is not None:
        return default
    values = _floats(text)
    if values is None or len(values) != 1:
        element.refuse(f"'{text}' is not a finite number", at=name)
    return values[0]


def bounded_value(element: XmlElement) -> float:
    """The number in the attribute `value`, as large as a scenario may have one."""
    value = number(element, "value")
    _refuse_beyond(element, "value", value)
    return value


def text_number(element: XmlElement) -> float:
    """A finite number that is an element's text."""
    values = _floats(element.text)
    if values is None or len(values) != 1:
        element.refuse(f"'{element.text.strip()}' is not a finite number")
    return values[0]


def three(element: XmlElement, name: str, default: Three | None = None) -> Three:
    """Three finite numbers in an attribute."""
    if default is not None and name not in element.attributes:
        return default
    text = element.need(name)
    values = _floats(text)
    if values is None or len(values) != 3:
        element.refuse(f"expected 3 finite numbers, found '{text}'", at=name)
    _refuse_beyond(element, name, *values)
    return values[0], values[1], values[2]


def lengths(element: XmlElement, *names: str) -> tuple[float, ...]:
    """The lengths in attributes; zero for those too small to be a size.

    Raises:
        SpecError: One is missing, no finite number, negative or too large.
    """
    found: list[float] = []
    for name in names:
        values = three(element, name) if name == "size" else (number(element, name),)
        for value in values:
            if value < 0:
                element.refuse(f"{name} is {value:g}; it has to be above zero", at=name)
            _refuse_beyond(element, name, value)
            found.append(0.0 if value < SMALLEST_SIZE else value)
    return tuple(found)


def _refuse_beyond(element: XmlElement, name: str, *values: float) -> None:
    for value in values:
        if abs(value) > LARGEST_NUMBER:
            element.refuse(f"{value:g} is too large; at most {LARGEST_NUMBER:g}", at=name)


def rgba(color: XmlElement) -> Rgba:
    """The colour of a `<color>`."""
    values = _floats(color.need("rgba"))
    if values is None or len(values) != 4:
        color.refuse(f"expected 4 finite numbers, found '{color.get('rgba')}'", at="rgba")
    red, green, blue, alpha = (min(max(value, 0.0), 1.0) for value in values)
    return red, green, blue, alpha


def pose(element: XmlElement) -> SE3:
    """The pose of an element's `<origin>`; identity without one."""
    origin = element.find("origin")
    if origin is None:
        return SE3.identity()
    return SE3.from_xyz_rpy(
        three(origin, "xyz", (0.0, 0.0, 0.0)), three(origin, "rpy", (0.0, 0.0, 0.0))
    )


def _floats(text: str) -> list[float] | None:
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        return None
    return values if all(map(math.isfinite, values)) else None
