"""Shapes of SDF collisions and visuals, with their colour and friction."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.errors import RobotError, SpecError
from harness.core.files import is_file
from harness.core.geometry import Mesh, Rgba
from harness.core.spatial import SE3
from harness.language.base import LARGEST_NUMBER, SMALLEST_SIZE
from harness.language.files.xml_file import XmlElement
from harness.language.world import FrictionSpec, MeshSpec, ShapeSpec
from harness.plugins.formats.notes import Notes
from harness.plugins.formats.plain_values import facing, pose_spec, rounded
from harness.plugins.formats.sdf.elements import READ, note_unread_elements
from harness.plugins.formats.sdf.model_path import MissingFileError, ModelPath
from harness.plugins.formats.sdf.round_meshes import cone, ellipsoid
from harness.plugins.formats.sdf.values import number, numbers_of, positive, text_of
from harness.robot.mesh_file import convex_hull

PLAIN_COLORS: Mapping[str, Rgba] = {
    "Grey": (0.7, 0.7, 0.7, 1.0),
    "DarkGrey": (0.175, 0.175, 0.175, 1.0),
    "White": (1.0, 1.0, 1.0, 1.0),
    "FlatBlack": (0.1, 0.1, 0.1, 1.0),
    "Black": (0.0, 0.0, 0.0, 1.0),
    "Red": (1.0, 0.0, 0.0, 1.0),
    "Green": (0.0, 1.0, 0.0, 1.0),
    "Blue": (0.0, 0.0, 1.0, 1.0),
    "Yellow": (1.0, 1.0, 0.0, 1.0),
    "Purple": (1.0, 0.0, 1.0, 1.0),
    "Turquoise": (0.0, 1.0, 1.0, 1.0),
    "Orange": (1.0, 0.5088, 0.0468, 1.0),
}
"""Diffuse colours of material scripts called `Gazebo/...`: gazebo.material of Gazebo classic 11."""

SHAPES = READ["geometry"]  # what a collision can be

DEFAULT_TORSIONAL = FrictionSpec().torsional


@dataclass(frozen=True, eq=False)
class ShapeReader:
    """Reads shapes, finds mesh files and collects notes."""

    model_path: ModelPath
    notes: Notes
    checks_meshes: bool = True  # whether a mesh that nothing can touch is refused

    def collision(self, element: XmlElement, folder: Path, pose: SE3) -> ShapeSpec | None:
        """A collision shape; None for an empty geometry.

        Args:
            folder: Folder of its file.
            pose: The pose T_object_collision of the shape.

        Raises:
            SpecError: Its geometry is invalid or not supported.
        """
        note_unread_elements(element, "collision", self.notes)
        geometry = self.geometry(element)
        if geometry.tag == "empty":
            return None
        if geometry.tag not in SHAPES:
            hint = f"shapes: {', '.join(SHAPES)}"
            geometry.refuse(f"a collision cannot be a <{geometry.tag}>", hint)
        shape = self._shape(element, geometry, folder, pose, friction=self._friction(element))
        if self.checks_meshes and geometry.tag == "mesh" and shape.mesh is not None:
            _refuse_untouchable(shape.mesh, geometry)
        return shape

    def visual(self, element: XmlElement, folder: Path, pose: SE3) -> ShapeSpec | None:
        """A visual shape; None when it is empty or cannot be drawn."""
        note_unread_elements(element, "visual", self.notes)
        geometry = self.geometry(element)
        color = self._color(element)
        if geometry.tag not in SHAPES:
            self.notes.add(geometry.place, f"a <{geometry.tag}> of a visual is not drawn")
            return None
        if geometry.tag == "empty":
            return None
        try:
            return self._shape(element, geometry, folder, pose, color=color)
        except SpecError as error:
            if geometry.tag != "mesh":
                raise
            self.notes.add(geometry.place, f"a visual is not drawn: {error.problems[0].message}")
            return None

    def geometry(self, element: XmlElement) -> XmlElement:
        """The element of a collision's or visual's shape."""
        geometry = element.find("geometry")
        if geometry is None or not geometry.children:
            element.refuse(f"a <{element.tag}> has a <geometry> with one shape")
        return geometry.children[0]

    def _shape(
        self, element: XmlElement, geometry: XmlElement, folder: Path, pose: SE3, **more: Any
    ) -> ShapeSpec:
        words: dict[str, Any] = {key: value for key, value in more.items() if value is not None}
        match geometry.tag:
            case "box":
                words["box"] = {"size": _sizes(geometry, "size")}
            case "sphere":
                words["sphere"] = {"radius": positive(geometry, "radius")}
            case "cylinder" | "capsule":
                words[geometry.tag] = {
                    "radius": positive(geometry, "radius"),
                    "length": positive(geometry, "length"),
                }
            case "cone":
                words["mesh"] = cone(positive(geometry, "radius"), positive(geometry, "length"))
            case "ellipsoid":
                words["mesh"] = ellipsoid(_sizes(geometry, "radii"))
            case "plane":
                words["plane"] = {}
                pose = pose @ _facing(geometry)
            case _:
                words["mesh"] = self._mesh(geometry, folder)
        words["name"] = element.get("name").strip()[:100] or None
        return ShapeSpec(pose=pose_spec(pose), **words)

    def _mesh(self, element: XmlElement, folder: Path) -> MeshSpec:
        note_unread_elements(element, "mesh", self.notes)
        uri = element.find("uri")
        if uri is None:
            element.refuse("a <mesh> has a <uri>")
        path = self.model_path.find(uri.text.strip(), uri, folder)
        if not is_file(path):
            raise MissingFileError([uri.problem(f"`{uri.text.strip()}` is not a file")])
        scale = element.find("scale")
        values = (1.0, 1.0, 1.0) if scale is None else numbers_of(scale, 3)
        if 0 in values:
            element.refuse("a mesh with the scale 0 has no size")
        x, y, z = values
        return MeshSpec(file=str(path.absolute()), scale=x if x == y == z else (x, y, z))

    def _friction(self, collision: XmlElement) -> FrictionSpec | None:
        """The friction of a collision; None when it is not given."""
        surface = collision.find("surface")
        if surface is None:
            return None
        note_unread_elements(surface, "surface", self.notes)
        friction = surface.find("friction")
        if friction is None:
            return None
        note_unread_elements(friction, "friction", self.notes)
        sliding, torsional = 1.0, DEFAULT_TORSIONAL
        ode, about_normal = friction.find("ode"), friction.find("torsional")
        if ode is not None:
            sliding = min(_not_negative(ode, "mu", 1.0), LARGEST_NUMBER)
            self._note_all_but_equal_mu2(ode, sliding)
        if about_normal is not None:
            note_unread_elements(about_normal, "friction/torsional", self.notes)
            radius = _not_negative(about_normal, "patch_radius", 0.0)
            coefficient = _not_negative(about_normal, "coefficient", 1.0)
            if radius > 0:
                # torque of a round patch under Hertzian pressure: 3 pi / 16 of radius and force
                torsional = rounded(3 * math.pi / 16 * radius * coefficient)
        return FrictionSpec(sliding=sliding, torsional=torsional)

    def _note_all_but_equal_mu2(self, ode: XmlElement, sliding: float) -> None:
        if number(ode, "mu2", sliding) == sliding:
            rest = [child for child in ode.children if child.tag != "mu2"]
            ode = XmlElement(ode.tag, ode.attributes, ode.place, rest, ode.text)
        note_unread_elements(ode, "friction/ode", self.notes)

    def _color(self, visual: XmlElement) -> Rgba | None:
        """The colour of a visual; None without a colour or with a texture alone."""
        opacity = 1.0 - min(1.0, max(0.0, number(visual, "transparency", 0.0)))
        material = visual.find("material")
        color: Rgba | None = None
        if material is not None:
            note_unread_elements(material, "material", self.notes)
            color = self._material(material)
        if color is None:
            return None if opacity == 1.0 else (0.7, 0.7, 0.7, opacity)
        return (*color[:3], rounded(color[3] * opacity))

    def _material(self, material: XmlElement) -> Rgba | None:
        for tag in ("diffuse", "ambient"):
            element = material.find(tag)
            if element is not None:
                count = 4 if len(element.text.split()) != 3 else 3
                values = [min(1.0, max(0.0, value)) for value in numbers_of(element, count)]
                red, green, blue, alpha = (*values, 1.0)[:4]
                return red, green, blue, alpha
        script = material.find("script")
        if script is None:
            return None
        name = text_of(script, "name") or script.text.strip()
        color = PLAIN_COLORS.get(name.removeprefix("Gazebo/"))
        if color is None:
            self.notes.add(script.place, f"the material script `{name}` is not a plain colour")
        return color


def _sizes(shape: XmlElement, tag: str) -> tuple[float, float, float]:
    """The three sizes of a box or an ellipsoid [m]."""
    element = shape.find(tag)
    if element is None:
        shape.refuse(f"a <{shape.tag}> lacks its <{tag}>")
    x, y, z = numbers_of(element, 3)
    if min(x, y, z) <= 0:
        element.refuse(f"<{tag}> of a <{shape.tag}> is above 0, not {element.text.strip()}")
    if min(x, y, z) < SMALLEST_SIZE:
        element.refuse(f"<{tag}> of a <{shape.tag}> is at least {SMALLEST_SIZE:g}")
    return x, y, z


def _refuse_untouchable(spec: MeshSpec, element: XmlElement) -> None:
    x, y, z = spec.scale if isinstance(spec.scale, tuple) else (spec.scale,) * 3
    try:
        convex_hull(Mesh(Path(spec.file), (x, y, z)))
    except RobotError as error:
        (element.find("uri") or element).refuse(str(error))


def _not_negative(parent: XmlElement, tag: str, default: float) -> float:
    value = number(parent, tag, default)
    if value < 0:
        parent.refuse(f"<{tag}> is 0 or more, not {value:g}")
    return value


def _facing(plane: XmlElement) -> SE3:
    """The rotation that turns z to a plane's normal."""
    normal = plane.find("normal")
    values = np.array((0.0, 0.0, 1.0) if normal is None else numbers_of(normal, 3))
    length = float(np.linalg.norm(values))
    if normal is not None and length < 1e-9:
        normal.refuse("a normal must not be 0 0 0")
    return SE3(facing(values / length), np.zeros(3))
