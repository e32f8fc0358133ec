"""in: an object inside the outline of a container that has not tipped over."""

from __future__ import annotations

import numpy as np

from harness.assertions.poses import object_poses, physical_poses, present
from harness.assertions.registry import MarginSignal, Part, all_of, signal
from harness.assertions.text import amount, amounts
from harness.assertions.window import NotObservable, Window, object_record
from harness.core.geometry import Box, Capsule, Cylinder, Shape, Sphere
from harness.core.pose_arrays import angle_between, relative, rotate
from harness.core.types import FloatArray
from harness.recording.run import Measure, ObjectRecord
from harness.spec.checks import In

UP = np.array([0.0, 0.0, 1.0])


@signal.handles(In)
def inside(check: In, window: Window) -> MarginSignal:
    """Distance of the origin to the nearest side of the container's outline, and its lean.

    The outline is the smallest box along the container's own axes that holds all of its shapes: a
    bin of five boards is a box of air in wood, and what is inside it is inside that.
    """
    run = window.run
    lower, upper = outline(object_record(run, check.container))
    container = object_poses(run, check.container)
    origin = window.cut(relative(container, physical_poses(run, check.object))[:, :3])
    depth = np.minimum(origin - lower, upper - origin).min(axis=1)
    lean = window.cut(angle_between(rotate(container[:, 3:], UP), UP))
    there = window.cut(present(run, check.object) & present(run, check.container))
    parts = [
        Part("distance inside", depth, 0.0, ">=", "m", 0.01, detail=check.container),
        Part("lean of the container", lean, check.max_lean, "<=", "rad", detail=check.container),
    ]

    def text(index: int, _: Measure) -> str:
        deep = float(depth[index])
        where = "inside" if deep >= 0 else "outside"
        leans, allowed = amounts(float(lean[index]), check.max_lean, "rad")
        return (
            f"{check.object} is {amount(abs(deep), 'm')} {where} {check.container},"
            f" which leans by {leans} of {allowed}"
        )

    return all_of(window, parts, text, present=there)


def outline(record: ObjectRecord) -> tuple[FloatArray, FloatArray]:
    """Lower and upper corner of the box along an object's axes that holds its shapes [m].

    Raises:
        NotObservable: Its extent is not known from the record: it has no shape, a plane or a mesh.
    """
    if not record.shapes:
        raise NotObservable(f"the shape of '{record.name}' was not recorded")
    corners = [_corners(shape, record.name) for shape in record.shapes]
    lows, highs = zip(*corners, strict=True)
    return np.min(lows, axis=0), np.max(highs, axis=0)


def _corners(shape: Shape, name: str) -> tuple[FloatArray, FloatArray]:
    axes = np.abs(shape.pose.rotation)
    along = axes[:, 2]  # how much of the shape's own z axis points along each axis of the object
    match shape.geometry:
        case Box(size=size):
            half = axes @ (0.5 * np.array(size))
        case Sphere(radius=radius):
            half = np.full(3, radius)
        case Capsule(radius=radius, length=length):
            half = 0.5 * length * along + radius
        case Cylinder(radius=radius, length=length):
            half = 0.5 * length * along + radius * np.sqrt(np.maximum(0.0, 1 - along**2))
        case _:
            raise NotObservable(f"the extent of '{name}' is not known: it is no box or cylinder")
    return shape.pose.translation - half, shape.pose.translation + half
