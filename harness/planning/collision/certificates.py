"""Arranges a group's motion and the scene's sphere covers in arrays that certify edges."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
import pinocchio as pin

from harness.core.geometry import Box, Capsule, Cylinder, Geometry, Mesh, Plane, Sphere
from harness.core.spatial import SE3
from harness.core.types import FloatArray, IntArray
from harness.planning.collision.scene import Body, BodyPair, CollisionModel
from harness.planning.collision.sphere_cover import cover_shapes
from harness.planning.model.robot_model import GroupSpace
from harness.robot.description import Joint

BOX, CYLINDER, CAPSULE, SPHERE, PLANE, MESH = range(6)
"""Shape kinds of the compiled stage."""

ROUNDING = 1e-5
"""Band around a margin that is left undecided, because of Coal's tolerance [m]."""


@dataclass(frozen=True, eq=False)
class MotionArrays:
    """Arrays that check a motion of one group in one scene; `edge_kernel.certify` explains each.

    Attributes:
        columns: The indices of the moving joints in description order.
        rows: The indices of Coal's collision pairs for each check.
    """

    columns: IntArray
    nodes: FloatArray
    skip: IntArray
    parent: IntArray
    chain: FloatArray
    body_poses: FloatArray
    bodies: IntArray
    part_data: FloatArray
    parts: IntArray
    margins: FloatArray
    checks: IntArray
    keys: IntArray
    joints: IntArray
    rows: tuple[tuple[int, ...], ...]

    def certify(
        self, stage: Callable[..., Any], values: FloatArray, straight: bool, found: IntArray
    ) -> tuple[int, int]:
        """Call `edge_kernel.certify` on values of the moving joints, shape (N, M)."""
        return stage(
            values,
            straight,
            self.nodes,
            self.skip,
            self.parent,
            self.chain,
            self.body_poses,
            self.bodies,
            self.part_data,
            self.parts,
            self.margins,
            self.checks,
            self.keys,
            self.joints,
            found,
        )


def motion_arrays(
    model: CollisionModel, space: GroupSpace, margins: Mapping[tuple[str, str], float]
) -> MotionArrays:
    """Create the arrays of a scene for a group's motions; pairs that move together are left out."""
    moving = MovingJoints(space)
    layout = _layout(model, moving)
    margin = np.array([margins[pair.first, pair.second] for pair in model.pairs])[layout.pairs]
    free = np.maximum(margin, 0.0) + ROUNDING
    blocked = np.where(margin >= 0, margin - ROUNDING, -np.inf)
    return MotionArrays(
        columns=moving.columns,
        nodes=layout.nodes,
        skip=layout.skip,
        parent=moving.parent,
        chain=moving.chain,
        body_poses=moving.body_poses(model.bodies),
        bodies=layout.body_rows,
        part_data=np.array(layout.part_data).reshape(-1, 15),
        parts=np.array(layout.parts, dtype=np.int64).reshape(-1, 3),
        margins=np.column_stack([free, blocked]),
        checks=np.array(layout.checks, dtype=np.int64).reshape(-1, 3),
        keys=np.array(layout.keys, dtype=np.int64).reshape(-1, 6),
        joints=np.array(layout.joints or [0], dtype=np.int64),
        rows=tuple(layout.rows),
    )


class MovingJoints:
    """The joints that a group's motion moves; all other joints are fixed.

    Attributes:
        columns: Their indices in description order, shape (M,).
        parent: The moving joint before each, or -1, shape (M,).
        chain: Pose on the parent at zero (12), axis (3), 1 if prismatic, shape (M, 16).
        above: The moving joint that carries each Pinocchio joint, or -1.
    """

    def __init__(self, space: GroupSpace) -> None:
        robot, description = space.robot, space.robot.description
        pin_model = robot.model
        at_zero = np.array(space.offset)
        pin.forwardKinematics(pin_model, robot.data, robot.configuration(at_zero))
        self._poses = [np.array(pose.homogeneous) for pose in robot.data.oMi]
        is_moving = np.any(space.matrix != 0, axis=1)
        index_of = {name: i for i, name in enumerate(description.joint_names)}
        self.above: list[int] = [-1]
        self._at: list[int] = []
        columns: list[int] = []
        parent: list[int] = []
        rows: list[FloatArray] = []
        for joint in range(1, pin_model.njoints):
            name = pin_model.names[joint]
            before = self.above[pin_model.parents[joint]]
            if not is_moving[index_of[name]]:
                self.above.append(before)
                continue
            known = description.joint_by_name[name]
            turn = float(at_zero[index_of[name]])
            pose = self._seen(before, joint) @ np.linalg.inv(_joint_motion(known, turn))
            self.above.append(len(columns))
            self._at.append(joint)
            columns.append(index_of[name])
            parent.append(before)
            kind = [1.0 if known.kind == "prismatic" else 0.0]
            rows.append(np.concatenate([_flat(pose), known.axis, kind]))
        self.columns: IntArray = np.array(columns, dtype=np.int64)
        self.parent: IntArray = np.array(parent, dtype=np.int64)
        self.chain: FloatArray = np.array(rows).reshape(-1, 16)

    def _seen(self, moving: int, joint: int) -> FloatArray:
        """Pose of a Pinocchio joint relative to a moving joint (-1: the world), shape (4, 4)."""
        if moving < 0:
            return self._poses[joint]
        return np.linalg.inv(self._poses[self._at[moving]]) @ self._poses[joint]

    def body_poses(self, bodies: tuple[Body, ...]) -> FloatArray:
        """Poses of bodies relative to the moving joints that carry them, shape (B, 12)."""
        rows = [_flat(self._seen(self.above[body.joint], body.joint)) for body in bodies]
        return np.array(rows).reshape(-1, 12)

    def path(self, joint: int) -> list[int]:
        """Moving joints from one to the base, tip first."""
        found = []
        while joint >= 0:
            found.append(joint)
            joint = int(self.parent[joint])
        return found


@dataclass(frozen=True, eq=False)
class _Trees:
    """Spheres of all bodies (K, 5), the ends of their subtrees (K,), and body ranges (B, 2)."""

    nodes: FloatArray
    skip: IntArray
    ranges: IntArray


class _Layout:
    """The checks of a scene as indices of covers, parts and keys.

    Attributes:
        nodes: The spheres of all bodies.
        skip: The ends of their subtrees.
        body_rows: The joint that carries each body, and the body's range of spheres.
        parts: The body, kind and first sphere of each shape that spheres are checked against.
        part_data: The poses and sizes of the parts.
        keys: The joints that move two bodies relative to each other, as ranges of `joints`.
        joints: The joints of all keys.
        checks: The body with the spheres, the other body's part and the key of each check.
        pairs: The index of each check's pair in the scene.
        rows: The indices of Coal's collision pairs of each check.
    """

    def __init__(self, model: CollisionModel, moving: MovingJoints) -> None:
        self._bodies, self._moving = model.bodies, moving
        self._geometry = model.geometry
        self._index = {body.name: number for number, body in enumerate(model.bodies)}
        self._carrier = [moving.above[body.joint] for body in model.bodies]
        self._only_solid = [
            not any(isinstance(shape.geometry, Mesh) for shape in body.shapes)
            for body in model.bodies
        ]
        self._has_plane = [
            any(isinstance(shape.geometry, Plane) for shape in body.shapes) for body in model.bodies
        ]
        trees = _trees(model)
        self.nodes, self.skip = trees.nodes, trees.skip
        self.body_rows: IntArray = np.column_stack([self._carrier, trees.ranges]).astype(np.int64)
        self._radius = [
            float(trees.nodes[start, 3]) if start < end else np.inf for start, end in trees.ranges
        ]
        self.parts: list[tuple[int, int, int]] = []
        self.part_data: list[FloatArray] = []
        self.keys: list[tuple[int, int, int, int, int, int]] = []
        self.joints: list[int] = []
        self._parts_of: dict[int, list[tuple[int, int]]] = {}
        self._key_of: dict[tuple[int, int], int] = {}
        self.checks: list[tuple[int, int, int]] = []
        self.pairs: list[int] = []
        self.rows: list[tuple[int, ...]] = []
        for number, pair in enumerate(model.pairs):
            for body, part, key, pair_rows in self._checks_of(pair):
                self.checks.append((body, part, key))
                self.pairs.append(number)
                self.rows.append(pair_rows)

    def _checks_of(self, pair: BodyPair) -> list[tuple[int, int, int, tuple[int, ...]]]:
        """For each part: the body with the tree, the other body's part, the key and Coal's rows."""
        first, second = self._index[pair.first], self._index[pair.second]
        if self._carrier[first] == self._carrier[second]:
            return []
        body, other = sorted(
            (first, second),
            key=lambda b: (self._has_plane[b], self._only_solid[b], self._radius[b]),
        )
        by_shape: dict[int, list[int]] = {}
        tree_geometries = set(self._bodies[body].geometries)
        for row in pair.pairs:
            ends = self._geometry.collisionPairs[row]
            geometry = ends.second if ends.first in tree_geometries else ends.first
            by_shape.setdefault(int(geometry), []).append(row)
        key = self._key(body, other)
        if not self._only_solid[other]:
            return [(body, self._tree_part(other), key, tuple(pair.pairs))]
        return [
            (body, part, key, tuple(by_shape[geometry]))
            for part, geometry in self._solid_parts(other)
        ]

    def _solid_parts(self, body: int) -> list[tuple[int, int]]:
        """The part and Coal's geometry index of each shape of a body."""
        if body not in self._parts_of:
            found = []
            for geometry, shape in zip(
                self._bodies[body].geometries, self._bodies[body].shapes, strict=True
            ):
                kind, size = _kind_and_size(shape.geometry)
                found.append((len(self.parts), geometry))
                self.parts.append((body, kind, 0))
                self.part_data.append(np.concatenate([_flat(_matrix(shape.pose)), size]))
            self._parts_of[body] = found
        return self._parts_of[body]

    def _tree_part(self, body: int) -> int:
        """The part that stands for a body's whole tree."""
        if body not in self._parts_of:
            self._parts_of[body] = [(len(self.parts), -1)]
            self.parts.append((body, MESH, int(self.body_rows[body, 1])))
            self.part_data.append(np.concatenate([_flat(np.eye(4)), np.zeros(3)]))
        return self._parts_of[body][0][0]

    def _key(self, body: int, other: int) -> int:
        """The joints that move a body relative to the joint that carries another."""
        carrier = self._carrier[other]
        if (body, carrier) in self._key_of and carrier < 0:
            return self._key_of[body, carrier]
        first, second = self._moving.path(self._carrier[body]), self._moving.path(carrier)
        near = [joint for joint in first if joint not in second]
        far = [joint for joint in second if joint not in first]
        start = len(self.joints)
        self.joints += near + far
        middle, end = start + len(near), start + len(near) + len(far)
        self.keys.append((body if near else -1, other if far else -1, start, middle, middle, end))
        self._key_of[body, carrier] = len(self.keys) - 1
        return len(self.keys) - 1


_cover_cache: WeakKeyDictionary[CollisionModel, _Trees] = WeakKeyDictionary()
_layout_cache: WeakKeyDictionary[CollisionModel, dict[tuple[int, ...], _Layout]] = (
    WeakKeyDictionary()
)


def _layout(model: CollisionModel, moving: MovingJoints) -> _Layout:
    """The cached layout of a scene for one set of moving joints."""
    layouts = _layout_cache.setdefault(model, {})
    key = (*moving.above, *moving.parent.tolist())
    if key not in layouts:
        layouts[key] = _Layout(model, moving)
    return layouts[key]


def _trees(model: CollisionModel) -> _Trees:
    """The concatenated sphere trees of a scene's bodies; cached per scene."""
    if model not in _cover_cache:
        covers = [cover_shapes(body.shapes) if _has_tree(body) else None for body in model.bodies]
        sizes = [0 if cover is None else len(cover.outer) for cover in covers]
        ends = np.cumsum([0, *sizes])
        nodes = [np.column_stack([c.centers, c.outer, c.inner]) for c in covers if c is not None]
        skips = [c.skip + at for c, at in zip(covers, ends[:-1], strict=True) if c is not None]
        _cover_cache[model] = _Trees(
            nodes=np.vstack([np.zeros((0, 5)), *nodes]),
            skip=np.concatenate([np.zeros(0, dtype=np.int64), *skips]),
            ranges=np.column_stack([ends[:-1], ends[1:]]),
        )
    return _cover_cache[model]


def _has_tree(body: Body) -> bool:
    """Whether a body has a sphere tree: movable bodies and meshes have one, planes have none."""
    kinds = {type(shape.geometry) for shape in body.shapes}
    return Plane not in kinds and (body.joint != 0 or Mesh in kinds)


def _kind_and_size(geometry: Geometry) -> tuple[int, FloatArray]:
    match geometry:
        case Box(size=size):
            return BOX, 0.5 * np.array(size)
        case Cylinder(radius=radius, length=length):
            return CYLINDER, np.array([radius, 0.5 * length, 0.0])
        case Capsule(radius=radius, length=length):
            return CAPSULE, np.array([radius, 0.5 * length, 0.0])
        case Sphere(radius=radius):
            return SPHERE, np.array([radius, 0.0, 0.0])
        case Plane():
            return PLANE, np.zeros(3)
        case Mesh():
            raise ValueError("a mesh has no closed-form distance")


def _joint_motion(joint: Joint, value: float) -> FloatArray:
    """The transform of a joint at a position, in the joint's frame, shape (4, 4)."""
    axis = np.asarray(joint.axis, dtype=float)
    motion = np.eye(4)
    if joint.kind == "prismatic":
        motion[:3, 3] = axis * value
    else:
        motion[:3, :3] = pin.exp3(axis * value)
    return motion


def _matrix(pose: SE3) -> FloatArray:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = pose.rotation, pose.translation
    return matrix


def _flat(matrix: FloatArray) -> FloatArray:
    """Rotation row by row, then translation, shape (12,)."""
    return np.concatenate([matrix[:3, :3].reshape(-1), matrix[:3, 3]])
