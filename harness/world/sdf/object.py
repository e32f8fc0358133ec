"""Converts a rigid body of SDF to an object."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from harness.core.errors import collected
from harness.core.spatial import SE3
from harness.language.files.xml_file import XmlElement
from harness.language.poses import Pose
from harness.language.world import FrictionSpec, InertiaSpec, ObjectSpec, ShapeSpec
from harness.world.plain_values import pose_spec, rounded, significant
from harness.world.sdf.bodies import SdfBody, SdfLink
from harness.world.sdf.elements import note_unread_elements
from harness.world.sdf.masses import MassProperties, link_masses, together
from harness.world.sdf.model_path import MissingFileError
from harness.world.sdf.shapes import ShapeReader
from harness.world.sdf.values import pose_of

GEOMETRIES = ("box", "cylinder", "sphere", "capsule", "plane", "mesh")
LONGEST_NAME = 100


def object_of(body: SdfBody, reader: ShapeReader) -> ObjectSpec | None:
    """The object; None, with a note, for a body without shapes and visuals."""
    first = body.links[0]
    if len(body.name) > LONGEST_NAME:
        first.element.refuse(f"the name '{body.name}' has more than {LONGEST_NAME} characters")
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
    if not shapes and not visuals:
        reader.notes.add(first.element.place, "a body without shapes and visuals is left out")
        return None
    words: dict[str, Any] = {"name": body.name, "pose": pose_spec(body.pose)}
    if body.is_static:
        words["static"] = True
    else:
        words |= _masses(together(masses))
    return ObjectSpec(**words, **_looks(shapes, visuals))


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


def _masses(whole: MassProperties) -> dict[str, Any]:
    tensor = whole.inertia
    places = {"ixx": (0, 0), "iyy": (1, 1), "izz": (2, 2)}
    places |= {"ixy": (0, 1), "ixz": (0, 2), "iyz": (1, 2)}
    smallest = 1e-14 * float(np.abs(tensor).max())
    moments = {
        key: significant(tensor[place]) if abs(tensor[place]) > smallest else 0.0
        for key, place in places.items()
    }
    x, y, z = (rounded(value) for value in whole.center)
    return {
        "mass": significant(whole.mass),
        "center_of_mass": (x, y, z),
        "inertia": InertiaSpec(**moments),
    }


def _looks(shapes: list[ShapeSpec], visuals: list[ShapeSpec]) -> dict[str, Any]:
    """Shapes, visuals, friction and colour, written once where shapes share them."""
    words: dict[str, Any] = {}
    colored = _colored(shapes, visuals)
    if colored is not None:
        shapes, visuals = colored, []
    friction = Counter(shape.friction for shape in shapes).most_common(1)[0][0] if shapes else None
    words["friction"] = _short(friction)
    default = FrictionSpec()
    shapes = [
        shape.model_copy(
            update={
                "friction": None
                if (shape.friction or default) == (friction or default)
                else _short(shape.friction or default)
            }
        )
        for shape in shapes
    ]
    colors = {shape.color for shape in (*shapes, *visuals)}
    if len(colors) == 1:
        (words["color"],) = colors
        shapes = [shape.model_copy(update={"color": None}) for shape in shapes]
        visuals = [shape.model_copy(update={"color": None}) for shape in visuals]
    shapes, visuals = _unnamed(shapes), _unnamed(visuals)
    words["visuals"] = tuple(visuals)
    if len(shapes) == 1 and shapes[0].pose == Pose() and shapes[0].color is None:
        words |= {kind: getattr(shapes[0], kind) for kind in GEOMETRIES}
    else:
        words["shapes"] = tuple(shapes)
    return words


def _unnamed(shapes: list[ShapeSpec]) -> list[ShapeSpec]:
    """The shapes; a single shape has no name."""
    return [shapes[0].model_copy(update={"name": None})] if len(shapes) == 1 else shapes


def _colored(shapes: list[ShapeSpec], visuals: list[ShapeSpec]) -> list[ShapeSpec] | None:
    """The shapes with the colours of equal visuals; None when the shapes differ."""
    if len(shapes) != len(visuals):
        return None
    rest = list(visuals)
    colored: list[ShapeSpec] = []
    for shape in shapes:
        same = next((visual for visual in rest if _form(visual) == _form(shape)), None)
        if same is None:
            return None
        rest.remove(same)
        colored.append(shape.model_copy(update={"color": same.color}))
    return colored


def _form(shape: ShapeSpec) -> tuple[object, ...]:
    return (shape.pose, *(getattr(shape, kind) for kind in GEOMETRIES))


def _short(friction: FrictionSpec | float | None) -> FrictionSpec | float | None:
    """Friction without its default values; None when all are defaults."""
    if not isinstance(friction, FrictionSpec):
        return friction
    if friction == FrictionSpec():
        return None
    if friction == FrictionSpec(sliding=friction.sliding):
        return friction.sliding
    return friction
