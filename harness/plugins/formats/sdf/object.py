"""Converts a rigid body of SDF to an object."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from harness.core.errors import collected
from harness.core.spatial import SE3
from harness.language.files.xml_file import XmlElement
from harness.language.world import ObjectSpec, PartKey, ShapeSpec
from harness.plugins.formats.fixture_words import part_model
from harness.plugins.formats.object_words import MassProperties, look_words, mass_words, together
from harness.plugins.formats.plain_values import pose_spec
from harness.plugins.formats.sdf.bodies import SdfBody, SdfJoint, SdfLink
from harness.plugins.formats.sdf.elements import note_unread_elements
from harness.plugins.formats.sdf.joints import part_joint
from harness.plugins.formats.sdf.masses import link_masses
from harness.plugins.formats.sdf.model_path import MissingFileError
from harness.plugins.formats.sdf.shapes import ShapeReader
from harness.plugins.formats.sdf.values import pose_of, validated

LONGEST_NAME = 100


def object_of(body: SdfBody, reader: ShapeReader) -> ObjectSpec | None:
    """The object; None, with a note, for a body without shapes and visuals."""
    first, (shapes, visuals, masses) = body.links[0], _contents(body, reader)
    if len(body.name) > LONGEST_NAME:
        first.element.refuse(f"the name '{body.name}' has more than {LONGEST_NAME} characters")
    if not shapes and not visuals:
        reader.notes.add(first.element.place, "a body without shapes and visuals is left out")
        return None
    words: dict[str, Any] = {"name": body.name, "pose": pose_spec(body.pose)}
    if body.is_static:
        words["static"] = True
    else:
        words |= mass_words(together(masses))
    return validated(ObjectSpec, {**words, **look_words(shapes, visuals)}, first.element)


def part_of(body: SdfBody, joint: SdfJoint, fixture: SE3, reader: ShapeReader) -> PartKey | None:
    """A body on its hinge or slide; None, with a note, for one that touches nothing.

    Args:
        body: The body that hangs on the joint.
        joint: The joint on which it hangs.
        fixture: T_world_fixture of the object that carries it.
        reader: The reader of the shapes, with its notes.
    """
    first = body.links[0]
    shapes, visuals, masses = _contents(replace(body, pose=fixture), reader)
    if not shapes:
        reader.notes.add(first.element.place, "a part of a fixture without collisions is left out")
        return None
    motion = part_joint(joint.scope, joint.name, joint.element, fixture, reader.notes)
    if motion.limits != motion.usable_limits:
        lower, upper = motion.usable_limits
        message = f"the joint '{joint.name}' is limited to {lower:g} to {upper:g} here"
        reader.notes.add(joint.element.place, message)
    return validated(part_model(), motion.words(shapes, visuals, together(masses)), joint.element)


def _contents(
    body: SdfBody, reader: ShapeReader
) -> tuple[list[ShapeSpec], list[ShapeSpec], list[MassProperties]]:
    """The shapes, the visuals and, where it moves, the masses of a body's links."""
    shapes: list[ShapeSpec] = []
    visuals: list[ShapeSpec] = []
    masses: list[MassProperties] = []
    for link in body.links:
        touched = _collisions(body, link, reader)
        shapes += [shape for _, shape in touched]
        visuals += _visuals(body, link, reader)
        note_unread_elements(link.element, "link", reader.notes)
        if not body.is_static:
            on_object = body.pose.inverse() @ link.pose
            masses.append(link_masses(link.element, touched, on_object, reader.notes))
    return shapes, visuals, masses


def _collisions(
    body: SdfBody, link: SdfLink, reader: ShapeReader
) -> list[tuple[XmlElement, ShapeSpec]]:
    def read(element: XmlElement) -> ShapeSpec | None:
        return reader.collision(element, link.scope.folder, _on_object(body, link, element))

    elements = link.element.findall("collision")
    shapes = collected(read, elements, MissingFileError)
    pairs = zip(elements, shapes, strict=True)
    return [(element, shape) for element, shape in pairs if shape is not None]


def _visuals(body: SdfBody, link: SdfLink, reader: ShapeReader) -> list[ShapeSpec]:
    shapes = [
        reader.visual(element, link.scope.folder, _on_object(body, link, element))
        for element in link.element.findall("visual")
    ]
    return [shape for shape in shapes if shape is not None]


def _on_object(body: SdfBody, link: SdfLink, element: XmlElement) -> SE3:
    """T_object_element of a collision or visual."""
    name = link.element.need("name").strip()
    in_scope = link.scope.pose_in(pose_of(element), name)
    return body.pose.inverse() @ link.scope.in_world() @ in_scope
