"""Links of SDF models as links of a URDF: mass properties and shapes."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from harness.core.errors import collected
from harness.core.spatial import SE3, rpy_from_rotation
from harness.language.files.xml_file import XmlElement
from harness.language.world import FrictionSpec, ShapeSpec
from harness.plugins.formats.sdf.elements import note_unread_elements
from harness.plugins.formats.sdf.masses import link_masses
from harness.plugins.formats.sdf.scope import SdfScope
from harness.plugins.formats.sdf.shapes import ShapeReader
from harness.plugins.formats.sdf.values import is_true, number, numbers_of, pose_of

SIZES = ("size", "radius", "length", "radii")  # Elements with the sizes of a shape
MOMENTS = {"ixx": 1.0, "ixy": 0.0, "ixz": 0.0, "iyy": 1.0, "iyz": 0.0, "izz": 1.0}
"""SDF's moments of inertia of a link that does not give them [kg m^2]."""


def element(source: XmlElement, tag: str, *children: XmlElement, **attributes: str) -> XmlElement:
    """An element of the URDF, at the place of one of the SDF."""
    return XmlElement(tag, attributes, source.place, list(children))


def placed(source: XmlElement, pose: SE3) -> XmlElement:
    """The `<origin>` of a pose."""
    xyz, rpy = text(*pose.translation), text(*rpy_from_rotation(pose.rotation))
    return element(source, "origin", xyz=xyz, rpy=rpy)


def text(*values: float) -> str:
    """Numbers with all their digits."""
    return " ".join(repr(float(value)) for value in values)


@dataclass(frozen=True, eq=False)
class LinkWriter:
    """Writes links.

    Attributes:
        frictions: The sliding friction coefficients of the links' surfaces.
    """

    reader: ShapeReader
    frictions: dict[str, float] = field(default_factory=dict[str, float])

    def link(self, scope: SdfScope, own: str, name: str, source: XmlElement) -> XmlElement:
        """A `<link>`.

        Args:
            own: The name of the link in its scope.
            name: The name of the link in the robot.

        Raises:
            SpecError: It has mistakes.
        """
        notes = self.reader.notes
        note_unread_elements(source, "link", notes)
        back = scope.locate(own, source).inverse()

        def read(item: XmlElement) -> tuple[XmlElement, SE3, ShapeSpec | None]:
            pose = back @ scope.pose_in(pose_of(item), own)
            if self._is_flat(item):
                return item, pose, None
            shape = self.reader.visual if item.tag == "visual" else self.reader.collision
            return item, pose, shape(item, scope.folder, pose)

        items = [item for item in source.children if item.tag in ("visual", "collision")]
        found = [(item, pose, s) for item, pose, s in collected(read, items) if s is not None]
        shapes = [self._shape(*each, name) for each in found]
        given = source.find("inertial") or element(source, "inertial")
        note_unread_elements(given, "inertial", notes)
        tensor = given.find("inertia") or given
        mass, pose = number(given, "mass", 1.0), back @ scope.pose_in(pose_of(given), own)
        moments = {key: number(tensor, key, value) for key, value in MOMENTS.items()}
        if is_true(given, given.get("auto", "false")):
            solids = [(item, shape) for item, _, shape in found if item.tag == "collision"]
            whole = link_masses(source, solids, SE3.identity(), notes)
            mass, pose = whole.mass, SE3.from_xyz_rpy(whole.center)
            moments = {
                key: whole.inertia["xyz".index(key[1]), "xyz".index(key[2])] for key in MOMENTS
            }
        elif tensor is given:
            what = "a link without <inertial> or <inertia> has 1 kg, if no mass is given, and"
            notes.add(given.place, f"{what} 1 kg m^2 about each axis, as SDF specifies")
        inertial = element(
            given,
            "inertial",
            placed(given, pose),
            element(given.find("mass") or given, "mass", value=text(mass)),
            element(tensor, "inertia", **{key: text(value) for key, value in moments.items()}),
        )
        return element(source, "link", *shapes, inertial, name=name)

    def _is_flat(self, item: XmlElement) -> bool:
        """Whether a shape has no thickness, which is noted."""
        geometry = self.reader.geometry(item)
        sizes = [each for each in geometry.children if each.tag in SIZES]
        values = [numbers_of(each, len(each.text.split()) or 1) for each in sizes]
        is_flat = geometry.tag == "plane" or any(0.0 in each for each in values)
        if is_flat:
            message = f"a <{geometry.tag}> of a <{item.tag}> has no thickness and is left out"
            self.reader.notes.add(geometry.place, message)
        return is_flat

    def _shape(self, item: XmlElement, pose: SE3, shape: ShapeSpec, link: str) -> XmlElement:
        """A visual or collision."""
        solids = {key: getattr(shape, key) for key in ("box", "cylinder", "sphere", "capsule")}
        kind, solid = next(((k, s) for k, s in solids.items() if s is not None), ("mesh", None))
        sizes = {} if solid is None else solid.model_dump(include={*SIZES})
        words = {key: text(*np.atleast_1d(value)) for key, value in sizes.items()}
        if shape.mesh is not None:
            scale = np.broadcast_to(shape.mesh.scale, 3)
            words = {"filename": shape.mesh.file, "scale": text(*scale)}
        geometry = self.reader.geometry(item)
        parts = [
            placed(item, pose),
            element(geometry, "geometry", element(geometry, kind, **words)),
        ]
        if shape.color is not None:
            color = element(item, "color", rgba=text(*shape.color))
            parts.append(element(item, "material", color))
        if isinstance(shape.friction, FrictionSpec):
            friction = shape.friction.sliding
            self.frictions[link] = min(friction, self.frictions.get(link, friction))
        return element(item, item.tag, *parts, name=item.get("name").strip())
