"""Decomposes the meshes of a robot, and reports what takes long."""

from __future__ import annotations

import time
from collections.abc import Iterable

from harness.core.errors import RobotError
from harness.core.geometry import Mesh
from harness.core.slow_work import PATIENCE, reported
from harness.robot.description import Link
from harness.robot.mesh_file import decomposition_of
from harness.robot.urdf.urdf import MeshElements


def decompose_meshes(links: Iterable[Link], elements: MeshElements) -> None:
    """Decompose the meshes with which links collide, for later use in this process.

    Args:
        links: All links of a robot, with whole meshes.
        elements: Where the file of the robot names the meshes.

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
