"""inserted: a peg is in a hole, as deep as required."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

import numpy as np
from pydantic import Field

from harness.cell.scope import At
from harness.core.amounts import amount, amounts
from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Sphere
from harness.core.pose_arrays import compose, conjugate, rotate
from harness.core.types import FloatArray
from harness.core.world import Hole
from harness.judging.expectation import Predicate
from harness.judging.limits import refuse_decided
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.poses import physical_poses
from harness.judging.window import NotObservable, Window, object_record
from harness.language.base import Deviation, Name, PositiveLength
from harness.language.expectation import Judged, Quantity
from harness.recording.run import ObjectRecord, Run
from harness.recording.verdict import Measure, Verdict, VerdictWarning

DEPTH = Quantity("depth in the hole", "m", "at least `depth`")
PRESSED = 1e-3  # [m], more than a peg sinks into the bottom of its hole
ALIKE = 0.99  # the share of an extent by which another one is as large
OFFSET = Quantity("offset from the hole's axis", "m", "at most `tolerance`")


class Inserted(Predicate):
    """A peg is in a hole, at least as deep as required.

    The axis of the peg is that of its longest extent, or the one across which it is as wide as it
    is thick, through the middle of its shapes. Its lower end must be below the opening, along the
    hole's axis, by the depth; and as far as the peg is below the opening, its axis must be near the
    hole's. A peg that stands next to its hole, or on its rim, is not inserted, and neither is one
    that fell through it. Where the peg is, is measured in the physics.
    """

    subject = "peg"
    judged: ClassVar[Judged] = "at_end"
    sentence = "{peg} is {depth} deep in the hole of {hole}"
    is_change: ClassVar[bool] = True
    quantities = (DEPTH, OFFSET)
    synonyms = ("insertion", "in_hole")

    peg: Name = Field(description="The name of the object that goes into the hole.")
    hole: Name = Field(
        description="The name of the object whose `box` has the `hole`; of several the nearest."
    )
    depth: PositiveLength = Field(description="The depth of the peg's end below the opening [m].")
    tolerance: Deviation = Field(
        default=1e-3,
        description="The largest distance of the peg's axis from the hole's, as far as the peg is"
        " below the opening [m].",
    )

    def check(self, at: At) -> None:
        scope = at.scope
        for key in ("peg", "hole"):
            scope.check_object(getattr(self, key), at.key(key), simulated=True)
        block = scope.objects.get(self.hole)
        if block is None:
            return
        if not block.holes:
            scope.problems.add(
                at.key("hole"),
                f"'{self.hole}' has no hole",
                "a hole is a key of a box: `box: {size: [...], hole: {diameter: 20 mm}}`",
                needs=("world",),
            )
        else:
            ends = 0.0, max(hole.depth for hole in block.holes)
            what = f"the hole is {amount(ends[1], 'm')} deep, and the depth in it"
            refuse_decided(at, "depth", ">=", self.depth, ends, what)

    def looks_back(self) -> float:
        return 0.0

    def signal(self, window: Window) -> MarginSignal:
        """Depth of the peg's end below the opening, and its distance from the axis [m]."""
        run = window.run
        record = object_record(run, self.hole)
        if not record.holes:
            raise NotObservable(f"'{self.hole}' has no hole in this run")
        axes = _axes(object_record(run, self.peg))
        peg, block = (window.cut(physical_poses(run, name)) for name in (self.peg, self.hole))
        found = [_in_hole(ends, peg, block, hole) for hole in record.holes for ends in axes]
        offsets = np.stack([offset for _, offset in found])
        nearest = offsets.argmin(axis=0)
        rows = np.arange(len(nearest))
        depth = np.stack([depth for depth, _ in found])[nearest, rows]
        offset = offsets[nearest, rows]
        parts = [
            Part(DEPTH, depth, self.depth, ">=", detail=self.peg),
            Part(OFFSET, offset, self.tolerance, "<=", detail=self.peg),
        ]

        def text(index: int, _: Measure) -> str:
            if offset[index] > self.tolerance:
                off, most = amounts(float(offset[index]), self.tolerance, "m")
                return f"{self.peg} is {off} from the axis of the hole, at most {most} required"
            deep, least = amounts(float(depth[index]), self.depth, "m")
            return f"{self.peg} is {deep} deep in the hole, at least {least} required"

        return all_of(window, parts, text)

    def verdict(self, run: Run, step: str) -> Verdict:
        answer = super().verdict(run, step)
        if answer.status != "passed":
            return answer
        return replace(answer, warnings=(*answer.warnings, *_welded(run, self.peg)))


def _welded(run: Run, name: str) -> tuple[VerdictWarning, ...]:
    """A warning where a weld carries the peg at the end, so that nothing shows that it stays."""
    last, records = run.signals.times[-1], run.attachments
    held = [each.welded for each in records if each.represents == name and each.welded]
    if "attachments" in run.unrecorded or not any(end > last for _, end in held):
        return ()
    message = f"{name} is welded to the hand: whether it stays in the hole is not shown"
    return (VerdictWarning("held by a weld", message),)


def _axes(record: ObjectRecord) -> list[FloatArray]:
    """The two ends of each axis that may be a peg's, in its frame, shape (2, 3) each [m]."""
    corners = np.concatenate([each.pose.apply(_corners(each.geometry)) for each in record.shapes])
    low, high = corners.min(axis=0), corners.max(axis=0)
    axes: list[FloatArray] = []
    for axis, extent in enumerate(high - low):
        others = np.delete(high - low, axis)
        if max(extent / np.max(high - low), others.min() / others.max()) > ALIKE:
            ends = np.tile((low + high) / 2, (2, 1))
            ends[:, axis] = low[axis], high[axis]
            axes.append(ends)
    return axes


def _corners(geometry: object) -> FloatArray:
    """Corners of the box around a shape, in its frame, shape (n, 3) [m].

    Raises:
        NotObservable: It is no body with an end.
    """
    match geometry:
        case Box(size=size):
            half = np.array(size) / 2
        case Cylinder(radius=radius, length=length):
            half = np.array([radius, radius, length / 2])
        case Capsule(radius=radius, length=length):
            half = np.array([radius, radius, length / 2 + radius])
        case Sphere(radius=radius):
            half = np.full(3, radius)
        case Mesh(hull=hull) if hull is not None:
            return np.array(hull.corners)
        case _:
            raise NotObservable("the shape of the peg was not recorded, or has no end")
    signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
    return signs * half


def _in_hole(
    ends: FloatArray, peg: FloatArray, block: FloatArray, hole: Hole
) -> tuple[FloatArray, FloatArray]:
    """How deep the lower end is, and how far the axis below the opening is from the hole's, (N,).

    Of a peg that leaves the hole at its other end, what of it is still in the hole counts; of one
    that is below the hole as a whole, how far it is: less than nothing.

    Args:
        ends: The ends of the peg's axis in its frame [m], shape (2, 3).
        peg: T_world_peg, shape (N, 7).
        block: T_world_block, shape (N, 7).
        hole: The hole in the block.
    """
    opening = compose(block, np.array(hole.pose))
    back = conjugate(opening[:, 3:])
    first, second = (
        rotate(back, peg[:, :3] + rotate(peg[:, 3:], end) - opening[:, :3]) for end in ends
    )
    is_lower = first[:, 2:] < second[:, 2:]
    low, high = np.where(is_lower, first, second), np.where(is_lower, second, first)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.clip(-low[:, 2] / (high[:, 2] - low[:, 2]), 0.0, 1.0)
    entered = low + np.nan_to_num(share)[:, None] * (high - low)
    offset = np.maximum(*(np.linalg.norm(each[:, :2], axis=1) for each in (low, entered)))
    left, depth = hole.depth + high[:, 2], -low[:, 2]
    return np.where(depth > hole.depth + PRESSED, np.minimum(left, depth), depth), offset
