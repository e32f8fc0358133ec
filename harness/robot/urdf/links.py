"""A URDF's links: mass properties and shapes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np

from harness.core.errors import SpecError, collected
from harness.core.geometry import Box, Capsule, Cylinder, Geometry, Mesh, Rgba, Shape, Sphere
from harness.core.solids import TRIANGLE_SLACK
from harness.language.files.xml_file import XmlElement
from harness.robot.mechanism import Inertial, Link
from harness.robot.mesh_file import KINDS, SUFFIXES
from harness.robot.packages import NotFoundError, PackagePath
from harness.robot.urdf.values import lengths, number, pose, rgba, three

DEFAULT_RGBA: Rgba = (0.6, 0.6, 0.6, 1.0)
SMALLEST_RADIUS = 0.005
"""Radius of the solid sphere whose inertia is a lower bound of a link's inertia [m]."""


def possible_moments(moments: np.ndarray, mass: float) -> np.ndarray:
    """Principal moments, ascending, raised to those of a body of a mass, shape (3,) [kg m^2]."""
    least = 0.4 * mass * SMALLEST_RADIUS**2
    raised = np.maximum(moments, 0.0)
    if raised[0] < 1e-3 * least:
        raised = np.maximum(raised, least)
    lack = raised[2] - raised[0] - raised[1]
    if lack > TRIANGLE_SLACK * raised[2]:
        raised = raised + np.array([lack / 2, lack / 2, 0.0]) * (1 + 1e-9)
    return raised


def corrected_note(link: str, moments: np.ndarray, raised: np.ndarray) -> str:
    """The note on a link whose moments were raised."""
    return (
        f"link '{link}': no body has the principal moments of inertia "
        f"{', '.join(f'{value:.3g}' for value in moments)} kg m^2; taken as "
        f"{', '.join(f'{value:.3g}' for value in raised)}"
    )


@dataclass(frozen=True, eq=False)
class LinkReader:
    """Reads the links of one file.

    Attributes:
        undrawn: Collects the links of visuals that cannot be drawn, with the reason.
        sizeless: Collects the links of shapes without a thickness, with the shape.
    """

    folder: Path
    packages: PackagePath
    materials: Mapping[str, Rgba]
    notes: list[str] = field(default_factory=list[str])
    undrawn: list[tuple[str, str]] = field(default_factory=list[tuple[str, str]])
    sizeless: list[tuple[str, str]] = field(default_factory=list[tuple[str, str]])
    meshes: dict[Mesh, tuple[XmlElement, str]] = field(
        default_factory=dict[Mesh, tuple[XmlElement, str]]
    )

    def left_out(self) -> list[str]:
        """Notes on the shapes that are left out."""
        return [
            *(
                f"link '{link}': the {shape} has no thickness and is left out"
                for link, shape in dict.fromkeys(self.sizeless)
            ),
            *self._undrawn_note(),
        ]

    def _undrawn_note(self) -> list[str]:
        """One note on all visuals that are not drawn; empty where all are."""
        if not self.undrawn:
            return []
        link, reason = self.undrawn[0]
        if len(self.undrawn) == 1:
            return [f"link '{link}': the visual is not drawn: {reason}"]
        links = ", ".join(dict.fromkeys(each for each, _ in self.undrawn))
        return [f"{len(self.undrawn)} visuals are not drawn, of {links}; the first: {reason}"]

    def link(self, element: XmlElement) -> Link:
        """A link.

        Raises:
            SpecError: It has a mistake.
        """
        name = element.name()
        inertial = element.find("inertial")
        shape = partial(self._shape, link=name)
        visuals = collected(shape, element.findall("visual"))
        collisions = collected(shape, element.findall("collision"))
        return Link(
            name,
            None if inertial is None else self._inertial(inertial, name),
            tuple(shape for shape in visuals if shape is not None),
            tuple(shape for shape in collisions if shape is not None),
        )

    def _inertial(self, element: XmlElement, link: str) -> Inertial | None:
        """Mass properties with the tensor in link axes, of zeros where the file gives none.

        None for a mass of 0.
        """
        mass_element, tensor = element.find("mass"), element.find("inertia")
        if mass_element is None:
            element.refuse(f"link '{link}': <inertial> has no <mass>")
        mass = number(mass_element, "value")
        if mass < 0:
            mass_element.refuse(f"link '{link}' weighs {mass:g} kg", at="value")
        if mass == 0:
            return None
        placed = pose(element)
        if tensor is None:
            return Inertial(mass, placed.translation, np.zeros((3, 3)))
        xx, yy, zz = (number(tensor, key) for key in ("ixx", "iyy", "izz"))
        xy, xz, yz = (number(tensor, key, 0.0) for key in ("ixy", "ixz", "iyz"))
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        if not np.array_equal(placed.rotation, np.eye(3)):
            inertia = placed.rotation @ inertia @ placed.rotation.T
        return self._of_a_body(Inertial(mass, placed.translation, inertia), tensor, link)

    def _of_a_body(self, stated: Inertial, tensor: XmlElement, link: str) -> Inertial:
        """The properties with a physically possible tensor; one of zeros stays."""
        if not stated.inertia.any():
            return stated
        moments, axes = np.linalg.eigh(stated.inertia)
        if moments[0] < -moments[2]:
            tensor.refuse(
                f"link '{link}' has a negative moment of inertia, {moments[0]:.3g} kg m^2",
                "the tensor is about the centre of mass and positive definite; without <inertia>"
                " it is estimated from the shapes",
            )
        raised = possible_moments(moments, stated.mass)
        if np.array_equal(raised, moments):
            return stated
        self.notes.append(corrected_note(link, moments, raised))
        return replace(stated, inertia=axes @ np.diag(raised) @ axes.T, stated_moments=moments)

    def _shape(self, element: XmlElement, link: str) -> Shape | None:
        geometry = element.find("geometry")
        if geometry is None or len(geometry.children) != 1:
            element.refuse(f"link '{link}': <{element.tag}> has one <geometry> with one shape")
        found = self._geometry(geometry.children[0], link, element.tag)
        if found is None:
            return None
        material, color = element.find("material"), None
        colour = DEFAULT_RGBA
        if material is not None:
            color = material.find("color")
            known = self.materials.get(material.get("name"), DEFAULT_RGBA)
            colour = known if color is None else rgba(color)
        return Shape(found, pose(element), colour, element.get("name"))

    def _geometry(self, item: XmlElement, link: str, kind: str) -> Geometry | None:
        match item.tag:
            case "box" | "cylinder" | "sphere" | "capsule":
                found = _solid(item)
                if found is None:
                    self.sizeless.append((link, f"<{item.tag}> of a <{kind}>"))
                return found
            case "mesh":
                return self._mesh(item, link, kind)
            case _:
                hint = "known are box, cylinder, sphere, capsule, mesh"
                message = f"link '{link}': unknown geometry <{item.tag}>"
                raise SpecError([item.problem(message, hint)])

    def _mesh(self, item: XmlElement, link: str, kind: str) -> Mesh | None:
        name, is_visual = item.need("filename"), kind == "visual"
        scale = three(item, "scale", (1.0, 1.0, 1.0))
        if 0 in scale:
            self.sizeless.append((link, f"<mesh> of a <{kind}>"))
            return None
        if Path(name).suffix.lower() not in SUFFIXES:
            if is_visual:
                self.undrawn.append((link, f"'{name}' is not a {KINDS} file"))
                return None
            item.refuse(f"link '{link}': '{name}' is not a {KINDS} file", at="filename")
        try:
            path = self.packages.file(name, self.folder)
        except NotFoundError as error:
            if is_visual:
                self.undrawn.append((link, str(error)))
                return None
            item.refuse(f"link '{link}': mesh {error}", at="filename")
        mesh = Mesh(path, scale)
        if not is_visual:
            self.meshes.setdefault(mesh, (item, link))
        return mesh


def _solid(item: XmlElement) -> Geometry | None:
    """A primitive shape; None for one without a thickness."""
    if item.tag == "box":
        x, y, z = lengths(item, "size")
        return Box((x, y, z)) if min(x, y, z) else None
    if item.tag == "sphere":
        (radius,) = lengths(item, "radius")
        return Sphere(radius) if radius else None
    radius, length = lengths(item, "radius", "length")
    if item.tag == "cylinder":
        return Cylinder(radius, length) if radius and length else None
    if not radius:
        return None
    return Capsule(radius, length) if length else Sphere(radius)
