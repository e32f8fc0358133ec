"""The resolved world: objects with every number known, as planner and physics take them."""

from __future__ import annotations

from dataclasses import dataclass, field

from harness.core.geometry import Friction, Shape
from harness.core.spatial import SE3
from harness.core.types import FloatArray


@dataclass(frozen=True, eq=False)
class WorldObject:
    """A body that is not the robot.

    Attributes:
        name: Unique in the scenario, and not a robot link.
        shapes: Geometry on the body, used for contact, planning and pictures.
        pose: T_world_object at the start, or where it appears.
        is_static: Never moves by itself.
        mass: [kg]; 0 for static objects.
        center_of_mass: In the body frame [m], shape (3,).
        inertia: About the centre of mass, body axes [kg m^2], shape (3, 3).
        friction: Of its surface, where a shape has none of its own.
        in_planning: The planning scene knows it.
        in_simulation: The physics knows it.
        visuals: What pictures show instead of `shapes`, where it differs.
    """

    name: str
    shapes: tuple[Shape, ...]
    pose: SE3
    is_static: bool
    mass: float
    center_of_mass: FloatArray
    inertia: FloatArray
    friction: Friction = field(default_factory=Friction)
    in_planning: bool = True
    in_simulation: bool = True
    visuals: tuple[Shape, ...] = ()

    def friction_of(self, shape: Shape) -> Friction:
        """What counts on one of its shapes."""
        return self.friction if shape.friction is None else shape.friction


@dataclass(frozen=True)
class Light:
    """A directional light.

    Attributes:
        direction: Where it shines to, world axes.
        diffuse: Colour, each 0..1.
        casts_shadow: Whether it casts shadows.
    """

    direction: tuple[float, float, float]
    diffuse: tuple[float, float, float] = (0.8, 0.8, 0.8)
    casts_shadow: bool = True


@dataclass(frozen=True)
class World:
    """Objects and the physics around them.

    Attributes:
        name: As the scenario calls it.
        objects: In file order.
        gravity: [m/s^2], world axes.
        timestep: Of the physics [s].
        lights: For pictures.
    """

    name: str
    objects: tuple[WorldObject, ...]
    gravity: tuple[float, float, float] = (0.0, 0.0, -9.8)
    timestep: float = 0.001
    lights: tuple[Light, ...] = ()
