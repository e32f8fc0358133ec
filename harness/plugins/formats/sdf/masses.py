"""Mass and inertia of SDF links, and of objects of several links."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.core.solids import is_inertia_of_a_body, solid_of
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.language.files.xml_file import XmlElement
from harness.language.world import ShapeSpec
from harness.plugins.formats.notes import Notes
from harness.plugins.formats.object_words import MassProperties, together
from harness.plugins.formats.sdf.elements import note_unread_elements
from harness.plugins.formats.sdf.values import is_true, number, pose_of
from harness.world.objects import primitive

WATER = 1000.0  # default density of an automatic inertial in SDF 1.11 [kg/m^3]


def link_masses(
    link: XmlElement, shapes: Sequence[tuple[XmlElement, ShapeSpec]], T_object_link: SE3,
    notes: Notes,
) -> MassProperties:  # fmt: skip
    """Mass properties of a link, in the object's frame.

    Args:
        shapes: Its collisions with their shapes on the object, for automatic inertia.

    Raises:
        SpecError: No rigid body can have these properties.
    """
    inertial = link.find("inertial")
    if inertial is None:
        notes.add(link.place, "a <link> without <inertial> has 1 kg and 1 kg m^2, as SDF specifies")
        return MassProperties(1.0, np.zeros(3), np.eye(3)).placed(T_object_link)
    note_unread_elements(inertial, "inertial", notes)
    if is_true(inertial, inertial.get("auto", "false")):
        return _automatic(inertial, shapes)
    mass = number(inertial, "mass", 1.0)
    if mass <= 0:
        (inertial.find("mass") or inertial).refuse(
            f"a movable link has a mass above 0, not {mass:g} kg", "or add <static>true</static>"
        )
    if inertial.find("inertia") is None:
        message = "an <inertial> without <inertia> has 1 kg m^2 about each axis, as SDF specifies"
        notes.add(inertial.place, message)
    tensor = _tensor(inertial)
    own = MassProperties(mass, np.zeros(3), tensor).placed(pose_of(inertial).pose)
    return own.placed(T_object_link)


def _tensor(inertial: XmlElement) -> FloatArray:
    element = inertial.find("inertia")
    if element is None:
        return np.eye(3)
    xx, yy, zz = (number(element, tag, 1.0) for tag in ("ixx", "iyy", "izz"))
    xy, xz, yz = (number(element, tag, 0.0) for tag in ("ixy", "ixz", "iyz"))
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if not is_inertia_of_a_body(tensor):
        least, middle, most = (float(moment) for moment in np.linalg.eigvalsh(tensor))
        element.refuse(
            f"no rigid body has this inertia: its principal moments are {least:.6g}, {middle:.6g}"
            f" and {most:.6g} kg m^2",
            "each must be above 0 and at most the sum of the others",
        )
    return tensor


def _automatic(
    inertial: XmlElement, shapes: Sequence[tuple[XmlElement, ShapeSpec]]
) -> MassProperties:
    """Mass properties from the collisions and their densities; an explicit mass scales them."""
    density = number(inertial, "density", WATER)
    parts: list[MassProperties] = []
    for collision, spec in shapes:
        solid = None if (kind := primitive(spec)) is None else solid_of(kind)
        if solid is None:
            hint = "add <mass> and <inertia>"
            collision.refuse("automatic inertia needs boxes, cylinders, spheres or capsules", hint)
        volume, tensor = solid
        own = number(collision, "density", density)
        if own <= 0:
            collision.refuse(f"a density is above 0, not {own:g}")
        pose = spec.pose.se3()
        turned = pose.rotation @ tensor @ pose.rotation.T
        parts.append(MassProperties(own * volume, pose.translation, own * turned))
    if not parts:
        inertial.refuse("automatic inertia needs collisions, and the link has none")
    whole = together(parts)
    scale = number(inertial, "mass", whole.mass) / whole.mass
    if scale <= 0:
        inertial.refuse("a mass is above 0")
    return MassProperties(whole.mass * scale, whole.center, whole.inertia * scale)
