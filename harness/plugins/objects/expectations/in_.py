"""in: an object inside a container that has not tipped over."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import Annotated

import numpy as np
from pydantic import Field

from harness.cell.scope import At
from harness.core.amounts import amount, amounts
from harness.core.geometry import Mesh, Shape, bounds_of, center_of
from harness.core.pose_arrays import angle_between, relative, rotate
from harness.core.solids import volume_of
from harness.core.spatial import SE3
from harness.core.types import BoolArray, FloatArray
from harness.judging.expectation import ObjectPredicate
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.poses import UP, object_poses, physical_poses, present, start_samples
from harness.judging.window import NotObservable, Window, object_record
from harness.language.base import AngleBetween, Name
from harness.language.expectation import Quantity
from harness.recording.run import ObjectRecord
from harness.recording.verdict import Measure

X, Y, Z = np.eye(3)
PARALLEL = 1e-9  # least part along an axis of a direction that crosses the planes across it

DEPTH = Quantity("distance inside", "m", "at least 0, to the nearest side of the outline")
LEAN = Quantity("lean of the container", "rad", "at most `max_lean`")
SIDES = Quantity(
    "enclosed", "1", "a shape of it is under the object, or on all four sides; and not the reverse"
)


class In(ObjectPredicate):
    """Half of the object is inside the outline of a container that has not tipped over.

    The outline is the smallest box along the container's axes that holds all of its collision
    shapes; what it looks like does not count. Inside are the object's collision shapes whose
    centres are: they make half of its volume at least, wherever its origin is. A ring around a bin
    is not in the bin, and of two objects that have each other's middle inside the smaller one is in
    the larger one.

    Along the container's axes a shape of it (the box around it) is under these centres, or there
    is one on each of the four sides: what lies under a table or next to the handle of a pan is in
    its outline, and not in it. That the object is closed in above is not required.
    """

    sentence = "{object} is in {container}"
    quantities = (DEPTH, LEAN, SIDES)
    synonyms = ("inside",)

    container: Name = Field(description="The name of the container that the object is in.")
    max_lean: Annotated[AngleBetween, Field(gt=0)] = Field(
        default=0.7853981633974483,
        description="The largest angle between the container's z axis and the vertical; a container"
        " that leans further has tipped over [rad].",
    )

    def check(self, at: At) -> None:
        super().check(at)
        at.scope.check_object(self.container, at.key("container"))
        if self.container == self.object:
            at.scope.problems.add(at.key("container"), f"'{self.object}' is not in itself")

    def signal(self, window: Window) -> MarginSignal:
        """Depth of the object inside the container's outline, and the container's lean.

        A bin of five boards is a box of air in wood, and what is inside it is inside that.
        """
        run = window.run
        record = object_record(run, self.container)
        lower, upper = outline(record)
        container = object_poses(run, self.container)
        poses = physical_poses(run, self.object)
        content = object_record(run, self.object)
        depth, enclosed = _inside(
            record, (lower, upper), content, window.cut(relative(container, poses))
        )
        lean = window.cut(angle_between(rotate(container[:, 3:], UP), UP))
        with suppress(NotObservable):  # of triangles it is not known what they surround
            bounds = outline(content)
            around = _inside(content, bounds, record, window.cut(relative(poses, container)))[0]
            if np.prod(bounds[1] - bounds[0]) > np.prod(upper - lower):
                enclosed = np.where(around >= 0, 0.0, enclosed)
        there = window.cut(present(run, self.object) & present(run, self.container))
        parts = [
            Part(DEPTH, depth, 0.0, ">=", 0.01, detail=self.container),
            Part(LEAN, lean, self.max_lean, "<=", detail=self.container),
            Part(SIDES, enclosed, 1.0, "==", relevant=depth >= 0, detail=self.container),
        ]

        def text(index: int, _: Measure) -> str:
            deep = float(depth[index])
            where = "inside" if deep >= 0 else "outside"
            if deep >= 0 and not enclosed[index]:
                return (
                    f"{self.object} is {amount(deep, 'm')} inside the outline of {self.container},"
                    " which is neither under it nor around it"
                )
            said = f"{self.object} is {amount(abs(deep), 'm')} {where} {self.container}"
            if lean[index] > self.max_lean:
                leans, allowed = amounts(float(lean[index]), self.max_lean, "rad")
                said += f", which leans by {leans} of {allowed}"
            return said

        return all_of(window, parts, text, present=there)

    def unchanged(self, window: Window) -> str:
        both = (self.object, self.container)
        begin = max(int(start_samples(window.run, each)[window.stop - 1]) for each in both)
        if (self.margins(replace(window, start=begin)).values < 0).any():
            return ""
        since = "a step put one of them there" if begin else "the run began"
        return f"{self.object} was in {self.container} since {since}"


def outline(record: ObjectRecord) -> tuple[FloatArray, FloatArray]:
    """Lower and upper corner of the box along an object's axes that holds its shapes [m].

    Raises:
        NotObservable: It has no shape, a plane, or in an older run a mesh.
    """
    if not record.shapes:
        raise NotObservable(f"no collision shape of '{record.name}' was recorded")
    if (bounds := bounds_of(record.shapes)) is None:
        raise NotObservable(f"the extent of '{record.name}' is not recorded")
    return bounds


def _inside(
    container: ObjectRecord,
    bounds: tuple[FloatArray, FloatArray],
    content: ObjectRecord,
    poses: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """How deep half of an object is inside bounds [m], and 1 where it is enclosed, (n,) each.

    Args:
        bounds: The lower and upper corner of its outline in its frame [m].
        poses: T_container_object, shape (n, 7).

    Raises:
        NotObservable: The share of a mesh in the object's volume is not known.
    """
    lower, upper = bounds
    centres = [center_of(shape) for shape in content.shapes] or [np.zeros(3)]
    volumes = _volumes(content)
    shares = volumes / volumes.sum()
    points = [poses[:, :3] + rotate(poses[:, 3:], centre) for centre in centres]
    depths = np.stack([np.minimum(each - lower, upper - each).min(axis=1) for each in points], 1)
    order = np.argsort(-depths, axis=1)
    most = (np.cumsum(shares[order], axis=1) >= 0.5 - 1e-9).argmax(axis=1)
    depth = np.take_along_axis(depths, order, axis=1)[np.arange(len(poses)), most]
    closed = np.stack([_enclosed(container, each) for each in points], 1) * (depths >= 0)
    enclosed = np.where(closed @ shares >= 0.5 - 1e-9, 1.0, 0.0)
    return depth, np.where(np.isnan(depth), np.nan, enclosed)


def _volumes(record: ObjectRecord) -> FloatArray:
    """Volume of each shape of an object [m³]; equal ones where none is known.

    Raises:
        NotObservable: Some are not known: an older run has no volumes of meshes.
    """
    volumes = [volume_of(shape.geometry) for shape in record.shapes]
    known = [volume for volume in volumes if volume is not None]
    if known and len(known) < len(volumes):
        raise NotObservable(f"the volumes of the meshes of '{record.name}' are not recorded")
    return np.array(known or [1.0] * max(1, len(volumes)))


def _enclosed(record: ObjectRecord, points: FloatArray) -> FloatArray:
    """1 where a shape is under a point of the object's frame or all around it, else 0; NaN unknown.

    Args:
        points: The points in the container's frame [m], shape (n, 3).

    Raises:
        NotObservable: It collides as triangles, whose shape is not recorded.
    """
    for shape in record.shapes:
        if isinstance(shape.geometry, Mesh) and shape.geometry.collision == "exact":
            raise NotObservable(f"what the triangles of '{record.name}' surround is not recorded")
    down, *around = (
        np.any([_is_ahead(shape, points, way) for shape in record.shapes], axis=0)
        for way in (-Z, X, -X, Y, -Y)
    )
    enclosed = np.where(down | np.all(around, axis=0), 1.0, 0.0)
    return np.where(np.isnan(points).any(axis=1), np.nan, enclosed)


def _is_ahead(shape: Shape, points: FloatArray, way: FloatArray) -> BoolArray:
    """Points from which a ray along a direction meets the box around a shape, shape (n,)."""
    starts = (points - shape.pose.translation) @ shape.pose.rotation
    ray = way @ shape.pose.rotation
    lower, upper = _own_bounds(shape)
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.sort([(side - starts) / ray for side in (lower, upper)], axis=0)
    outside = (starts < lower) | (starts > upper)
    along = np.abs(ray) > PARALLEL
    enters = np.where(along, ends[0], -np.inf).max(axis=1)
    leaves = np.where(along, ends[1], np.inf).min(axis=1)
    return (leaves >= np.maximum(enters, 0.0)) & ~(outside & ~along).any(axis=1)


def _own_bounds(shape: Shape) -> tuple[FloatArray, FloatArray]:
    """Corners of the box around a shape, along the shape's own axes [m], shape (3,) each.

    Raises:
        NotObservable: Its extent is not known from the record.
    """
    bounds = bounds_of([replace(shape, pose=SE3.identity())])
    if bounds is None:
        raise NotObservable("the extent of a shape is not recorded")
    return bounds
