"""The resolved world: objects with all parameters known, for planner and physics."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from harness.core.geometry import Friction, Shape
from harness.core.pose_arrays import IDENTITY, compose, relative, rotate, rotation_angle
from harness.core.spatial import SE3
from harness.core.surface_motion import SurfaceMotion
from harness.core.types import FloatArray

STRAY = (0.005, 0.02)  # [m], [rad], of a part's pose from where its joint can take it
MOST_OBJECTS = 1000  # of all kinds; 300 that move take 2 s of wall time per simulated second


@dataclass(frozen=True)
class ObjectJoint:
    """The hinge or slide by which a part of a fixture moves, as a door of a cabinet.

    Attributes:
        fixture: The name of the object that carries the part.
        name: The name of the joint in the file.
        fixture_pose: T_world_fixture (xyz, quat wxyz); a fixture never moves.
        axis: Unit direction of the axis, in the fixture's frame.
        point: A point on the axis of a hinge, in the fixture's frame [m].
        lower: The lower limit [rad or m].
        upper: The upper limit [rad or m].
        start: The position at the start [rad or m].
        friction: Friction torque or force [N m or N].
        damping: Resistance per velocity [N m s/rad or N s/m].
        stiffness: The spring's [N m/rad or N/m].
        rest: The position at which the spring is relaxed [rad or m].
    """

    fixture: str
    name: str
    kind: Literal["hinge", "slide"]
    fixture_pose: tuple[float, ...]
    axis: tuple[float, float, float]
    point: tuple[float, float, float]
    lower: float
    upper: float
    start: float = 0.0
    friction: float = 0.0
    damping: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0

    @property
    def unit(self) -> str:
        """Unit of its positions: `rad`, or `m`."""
        return "rad" if self.kind == "hinge" else "m"

    def pose(self, position: float) -> SE3:
        """T_world_part at a position of the joint [rad or m]."""
        return SE3.from_vector(self.poses(np.array([position]))[0])

    def poses(self, positions: FloatArray) -> FloatArray:
        """T_world_part (xyz, quat wxyz) at positions (N,) of the joint [rad or m], shape (N, 7)."""
        return compose(np.array(self.fixture_pose), self._moved(positions))

    def _nearest(self, moved: FloatArray) -> FloatArray:
        """Positions of the joint at T_fixture_part (N, 7), wherever the part is, shape (N,)."""
        axis = np.array(self.axis)
        if self.kind == "slide":
            return moved[:, :3] @ axis
        angles = 2.0 * np.arctan2(moved[:, 4:] @ axis, moved[:, 3])
        return (angles + np.pi) % (2.0 * np.pi) - np.pi

    def _moved(self, positions: FloatArray) -> FloatArray:
        """T_fixture_part at positions (N,) of the joint, shape (N, 7)."""
        axis, point = np.array(self.axis), np.array(self.point)
        moved = np.tile(IDENTITY, (len(positions), 1))
        if self.kind == "slide":
            moved[:, :3] = positions[:, None] * axis
        else:
            moved[:, 3] = np.cos(positions / 2)
            moved[:, 4:] = np.sin(positions / 2)[:, None] * axis
            moved[:, :3] = point - rotate(moved[:, 3:], point)
        return moved

    def position(self, pose: SE3) -> float:
        """The joint's position nearest to T_world_part, of a hinge within half a turn of 0."""
        moved = relative(np.array(self.fixture_pose), pose.as_vector()[None])
        return float(self._nearest(moved)[0])

    def positions(self, fixture: FloatArray, part: FloatArray) -> FloatArray:
        """Positions of the joint at poses of fixture and part, shape (N,); NaN where it has none.

        Args:
            fixture: T_world_fixture (xyz, quat wxyz), shape (N, 7) or (7,).
            part: T_world_part, shape (N, 7).
        """
        moved = relative(fixture, part)
        positions = self._nearest(moved)
        stray = relative(self._moved(positions), moved)
        off = np.linalg.norm(stray[:, :3], axis=1) > STRAY[0]
        return np.where(off | (rotation_angle(stray[:, 3:]) > STRAY[1]), np.nan, positions)


@dataclass(frozen=True)
class Hole:
    """A straight hole; its frame has its origin in the middle of the opening and z out of it.

    Attributes:
        pose: T_object_hole (xyz, quat wxyz).
        size: Full width along x and y [m]; of a round hole its diameter, twice.
        depth: How deep it is [m].
        is_round: Whether it is round.
    """

    pose: tuple[float, ...]
    size: tuple[float, float]
    depth: float
    is_round: bool


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
        joint: The hinge or slide by which a part of a fixture moves; None of any other object.
        holes: The holes in its boxes.
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
    joint: ObjectJoint | None = None
    holes: tuple[Hole, ...] = ()

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
