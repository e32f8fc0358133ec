"""Masses of links whose file gives none, from the volume of their shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from harness.core.errors import Problem, RobotError, SpecError
from harness.core.geometry import Mesh, Shape
from harness.core.solids import point_inertia
from harness.robot.collision_shapes import convex_shapes
from harness.robot.description import Inertial, Link
from harness.robot.mesh_file import hull_solid, shape_solid
from harness.robot.tree import carriers
from harness.robot.urdf.urdf import Urdf

DENSITY = 1000.0
"""Density of links without a mass [kg/m^3]; hulls of arms of 5 to 30 kg have 600 to 1500."""

BEAD, BEAD_RADIUS = 1e-3, 0.01
"""Mass of an empty link between two joints, as a share of what it carries; its radius [m]."""

HINT = "give it an <inertial> with its mass [kg] and inertia [kg m^2]"


def with_estimated_masses(urdf: Urdf, source: str) -> Urdf:
    """The robot with a mass for every rigid group of links that moves and has no <inertial>.

    Args:
        urdf: The links and joints of the robot.
        source: Its name in messages.

    Raises:
        SpecError: A group has neither a mass nor a shape and carries none, or a stated mass of
            zero; every such group, at its `<mass>` or its link.
        RobotError: The same, for a robot without elements.
    """
    carrier = carriers(urdf.joints, urdf.root)
    groups: dict[str, list[Link]] = {}
    for link in urdf.links:
        groups.setdefault(carrier[link.name], []).append(link)
    massless = {
        first: links
        for first, links in groups.items()
        if first != urdf.root and not any(link.inertial for link in links)
    }
    estimated: dict[str, Link] = {}
    empty: list[str] = []
    for first, links in massless.items():
        shaped = {link.name: _with_mass(link) for link in links if link.collisions or link.visuals}
        if shaped and not any(_states_mass(urdf, link.name) for link in links):
            estimated |= shaped
        else:
            empty.append(first)
    notes: list[str] = []
    if estimated:
        total = sum(link.inertial.mass for link in estimated.values() if link.inertial)
        notes.append(
            f"no mass is given for {', '.join(estimated)}: {total:.3g} kg in all, from the volume "
            f"of their shapes at {DENSITY:g} kg/m^3"
        )
    urdf = replace(urdf, links=tuple(estimated.get(link.name, link) for link in urdf.links))
    carried = {
        first: 0.0 if _states_mass(urdf, first) else _carried(urdf, first) for first in empty
    }
    if problems := [_problem(urdf, first, source) for first in empty if not carried[first]]:
        raise SpecError(problems)
    if empty:
        notes.append(
            f"moving links without a mass and a shape get {BEAD:.1%} of what they carry: "
            f"{', '.join(empty)}"
        )
    links = tuple(
        replace(link, inertial=_bead(carried[link.name])) if link.name in carried else link
        for link in urdf.links
    )
    return replace(urdf, links=links, notes=(*urdf.notes, *notes))


def _carried(urdf: Urdf, link: str) -> float:
    """Mass of the links distal to a link [kg]."""
    distal = {link}
    for joint in urdf.joints:  # parents before children
        if joint.parent in distal:
            distal.add(joint.child)
    return sum(each.inertial.mass for each in urdf.links if each.inertial and each.name in distal)


def _bead(carried: float) -> Inertial:
    """A small solid sphere at a link's origin, which physics requires of a link that moves."""
    mass = BEAD * carried
    return Inertial(mass, np.zeros(3), 0.4 * mass * BEAD_RADIUS**2 * np.eye(3))


def _with_mass(link: Link) -> Link:
    solids = [solid for shape in link.collisions for solid in _solids(shape)]
    return replace(link, inertial=solid_inertial(solids or link.visuals))


def _solids(shape: Shape) -> Sequence[Shape]:
    """A shape's convex parts, or its hull where parts overlap so much that they are larger."""
    parts = convex_shapes([shape])
    if not isinstance(shape.geometry, Mesh):
        return parts
    volumes = [hull_solid(part.geometry)[0] for part in parts if isinstance(part.geometry, Mesh)]
    return parts if sum(volumes) < hull_solid(shape.geometry)[0] else [shape]


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


def _states_mass(urdf: Urdf, link: str) -> bool:
    element = urdf.elements.get(("link", link))
    return element is not None and element.find("inertial") is not None


def _problem(urdf: Urdf, first: str, source: str) -> Problem:
    message = f"link '{first}' moves and weighs nothing"
    element = urdf.elements.get(("link", first))
    if element is None:
        raise RobotError(f"{source}: {message}; {HINT}")
    inertial = element.find("inertial")
    mass = None if inertial is None else inertial.find("mass")
    return (mass or element).problem(message, HINT, at="value" if mass else "name")
