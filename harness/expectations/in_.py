"""in: an object inside a container that has not tipped over."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
from pydantic import Field

from harness.assertions.expectation import ObjectPredicate
from harness.assertions.margins import MarginSignal, Part, all_of
from harness.assertions.poses import (
    UP,
    object_poses,
    physical_poses,
    present,
    start_samples,
)
from harness.assertions.text import amount, amounts
from harness.assertions.window import NotObservable, Window, object_record
from harness.cell.scope import At
from harness.core.geometry import Shape, reach
from harness.core.pose_arrays import angle_between, relative, rotate
from harness.core.spatial import SE3
from harness.core.types import BoolArray, FloatArray
from harness.language.base import AngleBetween, Name
from harness.language.expectation import Quantity
from harness.recording.run import ObjectRecord
from harness.recording.verdict import Measure

X, Y, Z = np.eye(3)
PARALLEL = 1e-9
"""A direction with a smaller part along an axis runs parallel to the planes across it."""

DEPTH = Quantity("distance inside", "m", "at least 0, to the nearest side of the outline")
LEAN = Quantity("lean of the container", "rad", "at most `max_lean`")
SIDES = Quantity("enclosed", "1", "a shape of it is under the origin, or on all four sides")


class In(ObjectPredicate):
    """The object's origin is inside the outline of a container that has not tipped over.

    The outline is the smallest box along the container's axes that holds all of its collision
    shapes; what it looks like does not count. Along these axes a shape of the container (the box
    around it) is under the origin, or there is one on each of the four sides: what lies under a
    table or next to the handle of a pan is in its outline, and not in it.
    """

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
        """Distance of the origin to the nearest side of the container's outline, and its lean.

        A bin of five boards is a box of air in wood, and what is inside it is inside that.
        """
        run = window.run
        record = object_record(run, self.container)
        lower, upper = outline(record)
        container = object_poses(run, self.container)
        origin = window.cut(relative(container, physical_poses(run, self.object))[:, :3])
        depth = np.minimum(origin - lower, upper - origin).min(axis=1)
        lean = window.cut(angle_between(rotate(container[:, 3:], UP), UP))
        enclosed = _enclosed(record, origin)
        there = window.cut(present(run, self.object) & present(run, self.container))
        parts = [
            Part(DEPTH, depth, 0.0, ">=", 0.01, detail=self.container),
            Part(LEAN, lean, self.max_lean, "<=", detail=self.container),
            Part(SIDES, enclosed, 1.0, "==", relevant=depth >= 0, detail=self.container),
        ]

        def text(index: int, _: Measure) -> str:
            deep = float(depth[index])
            where = "inside" if deep >= 0 else "outside"
            leans, allowed = amounts(float(lean[index]), self.max_lean, "rad")
            if deep >= 0 and not enclosed[index]:
                return (
                    f"{self.object} is {amount(deep, 'm')} inside the outline of {self.container},"
                    " which is neither under it nor around it"
                )
            return (
                f"{self.object} is {amount(abs(deep), 'm')} {where} {self.container},"
                f" which leans by {leans} of {allowed}"
            )

        return all_of(window, parts, text, present=there)

    def unchanged(self, window: Window) -> str:
        begin = int(start_samples(window.run, self.object)[window.stop - 1])
        if (self.margins(replace(window, start=begin)).values < 0).any():
            return ""
        since = "a step put it there" if begin else "the run began"
        return f"{self.object} was in {self.container} since {since}"


def outline(record: ObjectRecord) -> tuple[FloatArray, FloatArray]:
    """Lower and upper corner of the box along an object's axes that holds its shapes [m].

    Raises:
        NotObservable: Its extent is not known from the record: it has no shape, a plane or a mesh.
    """
    if not record.shapes:
        raise NotObservable(f"no collision shape of '{record.name}' was recorded")
    corners = [_corners(shape, record.name) for shape in record.shapes]
    lows, highs = zip(*corners, strict=True)
    return np.min(lows, axis=0), np.max(highs, axis=0)


def _corners(shape: Shape, name: str) -> tuple[FloatArray, FloatArray]:
    half = reach(shape.geometry, shape.pose.rotation)  # along each axis of the object
    if half is None:
        raise NotObservable(f"the extent of '{name}' is not known: it is no box or cylinder")
    return shape.pose.translation - half, shape.pose.translation + half


def _enclosed(record: ObjectRecord, points: FloatArray) -> FloatArray:
    """1 where a shape is under a point of the object's frame or all around it, else 0; NaN unknown.

    Args:
        record: The record of the container.
        points: The points in the container's frame [m], shape (n, 3).
    """
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
    half = _half_sizes(shape)
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.sort([(side * half - starts) / ray for side in (-1, 1)], axis=0)
    outside = np.abs(starts) > half
    along = np.abs(ray) > PARALLEL
    enters = np.where(along, ends[0], -np.inf).max(axis=1)
    leaves = np.where(along, ends[1], np.inf).min(axis=1)
    return (leaves >= np.maximum(enters, 0.0)) & ~(outside & ~along).any(axis=1)


def _half_sizes(shape: Shape) -> FloatArray:
    """Of the box around a shape, along the shape's own axes [m], shape (3,)."""
    return _corners(replace(shape, pose=SE3.identity()), "")[1]
