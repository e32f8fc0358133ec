"""Imports MoveIt's `.scene` files, in the format of MoveIt 1.1 and in the one before it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from harness.core.errors import Problem, SpecError
from harness.core.geometry import Rgba
from harness.core.limits import SCENE_CORNERS, SCENE_FILE, SCENE_SHAPES
from harness.core.spatial import SE3, wxyz_from_xyzw
from harness.core.world import MOST_OBJECTS
from harness.language.files.source import Place, Source
from harness.language.files.yaml_file import read_text
from harness.language.world import MeshSpec, ObjectSpec, ShapeSpec, WorldSpec
from harness.plugins.formats.moveit_scene.tokens import TokenReader
from harness.plugins.formats.notes import Notes
from harness.plugins.formats.plain_values import (
    LEAST_NORMAL,
    THICK_PLANE,
    first_mistake,
    plane_pose,
    pose_spec,
)
from harness.plugins.formats.stl import Triangles, add_mesh, cone
from harness.world.imported import ImportedWorld

SHAPES = ("box", "sphere", "cylinder", "mesh", "plane")


@dataclass(frozen=True, eq=False)
class Scene:
    """A MoveIt scene.

    Attributes:
        imported: The world; its mesh files are those of `meshes`, which are not written yet.
        meshes: Triangles by file name.
    """

    imported: ImportedWorld
    meshes: dict[str, Triangles]


def load_scene(path: Path) -> Scene:
    """The scene of a file: static objects for planner and physics.

    Raises:
        SpecError: The file violates the format; located.
    """
    return _Reader(path).scene()


class _Reader:
    def __init__(self, path: Path) -> None:
        text = read_text(path, kind="MoveIt scene", largest=SCENE_FILE)
        self._path = path
        self._words = TokenReader(text, Source.of_text(str(path), text))
        self._notes = Notes()
        self._meshes: dict[str, Triangles] = {}

    def scene(self) -> Scene:
        title = self._words.rest_of_line()[:100] or self._path.stem[:100]
        has_poses = self._is_of_the_new_form()
        objects: dict[str, ObjectSpec] = {}
        while True:
            word, place = self._words.next()
            if word == ".":
                break
            if word != "*":
                found = f"`{word[:40]}`" if word else "the end of the file"
                hint = "an object begins with `*`, and `.` ends the scene"
                raise SpecError([place.problem(f"expected an object, found {found}", hint)])
            name = self._words.rest_of_line()
            if not name or len(name) > 100 or not name.isprintable():
                message = "an object has a name of 1 to 100 printable characters"
                raise SpecError([place.problem(message)])
            if name in objects:
                raise SpecError([place.problem(f"another object has the name '{name}'")])
            if len(objects) >= MOST_OBJECTS:
                raise SpecError([place.problem(f"more than {MOST_OBJECTS} objects")])
            try:
                found_object = self._object(name, place, has_poses)
            except SpecError as error:
                raise SpecError([self._in_object(error.problems[0], name, place)]) from error
            except ValidationError as error:
                raise SpecError([place.problem(f"'{name}': {first_mistake(error)}")]) from error
            if found_object is not None:
                objects[name] = found_object
        world = WorldSpec(world=title, objects=tuple(objects.values()))
        return Scene(ImportedWorld(world, self._path, self._notes.all()), self._meshes)

    def _in_object(self, problem: Problem, name: str, begin: Place) -> Problem:
        """The mistake; at the object's first line where the file ends inside the object."""
        if not self._words.is_at_end:
            return problem
        message = f"the file ends inside the object '{name}': {problem.message}"
        return begin.problem(message, "a number is missing in it, or a count is too large")

    def _is_of_the_new_form(self) -> bool:
        """Whether objects have poses: then three numbers follow the first name, otherwise one."""
        lines = self._words.lines_ahead()
        first = next((n for n, line in enumerate(lines) if line.startswith("*")), None)
        after = "" if first is None or first + 1 >= len(lines) else lines[first + 1]
        return " " in after.strip()

    def _object(self, name: str, place: Place, has_pose: bool) -> ObjectSpec | None:
        pose = self._pose() if has_pose else SE3.identity()
        shapes = [self._shape(name) for _ in range(self._count("shapes", SCENE_SHAPES))]
        if has_pose:
            for _ in range(self._count("subframes", SCENE_SHAPES)):
                _, at = self._words.next()
                self._pose()
                self._notes.add(at, "a subframe of an object is left out")
        if not shapes:
            self._notes.add(place, "an object without shapes is left out")
            return None
        words: dict[str, Any] = {"name": name, "static": True, "pose": pose_spec(pose)}
        colors = {shape.color for shape in shapes}
        if len(colors) == 1:
            (words["color"],) = colors
            shapes = [shape.model_copy(update={"color": None}) for shape in shapes]
        only = shapes[0]
        if len(shapes) == 1 and (not has_pose or only.pose == pose_spec(SE3.identity())):
            kinds = {kind: getattr(only, kind) for kind in SHAPES}
            words["pose"] = words["pose"] if has_pose else only.pose
            return ObjectSpec(**words, **kinds)
        return ObjectSpec(**words, shapes=tuple(shapes))

    def _shape(self, name: str) -> ShapeSpec:
        """A shape, its pose on the object, and its colour."""
        kind, place = self._words.next()
        words: dict[str, Any] = {}
        turn = SE3.identity()
        match kind:
            case "box":
                words["box"] = {"size": self._sizes(3, place)}
            case "sphere":
                words["sphere"] = {"radius": self._sizes(1, place)[0]}
            case "cylinder":
                radius, length = self._sizes(2, place)
                words["cylinder"] = {"radius": radius, "length": length}
            case "cone":
                words["mesh"] = self._written(name, cone(*self._sizes(2, place)))
            case "plane":
                words["plane"] = {}
                turn = self._plane(place)
            case "mesh":
                words["mesh"] = self._mesh(name)
            case _:
                hint = f"shapes: {', '.join((*SHAPES, 'cone'))}"
                raise SpecError([place.problem(f"a shape cannot be a `{kind[:40]}`", hint)])
        pose = self._pose() @ turn
        return ShapeSpec(pose=pose_spec(pose), color=self._color(), **words)

    def _plane(self, place: Place) -> SE3:
        """The frame of a x + b y + c z + d = 0, z along its normal."""
        coefficients = self._numbers(4)
        if math.hypot(*coefficients[:3]) < LEAST_NORMAL:
            raise SpecError([place.problem("a plane's normal must not be 0 0 0")])
        self._notes.add(place, THICK_PLANE)
        return plane_pose(coefficients)

    def _mesh(self, name: str) -> MeshSpec:
        vertices = self._count("vertices", SCENE_CORNERS)
        triangles = self._count("triangles", SCENE_CORNERS)
        corners = np.array([self._numbers(3) for _ in range(vertices)]).reshape(-1, 3)
        faces: list[list[int]] = []
        for _ in range(triangles):
            faces.append([self._count("vertices", vertices - 1) for _ in range(3)])
        return self._written(name, corners[np.array(faces, dtype=np.int64).reshape(-1, 3)])

    def _written(self, name: str, triangles: Triangles) -> MeshSpec:
        """A mesh file of triangles, named after the object."""
        return MeshSpec(file=add_mesh(self._meshes, name, triangles))

    def _color(self) -> Rgba | None:
        """A colour; None for four zeros."""
        red, green, blue, alpha = (min(1.0, max(0.0, value)) for value in self._numbers(4))
        return None if not any((red, green, blue, alpha)) else (red, green, blue, alpha)

    def _pose(self) -> SE3:
        xyz, quat_xyzw = self._numbers(3), self._numbers(4)
        if math.hypot(*quat_xyzw) < 1e-6:
            raise SpecError(
                [self._words.last.problem("a quaternion has norm 1, this one has norm 0")]
            )
        return SE3.from_xyz_quat(xyz, wxyz_from_xyzw(quat_xyzw))

    def _sizes(self, count: int, place: Place) -> list[float]:
        values = self._numbers(count)
        if min(values) <= 0:
            raise SpecError([place.problem("a shape has sizes above 0")])
        return values

    def _numbers(self, count: int) -> list[float]:
        return [self._words.number() for _ in range(count)]

    def _count(self, what: str, most: int) -> int:
        return self._words.count(what, most)
