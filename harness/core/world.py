"""The resolved world: objects with all parameters known, for planner and physics."""

from __future__ import annotations

from dataclasses import dataclass, field

from harness.core.geometry import Friction, Shape
from harness.core.spatial import SE3
from harness.core.surface_motion import SurfaceMotion
from harness.core.types import FloatArray

MOST_OBJECTS = 1000  # of all kinds; 300 that move take 2 s of wall time per simulated second


@dataclass(frozen=True, eq=False)
class WorldObject:
    """A body that is not the robot.

    Attributes:
        name: The name, unique among the scenario's objects and the robot's links.
        shapes: Geometry on the body, used for contact, planning and pictures.
        pose: T_world_object at the start, or when a step adds the object.
        is_static: Whether the object never moves by itself.
        mass: Mass [kg]; 0 for static objects.
        center_of_mass: Centre of mass in the body frame [m], shape (3,).
        inertia: Inertia about the centre of mass, in body axes [kg m^2], shape (3, 3).
        friction: Friction of every shape that has none of its own.
        in_planning: Whether the planning scene has the object.
        in_simulation: Whether the physics has the object.
        visuals: Shapes that pictures show, where they differ from `shapes`.
        surface_motion: How the surface of a belt or a turntable moves at the start; None: it never
            moves.
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
    surface_motion: SurfaceMotion | None = None

    def friction_of(self, shape: Shape) -> Friction:
        """Friction of one of the object's shapes."""
        return self.friction if shape.friction is None else shape.friction


@dataclass(frozen=True)
class Light:
    """A directional light.

    Attributes:
        direction: Direction of the light rays, in world axes.
        diffuse: Colour, each channel 0 to 1.
        casts_shadow: Whether the light casts shadows.
    """

    direction: tuple[float, float, float]
    diffuse: tuple[float, float, float] = (0.8, 0.8, 0.8)
    casts_shadow: bool = True


@dataclass(frozen=True)
class World:
    """Objects and the physics around them.

    Attributes:
        gravity: Gravity in world axes [m/s^2].
        timestep: Time step of the physics [s].
        lights: The lights that pictures use.
    """

    name: str
    objects: tuple[WorldObject, ...]
    gravity: tuple[float, float, float] = (0.0, 0.0, -9.8)
    timestep: float = 0.001
    lights: tuple[Light, ...] = ()
