"""Arranges a group's motion and the scene's shapes in the arrays of the compiled check."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import chain
from typing import Any

import numpy as np
import pinocchio as pin

from harness.core.geometry import Plane
from harness.core.types import FloatArray, IntArray
from harness.planning.collision.collision_model import Body, CollisionModel
from harness.planning.collision.convex_tree import concatenate
from harness.planning.collision.native.library import FULL, Certify, address_of
from harness.planning.collision.rigid_shapes import RigidShapes
from harness.planning.collision.sampled_motion import SampledMotion
from harness.planning.model.robot_model import GroupSpace, RobotModel

ROUNDING = 1e-5  # Band around a margin that is left undecided, because of Coal's tolerance [m]
MOST_LEFT = 64 * 1024
"""Size of the memory for the pairs that are left in the intervals of a motion; where it is full,
all pairs of the whole interval are compared again."""

Array = np.ndarray[Any, Any]
Arrays = tuple[Array, ...]

VARYING = 4
"""Number of arrays that differ from motion to motion; they are the first ones of the table."""

INTERVALS = 1024  # Number of intervals of a motion for which there is memory at first

NONE: IntArray = np.empty((0, 2), dtype=np.int64)


class MotionArrays:
    """Checks a motion of one group in one scene with the compiled `certify`.

    Attributes:
        table: The address of each array and its shape, filled up with ones, in the order in which
            native/arrays.h names them, shape (arrays, 4).
    """

    def __init__(self, rest: FloatArray, drive: FloatArray, arrays: Arrays) -> None:
        """Keep what `certify` needs.

        Args:
            rest: The positions of the moving joints where the group's are zero, shape (M,).
            drive: What the group's positions add to them, shape (M, dof).
        """
        self._rest, self._drive = rest, np.ascontiguousarray(drive.T)
        self._line = np.empty((2, len(rest))), np.empty(2)  # of most motions
        self._corners, self._places = self._line
        self._arrays: list[Array] = [np.ascontiguousarray(array) for array in arrays]
        self.table = np.ones((VARYING + len(arrays), 4), dtype=np.int64)
        self._address = int(self.table.ctypes.data)
        for row, array in enumerate(self._arrays, start=VARYING):
            self._enter(row, array)
        self._enter(0, self._corners)
        self._enter(1, self._places)
        self._make_room(INTERVALS)

    def certify(
        self, check: Certify, motion: SampledMotion, low: int, high: int
    ) -> tuple[int, IntArray]:
        """Classify the states of a motion from `low` to `high`.

        Returns:
            A blocked state or -1, and the first and last states of undecided stretches, (n, 2).
        """
        corners, places = self._line
        if len(motion.places) != len(places):
            corners, places = np.empty((len(motion.places), len(self._rest))), motion.places.copy()
        np.matmul(motion.corners, self._drive, out=corners)
        corners += self._rest
        places[:] = motion.places
        if corners is not self._corners:
            self._corners, self._places = corners, places
            self._enter(0, corners)
            self._enter(1, places)
        undecided = check(self._address, low, high)
        while undecided == FULL:
            self._make_room(4 * len(self._queue))
            undecided = check(self._address, low, high)
        return (-1, self._found[:undecided]) if undecided >= 0 else (-1 - undecided, NONE)

    def _make_room(self, rows: int) -> None:
        """Provide the memory for a number of intervals."""
        self._queue = np.empty((rows, 4), dtype=np.int64)
        self._found = np.empty((rows, 2), dtype=np.int64)
        self._enter(2, self._queue)
        self._enter(3, self._found)

    def _enter(self, row: int, array: Array) -> None:
        self.table[row, 0] = address_of(array)
        self.table[row, 1 : 1 + array.ndim] = array.shape


def motion_arrays(model: CollisionModel, space: GroupSpace, margins: FloatArray) -> MotionArrays:
    """Create the arrays of a scene for a group's motions; pairs that move together are left out."""
    is_moving = np.any(space.matrix != 0, axis=1)
    held = np.where(is_moving, 0.0, space.offset)
    moving = _moving_joints(space.robot, tuple(is_moving.tolist()), tuple(held.tolist()))
    layout = _layout(model, tuple(moving.above), tuple(moving.parent.tolist()))
    margin = margins[layout.pairs]
    free = np.maximum(margin, 0.0) + ROUNDING
    blocked = np.where(margin >= 0, margin - ROUNDING, -np.inf)
    links, objects = (
        _tree_arrays(tuple(each.rigid for each in model.bodies if each.is_link == is_link))
        for is_link in (True, False)
    )
    arrays = (
        *(moving.parent, moving.chain, moving.body_poses(model.bodies)),
        *(layout.body_rows, layout.boxes, layout.balls),
        *(*links, links[2][:, 0].copy(), *objects, objects[2][:, 0].copy()),
        *(
            np.column_stack([free, blocked]),
            *map(_indices, (layout.checks, layout.paths, layout.joints)),
        ),
        *_working_memory(layout, len(moving.columns)),
    )
    return MotionArrays(space.offset[moving.columns], space.matrix[moving.columns], arrays)


@lru_cache(maxsize=8)
def _tree_arrays(bodies: tuple[RigidShapes, ...]) -> Arrays:
    """The arrays of the trees of bodies, one after another; scenes share those of the links."""
    tree = concatenate([rigid.tree for rigid in bodies])
    sets = _indices(tree.convexes), tree.sizes, tree.points
    return tree.spheres, tree.nodes, *sets, _indices(tree.edges_at), _indices(tree.edges)


def _indices(array: Array) -> Array:
    """Indices as the compiled code reads them, in half the memory."""
    return array.astype(np.uint32)


def _working_memory(layout: _Layout, width: int) -> Arrays:
    """The memory of the compiled check that does not depend on the length of a motion."""
    bodies, pairs, deepest = len(layout.body_rows), len(layout.checks), layout.deepest
    joints, motions = ((width,), (2, width), (width, 12)), (bodies, 1 + deepest, 9)
    return (
        *(np.zeros(shape) for shape in (*joints, (bodies, 12), (bodies, 3), motions)),
        np.zeros((pairs, 3)),
        np.empty(bodies, dtype=np.int64),
        np.arange(max(MOST_LEFT, 2 * pairs), dtype=np.uint32),
    )


class MovingJoints:
    """The joints that a group's motion moves; all other joints are fixed.

    Attributes:
        columns: Their indices in description order, shape (M,).
        parent: The moving joint before each, or -1, shape (M,).
        chain: Pose on the parent at zero (12), axis (3), 1 if prismatic, shape (M, 16).
        above: The moving joint that carries each Pinocchio joint, or -1.
    """

    def __init__(self, robot: RobotModel, is_moving: Sequence[bool], held: FloatArray) -> None:
        description, pin_model = robot.description, robot.model
        pin.forwardKinematics(pin_model, robot.data, robot.configuration(held))
        self._poses = [pin.SE3(pose) for pose in robot.data.oMi]
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
            self.above.append(len(columns))
            self._at.append(joint)
            columns.append(index_of[name])
            parent.append(before)
            kind = [1.0 if known.kind == "prismatic" else 0.0]
            rows.append(np.concatenate([self._seen(before, joint), known.axis, kind]))
        self.columns: IntArray = np.array(columns, dtype=np.int64)
        self.parent: IntArray = np.array(parent, dtype=np.int64)
        self.chain: FloatArray = np.array(rows).reshape(-1, 16)

    def _seen(self, moving: int, joint: int) -> FloatArray:
        """Pose of a Pinocchio joint relative to a moving joint (-1: the world), shape (12,)."""
        pose = self._poses[joint]
        if moving >= 0:
            pose = self._poses[self._at[moving]].actInv(pose)
        return np.concatenate([pose.rotation.reshape(-1), pose.translation])

    def body_poses(self, bodies: tuple[Body, ...]) -> FloatArray:
        """Poses of bodies relative to the moving joints that carry them, shape (B, 12)."""
        joints = [body.rigid.joint for body in bodies]
        poses = {joint: self._seen(self.above[joint], joint) for joint in {*joints}}
        return np.array([poses[joint] for joint in joints]).reshape(-1, 12)


@lru_cache(maxsize=4)
def _moving_joints(
    robot: RobotModel, is_moving: tuple[bool, ...], held: tuple[float, ...]
) -> MovingJoints:
    """The same ones while the other joints are held where they are; moving ones count as zero."""
    return MovingJoints(robot, is_moving, np.array(held))


class _Layout:
    """The pairs of a scene as indices of bodies.

    Attributes:
        body_rows: The joint that carries each body, its root in the tree of the links or of the
            objects, and which of them that is, 0 or 1, shape (B, 3).
        boxes: The lower and upper corner of each body's bounding box, shape (B, 6).
        balls: Centre and radius of each body's ball, shape (B, 4).
        paths: Where the joints of each body begin in `joints`, shape (B + 1,).
        joints: The moving joints that carry each body, tip first.
        checks: The two bodies of each pair, and how many of the joints of each body move it
            relative to the other, shape (K, 4).
        pairs: The index of each of them in the scene, shape (K,).
    """

    def __init__(
        self, model: CollisionModel, above: tuple[int, ...], parent: tuple[int, ...]
    ) -> None:
        carriers = [above[body.rigid.joint] for body in model.bodies]
        carrier = np.array(carriers, dtype=np.int64)
        has_plane = np.array([_has_plane(body) for body in model.bodies], dtype=bool)
        first, second = model.pairs.T
        self.pairs: IntArray = np.flatnonzero(carrier[first] != carrier[second])
        ends = model.pairs[self.pairs]
        swapped = has_plane[ends[:, 0]]
        ends[swapped] = ends[swapped, ::-1]
        chains = [_path(each, parent) for each in range(-1, len(parent))]
        of_bodies = [chains[1 + each] for each in carriers]
        self.deepest = max(map(len, of_bodies), default=0)
        self.paths: IntArray = np.cumsum([0, *map(len, of_bodies)], dtype=np.int64)
        self.joints: IntArray = np.array([*chain(*of_bodies), 0], dtype=np.int64)
        shared = np.array([[len({*one} & {*other}) for other in chains] for one in chains])
        depths = np.array([len(each) for each in chains])
        ahead = 1 + carrier[ends]
        counts = depths[ahead] - shared[ahead[:, 0], ahead[:, 1]][:, None]
        self.checks: IntArray = np.column_stack([ends, counts]).astype(np.int64)
        self.boxes: FloatArray = np.array([body.rigid.box for body in model.bodies])
        self.balls: FloatArray = np.array([body.rigid.tree.spheres[0] for body in model.bodies])
        sizes = np.array([len(body.rigid.tree.nodes) for body in model.bodies], dtype=np.int64)
        is_link = np.array([body.is_link for body in model.bodies], dtype=bool)
        roots = np.where(is_link, np.cumsum(sizes * is_link), np.cumsum(sizes * ~is_link)) - sizes
        self.body_rows: IntArray = np.column_stack([carrier, roots, ~is_link]).astype(np.int64)


def _path(joint: int, parent: tuple[int, ...]) -> list[int]:
    """Moving joints from one to the base, tip first."""
    return [] if joint < 0 else [joint, *_path(parent[joint], parent)]


def _has_plane(body: Body) -> bool:
    return any(isinstance(shape.geometry, Plane) for shape in body.rigid.shapes)


@lru_cache(maxsize=4)
def _layout(model: CollisionModel, above: tuple[int, ...], parent: tuple[int, ...]) -> _Layout:
    """The layout of a scene for a set of moving joints."""
    return _Layout(model, above, parent)
