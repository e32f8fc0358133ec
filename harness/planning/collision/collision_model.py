"""What a scene holds: objects, payloads, and the bodies and pairs that are checked."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import pinocchio as pin

from harness.core.geometry import Shape
from harness.core.spatial import SE3
from harness.core.types import FloatArray, IntArray
from harness.planning.collision.convex_tree import ConvexTree, shapes_tree
from harness.planning.model.robot_model import RobotModel, pin_from_se3
from harness.ports.scene import Touch
from harness.robot.solids import coal_geometry

_MEASURED = 1e-4  # [m] extra margin within which found pairs are measured


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

    shapes: tuple[Shape, ...]
    pose: SE3
    link: str | None = None
    touch_links: frozenset[str] = frozenset()
    mass: float = 0.0
    center_of_mass: FloatArray = field(default_factory=lambda: np.zeros(3))
    inertia: FloatArray = field(default_factory=lambda: np.zeros((3, 3)))


@dataclass(frozen=True, eq=False)
class SceneState:
    """A snapshot of a planning scene.

    Attributes:
        objects: The objects by name.
        allowed: Pairs that the scene allows in addition to the robot's.
        unpadded: Pairs that keep no padding.
    """

    objects: Mapping[str, SceneObject]
    allowed: frozenset[tuple[str, str]]
    unpadded: frozenset[tuple[str, str]]


@dataclass(frozen=True, eq=False)
class Payload:
    """What an attached object adds to the link that carries it; as in SceneObject."""

    name: str
    link: str
    pose: SE3
    mass: float
    center_of_mass: FloatArray
    inertia: FloatArray


@dataclass(frozen=True, eq=False)
class RigidShapes:
    """Shapes that move together; scenes share them as long as they are the same.

    Attributes:
        joint: Pinocchio's joint they move with; 0 stands still.
        shapes: The shapes, placed on the joint.
    """

    joint: int
    shapes: tuple[Shape, ...]

    def add_to(self, geometry: pin.GeometryModel, name: str) -> range:
        """Add the shapes to a geometry model; returns their indices there."""
        start = geometry.ngeoms
        for number, shape in enumerate(self.shapes):
            solid, place = coal_geometry(shape), pin_from_se3(shape.pose)
            added = pin.GeometryObject(f"{name}#{number}", self.joint, place, solid)
            geometry.addGeometryObject(added)
        return range(start, geometry.ngeoms)

    @cached_property
    def tree(self) -> ConvexTree:
        """Their tree in the frame of the joint."""
        return shapes_tree(self.shapes)

    @cached_property
    def box(self) -> FloatArray:
        """The lower and the upper corner of the box about them in the joint's frame, shape (6,)."""
        return self.tree.box()


def rigid_shapes(
    robot: RobotModel, link: str | None, pose: SE3, shapes: Sequence[Shape]
) -> RigidShapes:
    """Shapes of a body at a pose in a link's frame, or in the world where the link is None."""
    joint, T_joint_body = 0, pose
    if link is not None:
        joint, T_joint_body = robot.parent_joint(link), robot.placement(link) @ pose
    placed = tuple(replace(shape, pose=T_joint_body @ shape.pose) for shape in shapes)
    return RigidShapes(joint, placed)


@dataclass(frozen=True, eq=False)
class Body:
    """A link or an object as a set of geometries that move together.

    Attributes:
        name: The name of the link or the object.
        rigid: Its shapes, and the joint that moves them.
        geometries: Indices of the shapes in the geometry model.
        is_link: A link of the robot.
        is_held: Whether this is an attached object.
    """

    name: str
    rigid: RigidShapes
    geometries: range
    is_link: bool
    is_held: bool


@dataclass(frozen=True, eq=False)
class BodyPair:
    """Two bodies that are checked against each other.

    Attributes:
        first: Name; the robot's link or the held object where there is one.
        second: The name of the second body.
        keeps_padding: Between the robot (or what it holds) and an object of the world that it is
            not about to grasp.
        rows: Indices of the geometry model's collision pairs.
    """

    first: str
    second: str
    keeps_padding: bool
    rows: list[int]


def check_data(geometry: pin.GeometryModel) -> pin.GeometryData:
    """Data for checks of collisions that begin anew at each state.

    From the guess of the state before, Coal overlooks collisions of up to 5 cm.
    """
    data = geometry.createData()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        for request in data.collisionRequests:
            request.enable_cached_gjk_guess = False
    return data


@dataclass(eq=False)
class SharedData:
    """Coal's data of a scene, which takes milliseconds to make.

    Attributes:
        geometry_data: The requests with their margins, and the results of the last check.
        holder: The user whose margins the requests have.
    """

    geometry_data: pin.GeometryData
    holder: object = None


@dataclass(frozen=True, eq=False)
class CollisionModel:
    """The scene as it is now, ready to be checked; not changed after it was made.

    Attributes:
        rows: The geometries of each of the geometry model's collision pairs, shape (R, 2).
    """

    robot: RobotModel
    geometry: pin.GeometryModel
    bodies: tuple[Body, ...]
    pairs: tuple[BodyPair, ...]
    rows: IntArray

    @cached_property
    def shared(self) -> SharedData:
        """The data that all checkers of this scene share."""
        return SharedData(check_data(self.geometry))

    def margin_map(self, margins: Sequence[float]) -> FloatArray:
        """The margins of all pairs of bodies, as Pinocchio takes them for pairs of geometries."""
        found = np.zeros((self.geometry.ngeoms, self.geometry.ngeoms))
        of_row = np.zeros(len(self.rows))
        for pair, margin in zip(self.pairs, margins, strict=True):
            of_row[pair.rows] = margin
        found[self.rows[:, 0], self.rows[:, 1]] = of_row
        return found

    def set_margins(self, margins: Sequence[float], holder: object = None) -> None:
        """Let checks of collisions find pairs that are nearer than their margins [m]."""
        found = self.margin_map(margins)
        self.shared.geometry_data.setSecurityMargins(self.geometry, found, True, False)
        self.shared.holder = holder

    def near(self, configuration: FloatArray, margins: Sequence[float]) -> list[Touch]:
        """Pairs that are not farther apart than their margins, nearest first.

        Only pairs that a check of collisions finds are measured, which takes half of the time.

        Args:
            configuration: The whole robot's, as Pinocchio has it.
            margins: The margin of each pair of bodies [m].
        """
        self.set_margins([margin + _MEASURED for margin in margins])
        robot, geometry, found = self.robot, self.geometry, self.shared.geometry_data
        if not pin.computeCollisions(
            robot.model, robot.data, geometry, found, configuration, False
        ):
            return []
        results, near = found.collisionResults, list[Touch]()
        for pair, margin in zip(self.pairs, margins, strict=True):
            if any(results[row].isCollision() for row in pair.rows):
                distance = min(
                    float(pin.computeDistance(geometry, found, row).min_distance)
                    for row in pair.rows
                )
                if distance <= margin:
                    near.append(Touch(pair.first, pair.second, distance, margin))
        return sorted(near, key=lambda touch: (touch.distance, touch.first, touch.second))
