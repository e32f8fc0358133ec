"""A PlanningScene as a world, a start state and pairs that may touch."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.spatial import SE3
from harness.language.files.source import Located
from harness.language.world import ObjectSpec, ShapeSpec, WorldSpec
from harness.plugins.formats.moveit_messages.values import (
    child,
    children,
    joint_positions,
    message_pose,
    numbers,
    refused_at,
    text,
)
from harness.plugins.formats.notes import Notes
from harness.plugins.formats.plain_values import LEAST_NORMAL, THICK_PLANE, plane_pose, pose_spec
from harness.plugins.formats.stl import Triangles, add_mesh, cone
from harness.plugins.formats.yaml_data import number, read_data, refuse
from harness.robot.packages import NotFoundError, PackagePath
from harness.robot.srdf.srdf import link_pair
from harness.world.imported import Note

KEYS = ("world", "robot_model_name")
PRIMITIVES = {"1": "box", "2": "sphere", "3": "cylinder", "4": "cone"}
"""Numbers of SolidPrimitive's types."""

SIZES = {"box": 3, "sphere": 1, "cylinder": 2, "cone": 2}
IGNORED = ("object_colors", "link_padding", "link_scale", "fixed_frame_transforms")


@dataclass(frozen=True, eq=False)
class MoveItScene:
    """A PlanningScene.

    Attributes:
        world: Its objects; mesh files of `meshes` are not written yet.
        meshes: Triangles by file name.
        start: Joint positions of its robot, by name, with their places.
        allowed: Pairs of links and objects that may touch.
    """

    robot: str
    world: WorldSpec
    meshes: dict[str, Triangles]
    start: dict[str, tuple[float, Located]]
    allowed: frozenset[tuple[str, str]]
    notes: tuple[Note, ...]


def read_scene(path: Path, root_frames: Collection[str], packages: PackagePath) -> MoveItScene:
    """The scene of a file.

    Args:
        path: A PlanningScene as YAML, with names or lists for vectors.
        root_frames: Frames that are the world's: the robot's root, besides `world` and none.
        packages: Search path for meshes.

    Raises:
        SpecError: It violates the message's format, or has an object in another frame; located.
    """
    root = read_data(path, KEYS, "PlanningScene")
    reader = _Reader({"", "world", *root_frames}, packages, path.parent)
    objects = [reader.object(item) for item in children(root, "world", "collision_objects")]
    for key in IGNORED:
        for item in children(root, key)[:1]:
            reader.notes.add(item.place, f"`{key}` is left out")
    octomap = child(root, "world", "octomap", "octomap", "data")
    if octomap is not None and octomap.items():
        reader.notes.add(octomap.place, "an octomap is left out")
    for item in children(root, "robot_state", "attached_collision_objects"):
        refuse(item, "an attached object has no place in a world", "put it there and `attach` it")
    state = child(root, "robot_state")
    with refused_at(root):
        world = WorldSpec(world=text(root, "name") or path.stem, objects=tuple(objects))
    return MoveItScene(
        robot=text(root, "robot_model_name"),
        world=world,
        meshes=reader.meshes,
        start={} if state is None else joint_positions(state),
        allowed=_allowed(root),
        notes=reader.notes.all(),
    )


def _allowed(root: Located) -> frozenset[tuple[str, str]]:
    """Pairs of an allowed collision matrix: rows are lists, or mappings with `enabled`."""
    names = [str(item.value) for item in children(root, "allowed_collision_matrix", "entry_names")]
    pairs: set[tuple[str, str]] = set()
    rows = children(root, "allowed_collision_matrix", "entry_values")
    for first, row in zip(names, rows, strict=False):
        values = (child(row, "enabled") or row).items()
        if len(values) != len(names):
            refuse(row, f"expected {len(names)} entries, one for each of `entry_names`")
        pairs |= {
            link_pair(first, second)
            for second, item in zip(names, values, strict=True)
            if item.value is True and second != first
        }
    return frozenset(pairs)


class _Reader:
    def __init__(self, frames: Collection[str], packages: PackagePath, folder: Path) -> None:
        self._frames = frames
        self._packages = packages
        self._folder = folder
        self.notes = Notes()
        self.meshes: dict[str, Triangles] = {}
        self._kinds = (("primitive", self._primitive), ("mesh", self._mesh), ("plane", self._plane))

    def object(self, item: Located) -> ObjectSpec:
        """A collision object; it stands still."""
        name = text(item, "id")
        if not name:
            refuse(item, "a collision object has an `id`")
        header = child(item, "header")
        frame = "" if header is None else text(header, "frame_id").removeprefix("/")
        if frame not in self._frames:
            refuse(
                item,
                f"'{name}' is in the frame '{frame}', which is not the robot's root",
                f"known are {', '.join(sorted(filter(None, self._frames)))}",
            )
        at = message_pose(child(item, "pose"))
        shapes: list[ShapeSpec] = []
        for kind, read in self._kinds:
            found, poses = children(item, _plural(kind)), children(item, f"{kind}_poses")
            if len(poses) > len(found):
                refuse(item, f"'{name}' has {len(found)} {_plural(kind)} and {len(poses)} poses")
            for shape, pose in zip_longest(found, poses):  # a missing pose is the identity
                words = read(shape, name)
                T_world_shape = at @ message_pose(pose) @ words.pop("at", SE3.identity())
                with refused_at(shape):
                    shapes.append(ShapeSpec(pose=pose_spec(T_world_shape), **words))
        if not shapes:
            refuse(item, f"'{name}' has no shape")
        with refused_at(item):
            return ObjectSpec(name=name, static=True, shapes=tuple(shapes))

    def _primitive(self, item: Located, name: str) -> dict[str, Any]:
        word = text(item, "type").lower()
        kind = PRIMITIVES.get(word, word)
        sizes = [number(value) for value in children(item, "dimensions")]
        if kind not in SIZES or len(sizes) != SIZES[kind]:
            known = ", ".join(f"{kind} of {count}" for kind, count in SIZES.items())
            refuse(item, f"'{name}': a '{kind}' of {len(sizes)} sizes; known are {known}")
        if kind == "box":
            return {"box": {"size": sizes}}
        if kind == "sphere":
            return {"sphere": {"radius": sizes[0]}}
        if kind == "cone":
            return {"mesh": {"file": add_mesh(self.meshes, name, cone(sizes[1], sizes[0]))}}
        return {"cylinder": {"length": sizes[0], "radius": sizes[1]}}

    def _plane(self, item: Located, name: str) -> dict[str, Any]:
        coefficients = [number(value) for value in children(item, "coef")]
        if len(coefficients) != 4 or math.hypot(*coefficients[:3]) < LEAST_NORMAL:
            refuse(item, f"'{name}': a plane has a `coef` of 4 numbers, the normal not 0 0 0")
        self.notes.add(item.place, THICK_PLANE)
        return {"plane": {}, "at": plane_pose(coefficients)}

    def _mesh(self, item: Located, name: str) -> dict[str, Any]:
        resource = text(item, "resource")
        if resource:
            try:
                path = self._packages.file(resource, self._folder)
            except NotFoundError as error:
                refuse(item, f"'{name}': mesh {error}")
            scale = [number(value) for value in children(item, "dimensions")] or [1.0, 1.0, 1.0]
            return {"mesh": {"file": str(path), "scale": scale}}
        corners = [numbers(each, "xyz") for each in children(item, "vertices")]
        faces = [
            [int(number(value)) for value in (child(each, "vertex_indices") or each).items()]
            for each in children(item, "triangles")
        ]
        used = {corner for face in faces for corner in face}
        is_triangles = bool(faces) and all(len(face) == 3 for face in faces)
        if not is_triangles or not used <= set(range(len(corners))):
            refuse(item, f"'{name}': a mesh has triangles of its vertices, or a `resource`")
        triangles = np.array(corners, dtype=float)[np.array(faces)]
        return {"mesh": {"file": add_mesh(self.meshes, name, triangles)}}


def _plural(kind: str) -> str:
    return "meshes" if kind == "mesh" else f"{kind}s"
