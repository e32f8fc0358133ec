"""Decomposes the meshes of a robot, and leaves out those that cannot be drawn here."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import replace

from harness.core.errors import MissingPackage, RobotError
from harness.core.geometry import Mesh
from harness.core.slow_work import PATIENCE, reported
from harness.robot.description import RobotDescription
from harness.robot.mechanism import Link
from harness.robot.mesh_file import decomposition_of, require_reader
from harness.robot.urdf.urdf import MeshElements


def decompose_meshes(links: Iterable[Link], elements: MeshElements) -> None:
    """Decompose the meshes with which links collide, for later use in this process.

    Raises:
        SpecError: A mesh cannot be read, or is flat; at its element.
        RobotError: The same, without an element.
    """
    shapes = (shape.geometry for link in links for shape in link.collisions)
    meshes = list(dict.fromkeys(each for each in shapes if isinstance(each, Mesh)))
    start = time.monotonic()
    for number, mesh in enumerate(meshes, start=1):
        left = max(PATIENCE - (time.monotonic() - start), 0.1)
        text = f"computing convex shapes of {mesh.path.name}, {number} of {len(meshes)}"
        try:
            with reported(text, after=left):
                decomposition_of(mesh)
        except RobotError as error:
            element, link = elements.get(Mesh(mesh.path, mesh.scale), (None, ""))
            if element is None:
                raise
            element.refuse(f"link '{link}': mesh {error}", at="filename")


def without_undrawable(description: RobotDescription) -> RobotDescription:
    """The robot without the visuals of mesh files whose reader is not installed, with a note."""
    links, left_out = list(description.links), dict[str, str]()
    for number, link in enumerate(description.links):
        try:
            for shape in link.visuals:
                if isinstance(shape.geometry, Mesh):
                    require_reader(shape.geometry)
        except MissingPackage as error:
            links[number] = replace(link, visuals=())
            left_out.setdefault(str(error), link.name)
    if not left_out:
        return description
    notes = (
        f"link '{name}' is drawn by its collision shapes, and others may be too: {why}"
        for why, name in left_out.items()
    )
    return replace(description, links=tuple(links), notes=(*description.notes, *notes))
