"""What messages change of the planning scene, as plain values that a run records and repeats."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from harness.cell.cell import Cell
from harness.core.errors import StepFailed
from harness.core.spatial import SE3
from harness.plugins.ros.moveit.goals import BOX, SPHERE
from harness.plugins.ros.moveit.values import frame_of, pose_of

Change = dict[str, Any]

UNMOVED = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
"""The pose of a shape that is where its object is: x, y, z, and a quaternion w, x, y, z."""

ADD, REMOVE, APPEND, MOVE = 0, 1, 2, 3
"""Operations of moveit_msgs/CollisionObject."""

CYLINDER, CONE = 3, 4
"""Types of shape_msgs/SolidPrimitive, whose dimensions are the height and the radius."""

MOST_SHAPES, MOST_TRIANGLES = 100, 50_000
"""Shapes of one object and triangles of one mesh: a message is of another program, each shape costs
time in every check, and the triangles are recorded with the run (1 MB for 20,000)."""


def changes_of_scene(cell: Cell, scene: Any) -> list[Change]:
    """The changes that a PlanningScene message makes.

    Raises:
        StepFailed: A part of it cannot be taken.
    """
    if scene.link_padding or scene.link_scale:
        raise StepFailed("FAILURE", "padding and scale of links are the scenario's `planning`")
    changes = [] if scene.is_diff or is_empty(scene) else [*_replaced(cell, scene)]
    changes += changes_of_world(cell, scene.world)
    for each in scene.robot_state.attached_collision_objects:
        changes += changes_of_attached(cell, each)
    matrix = scene.allowed_collision_matrix
    if len(matrix.entry_names) or len(matrix.default_entry_names):
        changes.append({"change": "allow", **_allowed(matrix)})
    return changes


def changes_of_world(cell: Cell, world: Any) -> Iterator[Change]:
    """The changes that a PlanningSceneWorld message makes.

    Raises:
        StepFailed: A part of it cannot be taken.
    """
    if world.octomap.octomap.data.size:
        raise StepFailed("FAILURE", "an octomap is not taken; send shapes or meshes")
    for each in world.collision_objects:
        yield from changes_of(cell, each)


def changes_of(cell: Cell, obj: Any) -> Iterator[Change]:
    """The changes that a CollisionObject makes.

    Raises:
        StepFailed: It has no shapes, or bad numbers, or its frame does not exist.
    """
    name, operation = str(obj.id), _number(obj.operation)
    if operation == REMOVE:
        yield {"change": "remove", "name": name}
        return
    if not name:
        raise StepFailed("INVALID_OBJECT_NAME", "an object needs an `id`")
    place = _values(frame_of(cell, str(obj.header.frame_id)) @ pose_of(obj.pose))
    known = cell.presence.get(name)
    if operation == MOVE:
        yield {"change": "move", "name": name, "pose": place}
    elif operation in (ADD, APPEND):
        kind = "add" if operation == ADD else "append"
        is_physical = known is not None and known.is_there and known.obj.in_simulation
        shapes = [] if is_physical else _shapes(obj)
        yield {"change": kind, "name": name, "pose": place, "shapes": shapes}
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


def is_empty(scene: Any) -> bool:
    """Whether a scene says nothing, as one of an action that is left out."""
    parts = scene.world.collision_objects, scene.robot_state.attached_collision_objects
    matrix = scene.allowed_collision_matrix
    names = matrix.entry_names, matrix.default_entry_names
    return not (any(parts) or scene.name or any(names))


def _replaced(cell: Cell, scene: Any) -> Iterator[Change]:
    """Take out what is not in a whole scene, which is one that is no diff."""
    attached = {str(each.object.id) for each in scene.robot_state.attached_collision_objects}
    known = {str(each.id) for each in scene.world.collision_objects} | attached
    for name, link in cell.scene.attached().items():
        if name not in attached:
            yield {"change": "detach", "name": name, "link": link}
    for name in cell.scene.object_names():
        if name not in known:
            yield {"change": "remove", "name": name}


def _values(pose: SE3) -> list[float]:
    return [float(value) for value in pose.as_vector()]


def _shapes(obj: Any) -> list[Change]:
    """The primitives, meshes and planes of an object, each with its pose in the object."""
    shapes: list[Change] = []
    for key, read in (("primitive", _shape), ("mesh", _mesh), ("plane", _plane)):
        given = getattr(obj, f"{key}es" if key == "mesh" else f"{key}s")
        poses = getattr(obj, f"{key}_poses")
        if len(poses) not in (0, len(given)):
            reason = f"'{obj.id}' has {len(given)} shapes of the kind {key}, and {len(poses)} poses"
            raise StepFailed("INVALID_OBJECT_NAME", reason)
        for place, each in enumerate(given):
            shape = read(str(obj.id), each)
            at = pose_of(poses[place]) if len(poses) else SE3.identity()
            shape["pose"] = _values(at @ SE3.from_vector(shape["pose"]))
            shapes.append(shape)
    if not 0 < len(shapes) <= MOST_SHAPES:
        reason = f"'{obj.id}' has {len(shapes)} shapes; 1 to {MOST_SHAPES} are taken"
        raise StepFailed("INVALID_OBJECT_NAME", reason)
    return shapes


def _mesh(name: str, mesh: Any) -> Change:
    corners = [[float(each.x), float(each.y), float(each.z)] for each in mesh.vertices]
    triangles = [[int(index) for index in each.vertex_indices] for each in mesh.triangles]
    if not (corners and 0 < len(triangles) <= MOST_TRIANGLES):
        reason = f"'{name}' has a mesh of {len(corners)} corners and {len(triangles)} triangles"
        raise StepFailed("INVALID_OBJECT_NAME", f"{reason}; 1 to {MOST_TRIANGLES} are taken")
    if not np.isfinite(corners).all() or np.max(triangles) >= len(corners):
        reason = f"'{name}' has a mesh with bad numbers, or with corners that it lacks"
        raise StepFailed("INVALID_OBJECT_NAME", reason)
    return {"kind": "mesh", "corners": corners, "triangles": triangles, "pose": UNMOVED}


def _plane(name: str, plane: Any) -> Change:
    """A plane a x + b y + c z + d = 0: the half space on the side from which (a, b, c) points."""
    coefficients = np.array(plane.coef, dtype=float)
    length = np.linalg.norm(coefficients[:3])
    if not np.isfinite(coefficients).all() or not length:
        raise StepFailed("INVALID_OBJECT_NAME", f"'{name}' has a plane without a direction")
    normal, offset = coefficients[:3] / length, coefficients[3] / length
    turn = Rotation.align_vectors([normal], [[0.0, 0.0, 1.0]])[0]
    pose = SE3(turn.as_matrix(), -offset * normal)
    return {"kind": "plane", "size": [], "pose": _values(pose)}


def _shape(name: str, primitive: Any) -> Change:
    sizes = [float(each) for each in primitive.dimensions]
    counts = {
        BOX: ("box", 3), SPHERE: ("sphere", 1), CYLINDER: ("cylinder", 2), CONE: ("cone", 2),
    }  # fmt: skip
    kind, count = counts.get(primitive.type, ("", 0))
    if len(sizes) != count or not kind or not np.isfinite(sizes).all() or min(sizes) <= 0:
        reason = f"'{name}' has a primitive of type {primitive.type} with dimensions {sizes[:4]}"
        taken = "boxes, spheres, cylinders and cones are taken"
        raise StepFailed("INVALID_OBJECT_NAME", f"{reason}; {taken}")
    return {"kind": kind, "size": sizes, "pose": UNMOVED}


def _allowed(matrix: Any) -> Change:
    """The pairs that an AllowedCollisionMatrix allows and forbids, and what it allows by default.

    As in MoveIt, the entry of a pair counts; without one the defaults of its two names do.
    """
    names = [str(each) for each in matrix.entry_names]
    rows = [list(each.enabled) for each in matrix.entry_values]
    defaults = [str(each) for each in matrix.default_entry_names], [*matrix.default_entry_values]
    if len(rows) != len(names) or any(len(row) != len(names) for row in rows):
        raise StepFailed("FAILURE", "the allowed collision matrix is not square")
    if len(defaults[0]) != len(defaults[1]):
        raise StepFailed("FAILURE", "the allowed collision matrix has names without a default")
    pairs = {
        is_allowed: [
            [first, second]
            for i, first in enumerate(names)
            for j, second in enumerate(names[:i])
            if bool(rows[i][j]) is is_allowed
        ]
        for is_allowed in (True, False)
    }
    change: Change = {"pairs": pairs[True]}
    if defaults[0]:
        change |= {
            "defaults": {n: bool(value) for n, value in zip(*defaults, strict=True)},
            "forbidden": pairs[False],
        }
    return change


def _number(operation: Any) -> int:
    """The value of a `byte`, which some libraries give as one character."""
    return operation[0] if isinstance(operation, bytes) else int(operation)
