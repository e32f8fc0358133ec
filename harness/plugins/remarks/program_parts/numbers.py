"""Numbers of objects and of expectations that belong to another unit in all likelihood."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

import numpy as np
from pydantic import BaseModel

from harness.cell.program import Program
from harness.cell.program_part import ProgramPart
from harness.core.geometry import Box, Capsule, Cylinder, Sphere, bounding_radius
from harness.core.limits import LONGEST_RUN
from harness.core.solids import volume_of
from harness.core.world import WorldObject
from harness.language.annotations import unit_of

LARGE = 5.0  # size from which a movable object is probably given in millimetres [m]
REACHED = {"s": LONGEST_RUN, "m": LONGEST_RUN, "m/s": 100.0, "N": 1e5, "N*m": 1e5}
"""More than any run reaches, by unit: distance is that of the longest run at 1 m/s."""
DENSEST = 22590.0  # osmium at room temperature, CRC Handbook of Chemistry and Physics [kg/m^3]


class Numbers(ProgramPart):
    """Sizes, inertias, densities and limits beyond those of what robots handle."""

    name: ClassVar[str] = "numbers"

    def remarks(self, program: Program) -> Iterator[str]:
        for remark in (_too_large, _too_inert, _too_dense):
            yield from filter(None, map(remark, program.all_objects()))
        for item in program.expectations:
            yield from _unreachable(item.spec, item.line)


def _unreachable(spec: BaseModel, line: int) -> Iterator[str]:
    """Remarks on numbers of an expectation that no run reaches: as limits they limit nothing."""
    for key, value in spec:
        if isinstance(value, BaseModel):
            yield from _unreachable(value, line)
        elif isinstance(value, float) and value > REACHED.get(unit := unit_of(spec, key), np.inf):
            yield f"line {line}: `{key}` is {value:g} {unit}, more than any run reaches"


def _too_large(obj: WorldObject) -> str:
    """A remark on a movable object that is as large as a house; empty for others."""
    sizes = [shape.geometry.size for shape in obj.shapes if isinstance(shape.geometry, Box)]
    sizes += [
        (2 * shape.geometry.radius,) * 3
        for shape in obj.shapes
        if isinstance(shape.geometry, Sphere | Cylinder | Capsule)
    ]
    largest = max((max(size) for size in sizes), default=0.0)
    if obj.is_static or largest < LARGE:
        return ""
    return (
        f"'{obj.name}' measures {largest:g} m: a number without a unit is in metres, "
        f"write `{largest:g} mm` for millimetres"
    )


def _too_inert(obj: WorldObject) -> str:
    """A remark on an inertia beyond that of the whole mass at the far end of the shapes."""
    if obj.is_static:
        return ""
    radius = max(map(bounding_radius, obj.shapes), default=np.inf)
    most = obj.mass * (radius + float(np.linalg.norm(obj.center_of_mass))) ** 2
    moment = float(np.linalg.eigvalsh(obj.inertia).max())
    if moment <= most:
        return ""
    return (
        f"'{obj.name}' has an inertia of {moment:.3g} kg m^2, and its mass within its shapes has"
        f" {most:.3g} kg m^2 at most: it tips and turns so slowly that it seems to rest"
    )


def _too_dense(obj: WorldObject) -> str:
    """A remark on a movable object that is heavier than any metal of its size."""
    volumes = [volume_of(shape.geometry) for shape in obj.shapes]
    volume = sum(each for each in volumes if each is not None)
    if obj.is_static or not volume or None in volumes or obj.mass <= DENSEST * volume:
        return ""
    return (
        f"'{obj.name}' has {obj.mass / volume:.3g} kg/m^3, and osmium, the densest metal,"
        f" {DENSEST:g}: a mass without a unit is in kg, write `{obj.mass:g} g` for grams"
    )
