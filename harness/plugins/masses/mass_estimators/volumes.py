"""Masses of links whose file gives none, from the volume of their shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np

from harness.core.geometry import Mesh, Shape
from harness.core.solids import point_inertia
from harness.robot.collision_shapes import collision_shapes
from harness.robot.estimated_masses import MassEstimator
from harness.robot.mechanism import Inertial, Link
from harness.robot.mesh_file import hull_solid, shape_solid
from harness.robot.tree import carried_by, carriers
from harness.robot.urdf.links import corrected_note, possible_moments
from harness.robot.urdf.urdf import Urdf

DENSITY = 1000.0
"""Density of links without a mass [kg/m^3]; hulls of arms of 5 to 30 kg have 600 to 1500."""

BEAD, BEAD_RADIUS = 1e-3, 0.01
"""Mass of an empty link that moves, as a share of what it carries; its radius [m]."""

LEAF = 1e-3
"""Mass of an empty link that moves and carries nothing [kg]; as little as that of a frame."""


class Volumes(MassEstimator):
    """Masses from the volume of links' shapes; a mass alone gets the tensor of the shapes."""

    name: ClassVar[str] = "volumes"

    def with_masses(self, urdf: Urdf) -> Urdf:
        return _with_masses(urdf)


def _with_masses(urdf: Urdf) -> Urdf:
    notes: list[str] = []
    shaped_only: list[str] = []
    links = tuple(_with_tensor(link, shaped_only, notes) for link in urdf.links)
    urdf = replace(urdf, links=links)
    if shaped_only:
        names = ", ".join(shaped_only)
        notes.append(f"no inertia is given for {names}: that of their shapes at their masses")
    carrier = carriers(urdf.joints, urdf.root)
    groups: dict[str, list[Link]] = {}
    for link in urdf.links:
        groups.setdefault(carrier[link.name], []).append(link)
    estimated: dict[str, Link] = {}
    empty: list[str] = []
    for first, links in groups.items():
        if first == urdf.root or any(link.inertial for link in links):
            continue
        shaped = {link.name: _with_mass(link) for link in links if link.collisions or link.visuals}
        estimated |= shaped
        if not shaped:
            empty.append(first)
    if estimated:
        total = sum(link.inertial.mass for link in estimated.values() if link.inertial)
        notes.append(
            f"no mass is given for {', '.join(estimated)}: {total:.3g} kg in all, from the volume "
            f"of their shapes at {DENSITY:g} kg/m^3"
        )
    urdf = replace(urdf, links=tuple(estimated.get(link.name, link) for link in urdf.links))
    carried = {first: _carried(urdf, first) for first in empty}
    for names, mass in (
        ([name for name, mass in carried.items() if mass], f"{BEAD:.1%} of what they carry"),
        ([name for name, mass in carried.items() if not mass], f"{LEAF:g} kg, for they carry none"),
    ):
        if names:
            notes.append(f"moving links without a mass and a shape get {mass}: {', '.join(names)}")
    links = tuple(
        replace(link, inertial=_bead(BEAD * carried[link.name] or LEAF))
        if link.name in carried
        else link
        for link in urdf.links
    )
    return replace(urdf, links=links, notes=(*urdf.notes, *notes))


def _with_tensor(link: Link, shaped_only: list[str], notes: list[str]) -> Link:
    """A link whose mass has an inertia tensor, which is that of its shapes if none is given.

    Its name is then added to `shaped_only`.
    """
    inertial = link.inertial
    if inertial is None or inertial.inertia.any():
        return link
    if link.collisions or link.visuals:
        shapes = _with_mass(link).inertial
        assert shapes is not None
        inertia = shapes.inertia * (inertial.mass / shapes.mass)
        shaped_only.append(link.name)
    else:
        moments = possible_moments(np.zeros(3), inertial.mass)
        notes.append(corrected_note(link.name, np.zeros(3), moments))
        inertia = np.diag(moments)
    return replace(link, inertial=replace(inertial, inertia=inertia))


def _carried(urdf: Urdf, link: str) -> float:
    """Mass of the links distal to a link [kg]."""
    distal = carried_by([link], urdf.joints)
    return sum(each.inertial.mass for each in urdf.links if each.inertial and each.name in distal)


def _bead(mass: float) -> Inertial:
    """A small solid sphere at a link's origin, which physics requires of a link that moves."""
    return Inertial(mass, np.zeros(3), 0.4 * mass * BEAD_RADIUS**2 * np.eye(3))


def _with_mass(link: Link) -> Link:
    solids = [solid for shape in link.collisions for solid in _solids(shape)]
    return replace(link, inertial=solid_inertial(solids or [*map(_hull, link.visuals)]))


def _hull(shape: Shape) -> Shape:
    """A shape, where a mesh is no more than its hull: what is only seen is not cut into parts."""
    if not isinstance(shape.geometry, Mesh):
        return shape
    return replace(shape, geometry=replace(shape.geometry, collision="hull"))


def _solids(shape: Shape) -> Sequence[Shape]:
    """A shape's convex parts, or its hull where parts overlap so much that they are larger.

    They are the same however the shape collides, and so is the mass.
    """
    mesh = shape.geometry
    if not isinstance(mesh, Mesh):
        return [shape]
    parts = collision_shapes([replace(shape, geometry=replace(mesh, collision="parts"))])
    volumes = [hull_solid(part.geometry)[0] for part in parts if isinstance(part.geometry, Mesh)]
    return parts if sum(volumes) < hull_solid(mesh)[0] else [shape]


def solid_inertial(shapes: Sequence[Shape]) -> Inertial:
    """Mass properties of solid shapes in their body's axes; of a mesh, those of its hull or part.

    Raises:
        RobotError: A mesh cannot be read, or is flat.
    """
    solids = [solid for shape in shapes if (solid := shape_solid(shape)) is not None]
    volumes, centroids, tensors = zip(*solids, strict=True)
    center = np.average(centroids, axis=0, weights=volumes)
    inertia = np.sum(tensors, axis=0)
    for volume, centroid in zip(volumes, centroids, strict=True):
        inertia = inertia + point_inertia(volume, centroid - center)
    return Inertial(DENSITY * float(np.sum(volumes)), center, DENSITY * inertia)
