"""Objects whose pictures differ much from the shapes that planner, physics and verdicts know."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import ClassVar

import numpy as np

from harness.cell.program import Program
from harness.core.geometry import Mesh, Plane, Shape, reach
from harness.core.types import FloatArray
from harness.recording.run import Finding, ObjectRecord, Run
from harness.session.observation.observer import Observer

LEAST_DIFFERENCE = 0.005  # of a side's place [m]: a picture that is off by less shows the shape
LEAST_SHARE = 0.1  # of the object's extent along that axis
CORNERS = np.array(list(product((0, 1), repeat=3)))


class Looks(Observer):
    """Objects that look larger or smaller than what the physics knows of them."""

    name: ClassVar[str] = "looks"

    def report(self, run: Run, program: Program) -> tuple[Finding, ...]:
        del program
        return looks_differ(run.objects)


def looks_differ(objects: Sequence[ObjectRecord]) -> tuple[Finding, ...]:
    """A finding for each object whose pictures reach further, or less far, than its shapes."""
    return tuple(finding for record in objects if (finding := _difference(record)) is not None)


def _difference(record: ObjectRecord) -> Finding | None:
    shapes = (*record.shapes, *record.visuals)
    planes = any(isinstance(shape.geometry, Plane) for shape in shapes)
    if not record.shapes or not record.visuals or planes:
        return None
    real, shown = outline(record.shapes), outline(record.visuals)
    extent = real[1] - real[0]
    off = np.abs(shown - real)
    axis = int(np.argmax((off / np.maximum(extent, 1e-9)).max(axis=0)))
    largest = float(off[:, axis].max())
    if largest < max(LEAST_DIFFERENCE, LEAST_SHARE * float(extent[axis])):
        return None
    seen = float(shown[1, axis] - shown[0, axis])
    return Finding(
        kind="looks",
        message=f"'{record.name}' is shown {1e3 * seen:.1f} mm long along its {'xyz'[axis]} axis,"
        f" and its collision shapes are {1e3 * extent[axis]:.1f} mm; a side is off by"
        f" {1e3 * largest:.1f} mm: planner, physics and verdicts use the collision shapes",
        values={"object": record.name, "shown": seen, "real": float(extent[axis])},
    )


def outline(shapes: Sequence[Shape]) -> FloatArray:
    """Lower and upper corner of the box along an object's axes that holds shapes [m], (2, 3)."""
    points = np.concatenate([shape.pose.apply(_points(shape)) for shape in shapes])
    return np.array([points.min(axis=0), points.max(axis=0)])


def _points(shape: Shape) -> FloatArray:
    """Vertices of a mesh, corners of what holds another shape, in its own frame, (N, 3)."""
    if isinstance(shape.geometry, Mesh):
        from harness.cameras.meshes import mesh_parts  # loads readers of meshes

        parts = mesh_parts(shape.geometry)
        return np.concatenate([part.vertices for part in parts]) if parts else np.zeros((1, 3))
    half = reach(shape.geometry, np.eye(3))
    return np.zeros((1, 3)) if half is None else (2 * CORNERS - 1) * half
