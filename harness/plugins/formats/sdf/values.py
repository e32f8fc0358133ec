"""Numbers, flags and poses of SDF, with located errors."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

from pydantic import ValidationError

from harness.core.spatial import SE3, wxyz_from_xyzw
from harness.language.base import LARGEST_NUMBER, SMALLEST_SIZE, SpecModel
from harness.language.files.xml_file import XmlElement
from harness.plugins.formats.plain_values import first_mistake

UNBOUNDED = ("mu", "mu2")  # elements in which worlds write 1e16 to exclude slip
M = TypeVar("M", bound=SpecModel)
TRUE, FALSE = ("true", "1"), ("false", "0")


@dataclass(frozen=True, eq=False)
class PlacedPose:
    """A pose in an SDF file.

    Attributes:
        relative_to: Name of a frame; empty for the element's default frame.
    """

    pose: SE3
    relative_to: str
    element: XmlElement


def numbers_of(element: XmlElement, count: int) -> tuple[float, ...]:
    """An element's numbers.

    Raises:
        SpecError: Their number is wrong, or one is not a finite number.
    """
    text = " ".join(element.text.split())
    try:
        values = tuple(float(word) for word in text.split())
    except ValueError:
        values = ()
    if len(values) != count or not all(map(math.isfinite, values)):
        expected = "a finite number" if count == 1 else f"{count} finite numbers"
        found = f"`{text[:60]}`" if text else "nothing"
        element.refuse(f"<{element.tag}>: expected {expected}, found {found}")
    for value in values:
        if abs(value) > LARGEST_NUMBER and element.tag not in UNBOUNDED:
            element.refuse(f"<{element.tag}>: {value:g} is too large; at most {LARGEST_NUMBER:g}")
    return values


def number(parent: XmlElement, tag: str, default: float) -> float:
    """The number of a child element, or a default without one."""
    child = parent.find(tag)
    return default if child is None else numbers_of(child, 1)[0]


def bound(parent: XmlElement, tag: str) -> float:
    """The limit in a child element; infinite without one, or where it is too large to be one."""
    child = parent.find(tag)
    try:
        value = math.inf if child is None else float(child.text)
    except ValueError:
        value = math.nan
    if math.isnan(value):
        (child or parent).refuse(f"<{tag}>: expected a number")
    return value if abs(value) <= LARGEST_NUMBER else math.inf


def positive(parent: XmlElement, tag: str) -> float:
    """The positive number of a required child element.

    Raises:
        SpecError: The child is missing, or its number is not above 0.
    """
    child = parent.find(tag)
    if child is None:
        parent.refuse(f"<{parent.tag}> lacks its <{tag}>")
    (value,) = numbers_of(child, 1)
    if value <= 0:
        child.refuse(f"<{tag}> of a <{parent.tag}> is above 0, not {value:g}")
    if value < SMALLEST_SIZE:
        child.refuse(f"<{tag}> of a <{parent.tag}> is at least {SMALLEST_SIZE:g}, not {value:g}")
    return value


def validated(model: type[M], words: Mapping[str, Any], element: XmlElement) -> M:
    """A part of a world, validated.

    Raises:
        SpecError: The model refuses a value; at the element.
    """
    try:
        return model.model_validate(words)
    except ValidationError as error:
        element.refuse(f"<{element.tag}>: {first_mistake(error)}")


def is_flag(parent: XmlElement, tag: str, default: bool = False) -> bool:
    """The flag of a child element, or a default without one.

    Raises:
        SpecError: It is none of true, false, 1, 0.
    """
    child = parent.find(tag)
    return default if child is None else is_true(child, child.text.strip())


def is_true(element: XmlElement, text: str) -> bool:
    """The value of a flag; an invalid flag is an error at the element."""
    word = text.lower()
    if word not in (*TRUE, *FALSE):
        element.refuse(f"`{text[:40]}` is neither true nor false")
    return word in TRUE


def text_of(parent: XmlElement, tag: str, default: str = "") -> str:
    """The text of a child element, or a default without one."""
    child = parent.find(tag)
    return default if child is None else child.text.strip()


def pose_of(parent: XmlElement) -> PlacedPose:
    """The pose of an element; identity without a `<pose>`.

    Raises:
        SpecError: The numbers do not match the rotation format.
    """
    element = parent.find("pose")
    if element is None:
        return PlacedPose(SE3.identity(), "", parent)
    # the attribute `frame` of SDF 1.5 and 1.6
    relative_to = element.get("relative_to") or element.get("frame")
    return PlacedPose(_se3(element), relative_to.strip(), element)


def _se3(element: XmlElement) -> SE3:
    form = element.get("rotation_format", "euler_rpy")
    is_in_degrees = is_true(element, element.get("degrees", "false"))
    if form not in ("euler_rpy", "quat_xyzw"):
        hint = "formats: euler_rpy, quat_xyzw"
        element.refuse(f"the rotation format `{form}` is not known", hint, at="rotation_format")
    if not element.text.strip():
        return SE3.identity()
    if form == "quat_xyzw":
        if is_in_degrees:
            element.refuse("`degrees` does not apply to a quaternion", at="degrees")
        values = numbers_of(element, 7)
        if math.hypot(*values[3:]) < 1e-6:
            element.refuse("a quaternion has norm 1, this one has norm 0", "no rotation is 0 0 0 1")
        return SE3.from_xyz_quat(values[:3], wxyz_from_xyzw(values[3:]))
    values = numbers_of(element, 6)
    rpy = [math.radians(value) for value in values[3:]] if is_in_degrees else values[3:]
    return SE3.from_xyz_rpy(values[:3], rpy)
