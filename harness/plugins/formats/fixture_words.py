"""Joints of other programs' objects as the keys of a world file."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from harness.core.registry import registry
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.language.plugin_field import KeyModel
from harness.language.world import PartKey, ShapeSpec
from harness.plugins.formats.object_words import MassProperties, mass_words
from harness.plugins.formats.plain_values import rounded, significant

FARTHEST = 1.0  # [m], of a slide without limits


def part_model() -> type[PartKey]:
    """The model of a part, which another plug-in has."""
    return registry(KeyModel.plugin_kind)["joint"]


@dataclass(frozen=True, eq=False)
class PartJoint:
    """The hinge or slide of a part, with the numbers of its file.

    Attributes:
        name: The name of the joint.
        axis: The direction of the axis, in the fixture's frame, shape (3,).
        point: A point on the axis, in the fixture's frame [m], shape (3,).
        limits: The range of its position, counted from where the file has the part [rad or m].
        friction: Friction torque or force [N m or N].
        damping: Resistance per velocity [N m s/rad or N s/m].
        stiffness: The stiffness of its spring [N m/rad or N/m].
        rest: Where its spring is relaxed, counted like the limits [rad or m].
    """

    name: str
    kind: Literal["hinge", "slide"]
    axis: FloatArray
    point: FloatArray
    limits: tuple[float, float]
    friction: float = 0.0
    damping: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0

    @property
    def usable_limits(self) -> tuple[float, float]:
        """The limits that a fixture can have: half a turn, or a metre where there are none."""
        most = math.pi if self.kind == "hinge" else FARTHEST if self.is_endless else math.inf
        lower, upper = self.limits
        return max(lower, -most), min(upper, most)

    @property
    def is_endless(self) -> bool:
        """Whether it has no limits."""
        return not all(map(math.isfinite, self.limits))

    def words(
        self,
        shapes: list[ShapeSpec],
        visuals: list[ShapeSpec],
        mass: MassProperties | None = None,
    ) -> dict[str, Any]:
        """The keys of the joint, with the shapes of its part in the fixture's frame."""
        lower, upper = (rounded(limit) for limit in self.usable_limits)
        motion: dict[str, Any] = {
            "axis": tuple(rounded(value) for value in self.axis),
            "range": (lower, upper),
            "start": min(max(0.0, lower), upper),
            "friction": significant(self.friction),
            "damping": significant(self.damping),
        }
        if self.kind == "hinge":
            motion["at"] = tuple(rounded(value) for value in self.point)
        if self.stiffness:
            motion |= {"stiffness": significant(self.stiffness), "rest": rounded(self.rest)}
        return {
            "name": self.name,
            self.kind: motion,
            "shapes": tuple(shapes),
            "visuals": tuple(visuals),
            **({} if mass is None else mass_words(mass)),
        }


def on_fixture(pose: SE3, axis: FloatArray, point: FloatArray) -> tuple[FloatArray, FloatArray]:
    """An axis and a point of a body's frame in the fixture's, for T_fixture_body."""
    return pose.rotation @ np.asarray(axis, dtype=float), pose.apply(np.asarray(point, dtype=float))
