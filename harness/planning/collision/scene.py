"""The planning scene on Pinocchio and Coal: robot, objects, what is attached, what may touch."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import product

import numpy as np
import pinocchio as pin

from harness.core.errors import PlanningFailed, StepFailed
from harness.core.geometry import Plane, Shape
from harness.core.spatial import SE3
from harness.core.types import BoolArray, FloatArray
from harness.core.world import WorldObject
from harness.planning.collision.collision_model import (
    Body,
    CollisionModel,
    SceneObject,
    SceneState,
)
from harness.planning.collision.rigid_shapes import RigidShapes, link_shapes, rigid_shapes
from harness.planning.model.robot_model import RobotModel
from harness.ports.scene import Touch
from harness.recording.execution_failures import ObjectFailure
from harness.robot.description import RobotDescription
from harness.robot.solids import box_corners, coal_geometry, nearest_point
from harness.robot.srdf.srdf import link_pair

ROBOT = "robot"
"""Stands for every link of the robot in allowed pairs."""


class CoalScene:
    """The port `PlanningScene`; collision models are rebuilt when the scene has changed.

    Bodies that move together are never checked against each other: a static link and an object
    that stands in the world, two links of one rigid body, an object and the body that holds it.
    """

    def __init__(self, description: RobotDescription) -> None:
        self.description = description
        self.robot = RobotModel(description)
        self._objects: dict[str, SceneObject] = {}
        self._rigid: dict[str, tuple[SceneObject, RigidShapes]] = {}
        self._links = link_shapes(description)
        self._allowed: set[tuple[str, str]] = {
            link_pair(*pair) for pair in description.allowed_collisions
        }
        self._allowed |= {link_pair(joint.parent, joint.child) for joint in description.joints}
        self._extra: set[tuple[str, str]] = set()
        self._unpadded: frozenset[tuple[str, str]] = frozenset()
        self._model: CollisionModel | None = None

    # Changes -------------------------------------------------------------------------------

    def add_object(self, obj: WorldObject, pose: SE3) -> None:
        """Put an object into the scene, at T_world_object."""
        if obj.name in self._objects:
            raise StepFailed("INVALID_OBJECT_NAME", f"object '{obj.name}' is in the scene already")
        carried = obj.joint is None  # a part of a fixture is no load: its joint carries it
        self._objects[obj.name] = SceneObject(
            obj.name,
            obj.shapes,
            pose,
            mass=obj.mass if carried else 0.0,
            center_of_mass=obj.center_of_mass,
            inertia=obj.inertia if carried else np.zeros((3, 3)),
        )
        self._model = None
        if obj.joint is not None:
            self.set_allowed([(obj.name, obj.joint.fixture)], allowed=True)

    def remove_object(self, name: str) -> None:
        """Take an object out of the scene."""
        self._find(name)
        del self._objects[name]
        self._model = None

    def move_object(self, name: str, pose: SE3) -> None:
        """Set T_world_object of an object that is not attached."""
        found = self._find(name)
        if found.link is not None:
            raise StepFailed("INVALID_OBJECT_NAME", f"object '{name}' is attached to {found.link}")
        if np.array_equal(found.pose.matrix(), pose.matrix()):
            return
        self._objects[name] = replace(found, pose=pose)
        self._model = None

    def attach_object(
        self, name: str, link: str, touch_links: Sequence[str], joint_positions: FloatArray
    ) -> SE3:
        """Fix an object of the scene to a link where both stand now; returns T_link_object."""
        found = self._find(name)
        if link not in self.description.link_names:
            raise StepFailed("INVALID_LINK_NAME", f"the robot has no link '{link}'")
        T_world_object = self.object_pose(name, joint_positions)
        T_link_object = self.robot.link_pose(joint_positions, link).inverse() @ T_world_object
        touching = frozenset(touch_links) | {link}
        self._objects[name] = replace(found, pose=T_link_object, link=link, touch_links=touching)
        self._model = None
        return T_link_object

    def detach_object(self, name: str, joint_positions: FloatArray) -> SE3:
        """Let go of an attached object; it stays in the scene at the returned T_world_object."""
        found = self._find(name)
        if found.link is None:
            raise StepFailed("INVALID_OBJECT_NAME", f"object '{name}' is not attached")
        pose = self.object_pose(name, joint_positions)
        self._objects[name] = replace(found, pose=pose, link=None, touch_links=frozenset())
        self._model = None
        return pose

    def set_allowed(self, pairs: Sequence[tuple[str, str]], *, allowed: bool) -> None:
        """Allow (or check again) collisions of pairs of links or objects; `robot`: all links."""
        for pair in pairs:
            key = link_pair(*pair)
            if allowed:
                self._extra.add(key)
            else:
                self._extra.discard(key)
        self._model = None

    def set_unpadded(self, pairs: Sequence[tuple[str, str]]) -> None:
        """Apply no padding to these pairs of a link and an object, and to no others."""
        self._unpadded = frozenset(link_pair(*pair) for pair in pairs)
        self._model = None

    def snapshot(self) -> SceneState:
        """What is in the scene, and which pairs are allowed besides the robot's."""
        return SceneState(dict(self._objects), frozenset(self._extra), self._unpadded)

    def restore(self, state: SceneState) -> None:
        """Go back to a snapshot of this scene."""
        self._objects = dict(state.objects)
        self._extra, self._unpadded = set(state.allowed), state.unpadded
        self._model = None

    # Questions -----------------------------------------------------------------------------

    def object_names(self) -> tuple[str, ...]:
        """Objects in the scene, attached ones included, in order of adding."""
        return tuple(self._objects)

    def is_ground(self, name: str) -> bool:
        """Whether an object is solid without end below a plane."""
        return any(isinstance(shape.geometry, Plane) for shape in self._find(name).shapes)

    def attached(self) -> Mapping[str, str]:
        """Link of each attached object."""
        return {name: obj.link for name, obj in self._objects.items() if obj.link is not None}

    def payloads(self) -> tuple[SceneObject, ...]:
        """The attached objects that weigh something."""
        held = (found for found in self._objects.values() if found.link is not None)
        return tuple(found for found in held if found.mass > 0)

    def object_pose(self, name: str, joint_positions: FloatArray) -> SE3:
        """T_world_object, attached or not."""
        found = self._find(name)
        if found.link is None:
            return found.pose
        return self.robot.link_pose(np.asarray(joint_positions, float), found.link) @ found.pose

    def frame(self, name: str) -> tuple[str, SE3]:
        """The link that carries a link or an attached object, and T_link_frame.

        Raises:
            PlanningFailed: INVALID_LINK_NAME.
        """
        if name in self.description.link_names:
            return name, SE3.identity()
        held = self._objects.get(name)
        if held is None or held.link is None:
            raise PlanningFailed(
                "INVALID_LINK_NAME", f"'{name}' is neither a link nor an attached object"
            )
        return held.link, held.pose

    def touches(self, joint_positions: FloatArray, padding: float = 0.0) -> Sequence[Touch]:
        """Pairs closer than allowed at a state, nearest first."""
        model = self.collision_model()
        configuration = self.robot.configuration(np.asarray(joint_positions, dtype=float))
        return tuple(touch for _, touch in model.near(configuration, model.margins(padding)))

    def corners(self, body: str) -> FloatArray:
        """Corners of the boxes around a body's shapes; its origin where it has none, (n, 3)."""
        corners = [
            shape.pose.apply(box_corners(coal_geometry(shape))) for shape in self.shapes_of(body)
        ]
        return np.concatenate(corners) if corners else np.zeros((1, 3))

    def nearest_on_link(self, link: str, point: FloatArray) -> FloatArray:
        """The point of a link's shapes nearest to a point, itself inside, link axes, shape (3,)."""
        return nearest_point(self.shapes_of(link), point)

    def shapes_of(self, body: str) -> tuple[Shape, ...]:
        """The shapes of a link or an object, in its frame."""
        if body in self._objects:
            return self._objects[body].shapes
        return next(each.collisions for each in self.description.links if each.name == body)

    def distances(self, joint_positions: FloatArray) -> list[tuple[Touch, bool]]:
        """Signed distance of every checked pair of bodies [m], nearest first.

        With it, whether the pair keeps the padding: the robot and an object, or two arms.
        """
        model = self.collision_model()
        nearest = np.full(len(model.pairs), np.inf)
        np.minimum.at(nearest, model.pair_of_row, self._row_distances(joint_positions))
        found = [
            (Touch(*model.names(pair), distance), bool(model.keeps_padding[pair]))
            for pair, distance in enumerate(nearest.tolist())
        ]
        return sorted(found, key=lambda item: (item[0].distance, item[0].first, item[0].second))

    def nearest_points(self, joint_positions: FloatArray) -> tuple[Touch, FloatArray] | None:
        """The nearest pair, and its nearest points in the world, shape (2, 3).

        Pairs with an object come first; two links are always near each other.
        """
        distances, model = self._row_distances(joint_positions), self.collision_model()
        if not len(distances):
            return None
        is_object = np.array([not body.is_link for body in model.bodies], dtype=bool)
        with_object = np.any(is_object[model.pairs], axis=1)[model.pair_of_row]
        row = int(np.lexsort((distances, ~with_object))[0])
        nearest = model.distance_data.distanceResults[row]
        points = np.stack([nearest.getNearestPoint1(), nearest.getNearestPoint2()])
        return Touch(*model.names(int(model.pair_of_row[row])), float(distances[row])), points

    def _row_distances(self, joint_positions: FloatArray) -> FloatArray:
        """The signed distance of each pair of shapes that is checked [m], shape (R,)."""
        model, robot = self.collision_model(), self.robot
        configuration = robot.configuration(np.asarray(joint_positions, dtype=float))
        data = model.distance_data
        pin.computeDistances(robot.model, robot.data, model.geometry, data, configuration)
        return np.array([each.min_distance for each in data.distanceResults], dtype=float)

    def collision_model(self) -> CollisionModel:
        """Geometries and pairs of the scene as it is now."""
        if self._model is None:
            self._model = self._build()
        return self._model

    def _build(self) -> CollisionModel:
        bodies = [
            Body(name, rigid, is_link=True, is_held=False) for name, rigid in self._links.items()
        ]
        bodies += [
            Body(name, self._rigid_object(name), is_link=False, is_held=obj.link is not None)
            for name, obj in self._objects.items()
            if obj.shapes
        ]
        joints = np.array([body.rigid.joint for body in bodies], dtype=np.int64)
        checked = (joints[:, None] != joints) & ~_among(bodies, self._allowed_pairs())
        second, first = np.nonzero(np.tril(checked))
        # Links come before objects; a held object comes before what it could hit.
        is_link = np.array([body.is_link for body in bodies], dtype=bool)
        is_held = np.array([body.is_held for body in bodies], dtype=bool)
        swapped = is_held[second] & ~is_link[first]
        pairs = np.column_stack([first, second])
        pairs[swapped] = pairs[swapped, ::-1]
        carriers = [body.name if body.is_link else self._objects[body.name].link for body in bodies]
        arms = np.array([self.description.arm_of_link.get(link or "", "") for link in carriers])
        on_robot, arm = (is_link | is_held)[pairs], arms[pairs]
        differ = (on_robot[:, 0] != on_robot[:, 1]) | (arm[:, 0] != arm[:, 1]) & (arm != "").all(1)
        keeps_padding = ~_among(bodies, self._unpadded)[first, second] & differ
        return CollisionModel(self.robot, tuple(bodies), pairs, keeps_padding)

    def _allowed_pairs(self) -> Iterator[tuple[str, str]]:
        """Pairs of names that are not checked, in any order."""
        yield from self._allowed
        robot = {ROBOT: (ROBOT, *self._links)}
        for first, second in self._extra:
            yield from product(robot.get(first, (first,)), robot.get(second, (second,)))
        for name, obj in self._objects.items():
            if obj.link is not None:
                yield from ((name, link) for link in obj.touch_links)

    def _rigid_object(self, name: str) -> RigidShapes:
        """The shapes of an object where it is now; the same ones until it changes."""
        obj = self._objects[name]
        known = self._rigid.get(name)
        if known is None or known[0] is not obj:
            rigid = rigid_shapes(self.robot, obj.link, obj.pose, obj.shapes)
            known = self._rigid[name] = obj, rigid
        return known[1]

    def _find(self, name: str) -> SceneObject:
        if name not in self._objects:
            known = ", ".join(self._objects) or "none"
            raise StepFailed(
                "INVALID_OBJECT_NAME",
                f"the planning scene has no object '{name}' (it has: {known})",
                ObjectFailure(name, tuple(self._objects)),
            )
        return self._objects[name]


def _among(bodies: Sequence[Body], pairs: Iterable[tuple[str, str]]) -> BoolArray:
    """Whether two bodies are one of some pairs of names, shape (B, B)."""
    index = {body.name: number for number, body in enumerate(bodies)}
    known = [(index[a], index[b]) for a, b in pairs if a in index and b in index]
    first, second = np.array(known, dtype=np.int64).reshape(-1, 2).T
    found = np.zeros((len(bodies), len(bodies)), dtype=bool)
    found[first, second] = found[second, first] = True
    return found
