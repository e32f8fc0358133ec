"""What messages change of the planning scene, as plain values that a run records and repeats."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from harness.cell.cell import Cell
from harness.core.errors import StepFailed
from harness.plugins.ros.moveit.goals import BOX, SPHERE
from harness.plugins.ros.moveit.values import frame_of, pose_of

Change = dict[str, Any]

ADD, REMOVE, APPEND, MOVE = 0, 1, 2, 3
"""Operations of moveit_msgs/CollisionObject."""

CYLINDER = 3
"""The type of shape_msgs/SolidPrimitive, whose dimensions are the height and the radius."""

MOST_SHAPES = 100
"""Shapes of one object: a message is of another program, and each costs time in every check."""


def changes_of_scene(cell: Cell, scene: Any) -> list[Change]:
    """The changes that a PlanningScene message makes.

    Raises:
        StepFailed: A part of it cannot be taken.
    """
    if scene.world.octomap.octomap.data.size:
        raise StepFailed("FAILURE", "an octomap is not taken; send boxes, cylinders or spheres")
    if scene.link_padding or scene.link_scale:
        raise StepFailed("FAILURE", "padding and scale of links are the scenario's `planning`")
    changes: list[Change] = []
    for each in scene.world.collision_objects:
        changes += changes_of(cell, each)
    for each in scene.robot_state.attached_collision_objects:
        changes += changes_of_attached(cell, each)
    if len(scene.allowed_collision_matrix.entry_names):
        changes.append({"change": "allow", "pairs": _allowed(scene.allowed_collision_matrix)})
    return changes


def changes_of(cell: Cell, obj: Any) -> Iterator[Change]:
    """The changes that a CollisionObject makes.

    Raises:
        StepFailed: It has meshes, planes or bad numbers, or its frame does not exist.
    """
    name, operation = str(obj.id), _number(obj.operation)
    if operation == REMOVE:
        yield {"change": "remove", "name": name}
        return
    if not name:
        raise StepFailed("INVALID_OBJECT_NAME", "an object needs an `id`")
    pose = frame_of(cell, str(obj.header.frame_id)) @ pose_of(obj.pose)
    place = [float(value) for value in pose.as_vector()]
    if operation == MOVE:
        yield {"change": "move", "name": name, "pose": place}
    elif operation in (ADD, APPEND):
        kind = "add" if operation == ADD else "append"
        yield {"change": kind, "name": name, "pose": place, "shapes": _shapes(obj)}
    else:
        raise StepFailed("INVALID_OBJECT_NAME", f"'{name}': there is no operation {operation}")


def changes_of_attached(cell: Cell, attached: Any) -> Iterator[Change]:
    """The changes that an AttachedCollisionObject makes.

    Raises:
        StepFailed: As for its object.
    """
    obj, link = attached.object, str(attached.link_name)
    if _number(obj.operation) == REMOVE:
        yield {"change": "detach", "name": str(obj.id), "link": link}
        return
    if obj.primitives or obj.meshes or obj.planes:
        yield from changes_of(cell, obj)
    touch = [str(each) for each in attached.touch_links]
    yield {"change": "attach", "name": str(obj.id), "link": link, "touch_links": touch}


def _shapes(obj: Any) -> list[Change]:
    if obj.meshes or obj.planes:
        reason = f"'{obj.id}': meshes and planes are not taken; send boxes, cylinders or spheres"
        raise StepFailed("FAILURE", reason)
    if not 0 < len(obj.primitives) <= MOST_SHAPES:
        reason = f"'{obj.id}' has {len(obj.primitives)} primitives; 1 to {MOST_SHAPES} are taken"
        raise StepFailed("INVALID_OBJECT_NAME", reason)
    poses = obj.primitive_poses
    if len(poses) not in (0, len(obj.primitives)):
        reason = f"'{obj.id}' has {len(obj.primitives)} primitives and {len(poses)} poses"
        raise StepFailed("INVALID_OBJECT_NAME", reason)
    shapes = [_shape(str(obj.id), each) for each in obj.primitives]
    for shape, pose in zip(shapes, poses, strict=False):
        shape["pose"] = [float(value) for value in pose_of(pose).as_vector()]
    return shapes


def _shape(name: str, primitive: Any) -> Change:
    sizes = [float(each) for each in primitive.dimensions]
    counts = {BOX: ("box", 3), SPHERE: ("sphere", 1), CYLINDER: ("cylinder", 2)}
    kind, count = counts.get(primitive.type, ("", 0))
    if len(sizes) != count or not kind or not np.isfinite(sizes).all() or min(sizes) <= 0:
        reason = f"'{name}' has a primitive of type {primitive.type} with dimensions {sizes[:4]}"
        raise StepFailed("INVALID_OBJECT_NAME", f"{reason}; boxes, spheres, cylinders are taken")
    return {"kind": kind, "size": sizes}


def _allowed(matrix: Any) -> list[list[str]]:
    """The pairs that an AllowedCollisionMatrix allows."""
    names = [str(each) for each in matrix.entry_names]
    rows = [list(each.enabled) for each in matrix.entry_values]
    if len(rows) != len(names) or any(len(row) != len(names) for row in rows):
        raise StepFailed("FAILURE", "the allowed collision matrix is not square")
    pairs = (
        [first, second]
        for i, first in enumerate(names)
        for j, second in enumerate(names[:i])
        if rows[i][j]
    )
    return [*pairs]


def _number(operation: Any) -> int:
    """The value of a `byte`, which some libraries give as one character."""
    return operation[0] if isinstance(operation, bytes) else int(operation)
