"""Reads hinges and slides of SDF: their axes, limits, friction, damping and springs."""

from __future__ import annotations

from typing import Literal

import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.language.files.xml_file import XmlElement
from harness.plugins.formats.fixture_words import PartJoint
from harness.plugins.formats.notes import Notes
from harness.plugins.formats.sdf.elements import note_unread_elements
from harness.plugins.formats.sdf.scope import SdfScope
from harness.plugins.formats.sdf.values import bound, is_flag, number, numbers_of

KINDS: dict[str, Literal["hinge", "slide"]] = {
    "revolute": "hinge",
    "continuous": "hinge",
    "prismatic": "slide",
}


def joint_axis(scope: SdfScope, name: str, element: XmlElement) -> tuple[XmlElement, FloatArray]:
    """The `<axis>` of a joint, and its unit direction in the frame of the model.

    Raises:
        SpecError: There is none, it has no length, or its frame is unknown.
    """
    axis = element.find("axis")
    if axis is None:
        element.refuse("this joint lacks its <axis>")
    given = axis.find("xyz")
    direction = np.array((0.0, 0.0, 1.0) if given is None else numbers_of(given, 3))
    length = float(np.linalg.norm(direction))
    if length < 1e-9:
        (given or axis).refuse("an axis must not be 0 0 0")
    expressed = "" if given is None else given.get("expressed_in").strip()
    if not expressed and is_flag(axis, "use_parent_model_frame"):
        return axis, direction / length
    frame = scope.locate(expressed or name, element)
    return axis, frame.rotation @ direction / length


def part_joint(
    scope: SdfScope, name: str, element: XmlElement, fixture: SE3, notes: Notes
) -> PartJoint:
    """A joint whose parent stands still, in the frame of what carries it.

    Args:
        scope: The model with the joint.
        name: The name of the joint in the model.
        element: The element of the joint.
        fixture: T_world_fixture of the object that carries the part.
        notes: Gets what has no effect.

    Raises:
        SpecError: A number is none, or the axis has no length.
    """
    axis, direction = joint_axis(scope, name, element)
    place = scope.in_world() @ scope.locate(name, element)
    note_unread_elements(axis, "axis", notes)
    limit, dynamics = axis.find("limit"), axis.find("dynamics")
    lower = upper = np.inf
    if limit is not None and element.need("type").strip() != "continuous":
        note_unread_elements(limit, "limit", notes)
        lower, upper = bound(limit, "lower"), bound(limit, "upper")
    values = dict.fromkeys(("friction", "damping", "spring_stiffness", "spring_reference"), 0.0)
    if dynamics is not None:
        note_unread_elements(dynamics, "dynamics", notes)
        values = {tag: number(dynamics, tag, 0.0) for tag in values}
    back = fixture.inverse()
    return PartJoint(
        name=name,
        kind=KINDS[element.need("type").strip()],
        axis=back.rotation @ scope.in_world().rotation @ direction,
        point=back.apply(place.translation),
        limits=(lower if np.isfinite(lower) else -np.inf, upper),
        friction=values["friction"],
        damping=values["damping"],
        stiffness=values["spring_stiffness"],
        rest=values["spring_reference"],
    )
