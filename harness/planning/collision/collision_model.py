"""What a scene holds: objects, payloads, and the bodies and pairs that are checked."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import pinocchio as pin

from harness.core.geometry import Shape
from harness.core.spatial import SE3
from harness.core.types import BoolArray, FloatArray, IntArray
from harness.planning.collision.near_pairs import PlacedShapes
from harness.planning.collision.rigid_shapes import RigidShapes
from harness.planning.model.robot_model import RobotModel, pin_from_se3
from harness.ports.scene import Touch


@dataclass(frozen=True, eq=False)
class SceneObject:
    """An object of the scene.

    Attributes:
        shapes: The shapes on the body.
        pose: T_world_object, or T_link_object while attached.
        link: What it is attached to; None while it stands in the world.
        touch_links: Links it may touch while attached.
        mass: The mass of the object [kg].
        center_of_mass: The centre of mass in the object [m], shape (3,).
        inertia: The inertia about the centre of mass, object axes, shape (3, 3).
    """

    name: str
    shapes: tuple[Shape, ...]
    pose: SE3
    link: str | None = None
    touch_links: frozenset[str] = frozenset()
    mass: float = 0.0
    center_of_mass: FloatArray = field(default_factory=lambda: np.zeros(3))
    inertia: FloatArray = field(default_factory=lambda: np.zeros((3, 3)))


@dataclass(frozen=True, eq=False)
class SceneState:
    """A snapshot of a planning scene."""

    objects: Mapping[str, SceneObject]
    allowed: frozenset[tuple[str, str]]
    unpadded: frozenset[tuple[str, str]]


@dataclass(frozen=True, eq=False)
class Body:
    """A link or an object as a set of geometries that move together.

    Attributes:
        rigid: Its shapes, and the joint that moves them.
        is_held: Whether this is an attached object.
    """

    name: str
    rigid: RigidShapes
    is_link: bool
    is_held: bool


@dataclass(frozen=True, eq=False)
class CollisionModel:
    """The scene as it is now, ready to be checked; not changed after it was made.

    Attributes:
        pairs: The indices of two bodies that are checked against each other, shape (K, 2); first
            the robot's link or the held object where there is one.
        keeps_padding: Whether a pair is the robot (or what it holds) and an object of the world
            that it is not about to grasp, or two arms (or what they hold), shape (K,).
    """

    robot: RobotModel
    bodies: tuple[Body, ...]
    pairs: IntArray
    keeps_padding: BoolArray

    def names(self, pair: int) -> tuple[str, str]:
        """The names of the two bodies of a pair."""
        first, second = self.pairs[pair].tolist()
        return self.bodies[first].name, self.bodies[second].name

    def margins(self, padding: float) -> FloatArray:
        """The margin of each pair of bodies without exceptions [m], shape (K,)."""
        return np.where(self.keeps_padding, padding, 0.0)

    @cached_property
    def geometry(self) -> pin.GeometryModel:
        """The shapes of all bodies, one after another, and their pairs."""
        geometry = pin.GeometryModel()
        for body in self.bodies:
            joint, solids = body.rigid.joint, zip(body.rigid.shapes, body.rigid.solids, strict=True)
            for number, (shape, solid) in enumerate(solids):
                name, place = f"{body.name}#{number}", pin_from_se3(shape.pose)
                geometry.addGeometryObject(pin.GeometryObject(name, joint, place, solid))
        geometry.setCollisionPairs(self._pair_of_shapes >= 0)
        return geometry

    @cached_property
    def rows(self) -> IntArray:
        """The two shapes of each of the geometry model's collision pairs, shape (R, 2)."""
        return np.argwhere(self._pair_of_shapes >= 0)

    @cached_property
    def pair_of_row(self) -> IntArray:
        """The pair of bodies that each of them belongs to, shape (R,)."""
        return self._pair_of_shapes[self.rows[:, 0], self.rows[:, 1]]

    @cached_property
    def _pair_of_shapes(self) -> IntArray:
        """The pair of bodies of each two shapes, the earlier one first, or -1, shape (G, G)."""
        of_bodies = np.full((len(self.bodies), len(self.bodies)), -1)
        of_bodies[self.pairs.min(axis=1), self.pairs.max(axis=1)] = np.arange(len(self.pairs))
        body_of = np.repeat(np.arange(len(self.bodies)), [len(b.rigid.shapes) for b in self.bodies])
        return of_bodies[body_of[:, None], body_of]

    def check_data(self, margins: FloatArray) -> pin.GeometryData:
        """Data for checks that find pairs nearer than their margins [m].

        Checks begin anew at each state: from the guess of the state before, Coal overlooks
        collisions of up to 5 cm.
        """
        data = self._plain_check_data.copy()
        of_shapes = np.zeros((self.geometry.ngeoms, self.geometry.ngeoms))
        of_shapes[self.rows[:, 0], self.rows[:, 1]] = margins[self.pair_of_row]
        data.setSecurityMargins(self.geometry, of_shapes, True, False)
        return data

    @cached_property
    def _plain_check_data(self) -> pin.GeometryData:
        """The same without margins; setting up every pair takes milliseconds."""
        data = self.geometry.createData()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)
            for request in data.collisionRequests:
                request.enable_cached_gjk_guess = False
        return data

    @cached_property
    def distance_data(self) -> pin.GeometryData:
        """Data for the distances of all pairs."""
        return self.geometry.createData()

    def near(self, configuration: FloatArray, margins: FloatArray) -> list[tuple[int, Touch]]:
        """Pairs that are not farther apart than their margins, with their index, nearest first."""
        robot, of_row = self.robot, self.pair_of_row
        pin.forwardKinematics(robot.model, robot.data, configuration)
        nearest: dict[int, float] = {}
        for row, distance in self._shapes.near(robot.data.oMi, self.rows, margins[of_row]):
            pair = int(of_row[row])
            nearest[pair] = min(distance, nearest.get(pair, np.inf))
        found = [
            (pair, Touch(*self.names(pair), distance, float(margins[pair])))
            for pair, distance in nearest.items()
        ]
        return sorted(found, key=lambda each: (each[1].distance, each[1].first, each[1].second))

    @cached_property
    def _shapes(self) -> PlacedShapes:
        return PlacedShapes([body.rigid for body in self.bodies])
