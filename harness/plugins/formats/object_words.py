"""Objects of other programs as the keys of a world file: mass, shapes, visuals, friction."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.solids import point_inertia
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.language.poses import Pose
from harness.language.world import FrictionSpec, ShapeSpec
from harness.plugins.formats.plain_values import rounded, significant

GEOMETRIES = ("box", "cylinder", "sphere", "capsule", "plane", "mesh")


@dataclass(frozen=True, eq=False)
class MassProperties:
    """Mass properties of a rigid body.

    Attributes:
        mass: The mass in kilograms [kg].
        center: Centre of mass in the object's frame [m], shape (3,).
        inertia: Inertia about the centre of mass, in the object's axes [kg m^2], shape (3, 3).
    """

    mass: float
    center: FloatArray
    inertia: FloatArray

    def placed(self, pose: SE3) -> MassProperties:
        """The properties transformed from a link's frame to the object's: T_object_link."""
        turn = pose.rotation
        return MassProperties(self.mass, pose.apply(self.center), turn @ self.inertia @ turn.T)


def together(parts: Sequence[MassProperties]) -> MassProperties:
    """Properties of several rigidly connected bodies (parallel axis theorem)."""
    if len(parts) == 1:
        return parts[0]
    mass = sum(part.mass for part in parts)
    center = sum((part.mass * part.center for part in parts), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for part in parts:
        inertia += part.inertia
        inertia += point_inertia(part.mass, part.center - center)
    return MassProperties(mass, center, inertia)


def mass_words(whole: MassProperties) -> dict[str, Any]:
    """The keys of an object for its mass, centre of mass and inertia."""
    tensor = whole.inertia
    places = {"ixx": (0, 0), "iyy": (1, 1), "izz": (2, 2)}
    places |= {"ixy": (0, 1), "ixz": (0, 2), "iyz": (1, 2)}
    smallest = 1e-14 * float(np.abs(tensor).max())
    moments = {
        key: significant(tensor[place]) if abs(tensor[place]) > smallest else 0.0
        for key, place in places.items()
    }
    x, y, z = (rounded(value) for value in whole.center)
    return {
        "mass": significant(whole.mass),
        "center_of_mass": (x, y, z),
        "inertia": moments,
    }


def look_words(shapes: list[ShapeSpec], visuals: list[ShapeSpec]) -> dict[str, Any]:
    """Shapes, visuals, friction and colour, written once where shapes share them."""
    words: dict[str, Any] = {}
    colored = _colored(shapes, visuals)
    if colored is not None:
        shapes, visuals = colored, []
    friction = Counter(shape.friction for shape in shapes).most_common(1)[0][0] if shapes else None
    words["friction"] = _short(friction)
    shapes = [
        shape.model_copy(update={"friction": _own(shape.friction, friction)}) for shape in shapes
    ]
    colors = {shape.color for shape in (*shapes, *visuals)}
    if len(colors) == 1:
        (words["color"],) = colors
        shapes = [shape.model_copy(update={"color": None}) for shape in shapes]
        visuals = [shape.model_copy(update={"color": None}) for shape in visuals]
    shapes, visuals = _unnamed(shapes), _unnamed(visuals)
    words["visuals"] = tuple(visuals)
    if len(shapes) == 1 and shapes[0].pose == Pose() and shapes[0].color is None:
        words |= {kind: getattr(shapes[0], kind) for kind in GEOMETRIES}
    else:
        words["shapes"] = tuple(shapes)
    return words


def _unnamed(shapes: list[ShapeSpec]) -> list[ShapeSpec]:
    """The shapes; a single shape has no name."""
    return [shapes[0].model_copy(update={"name": None})] if len(shapes) == 1 else shapes


def _colored(shapes: list[ShapeSpec], visuals: list[ShapeSpec]) -> list[ShapeSpec] | None:
    """The shapes with the colours of equal visuals; None when the shapes differ."""
    if len(shapes) != len(visuals):
        return None
    rest = list(visuals)
    colored: list[ShapeSpec] = []
    for shape in shapes:
        same = next((visual for visual in rest if _form(visual) == _form(shape)), None)
        if same is None:
            return None
        rest.remove(same)
        colored.append(shape.model_copy(update={"color": same.color}))
    return colored


def _form(shape: ShapeSpec) -> tuple[object, ...]:
    return (shape.pose, *(getattr(shape, kind) for kind in GEOMETRIES))


def _own(
    friction: FrictionSpec | float | None, shared: FrictionSpec | float | None
) -> FrictionSpec | float | None:
    """The friction of a shape for a file; None where it is that of the object."""
    default = FrictionSpec()
    if (friction or default) == (shared or default):
        return None
    short = _short(friction)
    return default.sliding if short is None else short


def _short(friction: FrictionSpec | float | None) -> FrictionSpec | float | None:
    """Friction without its default values; None when all are defaults."""
    if not isinstance(friction, FrictionSpec):
        return friction
    if friction == FrictionSpec():
        return None
    if friction == FrictionSpec(sliding=friction.sliding):
        return friction.sliding
    return friction
