"""The triangles of every mesh file that shows the robot or an object."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from harness.cameras.meshes import mesh_parts
from harness.core.geometry import Mesh, Shape
from harness.recording.drawings import MeshRecord
from harness.recording.run import Run


def mesh_records(run: Run) -> tuple[MeshRecord, ...]:
    """What pictures of a run need when the mesh files are elsewhere.

    Files that cannot be read for pictures are left out; the body then shows its other shapes.
    """
    records: list[MeshRecord] = []
    for geometry in dict.fromkeys(_meshes(run)):
        for part in mesh_parts(geometry):
            # in the precision in which they are saved
            vertices = part.vertices.astype(np.float32).astype(np.float64)
            records.append(
                MeshRecord(geometry.path, geometry.scale, vertices, part.faces, part.rgba)
            )
    return tuple(records)


def _meshes(run: Run) -> Iterator[Mesh]:
    looks: Iterable[tuple[Shape, ...]] = (
        *run.robot.link_visuals.values(),
        *(obj.looks for obj in run.objects),
    )
    for shapes in looks:
        yield from (shape.geometry for shape in shapes if isinstance(shape.geometry, Mesh))
