"""The objects and allowed collisions that clients put into the planning scene."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from harness.cell.cell import Cell
from harness.core.errors import StepFailed
from harness.core.geometry import (
    Box,
    Capsule,
    Cylinder,
    Geometry,
    Mesh,
    Plane,
    Shape,
    Sphere,
)
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.plugins.ros.bag.messages import message, pose_message
from harness.plugins.ros.interfaces import header
from harness.plugins.ros.moveit.client_meshes import client_mesh, cone_mesh
from harness.plugins.ros.moveit.goals import BOX, SPHERE
from harness.plugins.ros.moveit.scene_changes import CYLINDER, Change
from harness.plugins.ros.moveit.values import link_of, state_message
from harness.robot.mesh_file import read_triangles

GEOMETRIES: Mapping[str, Callable[[Change], Geometry]] = {
    "box": lambda shape: Box((shape["size"][0], shape["size"][1], shape["size"][2])),
    "sphere": lambda shape: Sphere(shape["size"][0]),
    "cylinder": lambda shape: Cylinder(radius=shape["size"][1], length=shape["size"][0]),
    "cone": lambda shape: cone_mesh(shape["size"][0], shape["size"][1]),
    "plane": lambda _: Plane(),
    "mesh": lambda shape: client_mesh(np.array(shape["corners"]), np.array(shape["triangles"])),
}
"""The geometry of each kind of shape in a change."""


class ClientScene:
    """Changes the planning scene as MoveIt does.

    An object that a client adds is in the planning scene alone. One of the scenario is where the
    physics has it: it can be attached, detached and taken out of the planning scene, not moved.
    """

    def __init__(self, cell: Cell) -> None:
        self.cell = cell
        self._allowed: set[tuple[str, str]] = set()
        self._rules: Change = {"pairs": []}  # of the last allowed collision matrix

    def apply(self, changes: Sequence[Change]) -> None:
        """Apply changes in order; those before a mistake stay.

        Raises:
            StepFailed: INVALID_OBJECT_NAME, INVALID_LINK_NAME ...
        """
        self.cell.sync_scene()
        for change in changes:
            getattr(self, f"_{change['change']}")(change)
            if change["change"] in ("add", "append"):  # an object that the matrix may name
                self._allow(self._rules)

    def _add(self, change: Change) -> None:
        name, cell = change["name"], self.cell
        if name in cell.description.link_names:
            raise StepFailed("INVALID_OBJECT_NAME", f"'{name}' is the name of a link")
        if self._is_physical(name):
            if name not in cell.scene.object_names():
                cell.scene.add_object(cell.presence[name].obj, cell.measured_pose(name))
            return
        shapes, known = _shapes(change), cell.presence.get(name)
        if known is not None and known.is_there:
            if name in cell.scene.attached():
                cell.detach(name)
            cell.remove_from_scene(name)
        self._put(name, shapes, _pose(change))

    def _put(self, name: str, shapes: Sequence[Shape], pose: SE3) -> None:
        """Let an object of a client appear."""
        cell, known = self.cell, self.cell.presence.get(name)
        obj = WorldObject(
            name, tuple(shapes), pose, is_static=False, mass=0.0, center_of_mass=np.zeros(3),
            inertia=np.zeros((3, 3)), in_simulation=False,
        )  # fmt: skip
        if known is not None:
            known.obj = obj
        cell.add_to_scene(obj, pose)

    def _append(self, change: Change) -> None:
        presence = self.cell.presence.get(change["name"])
        if presence is None or not presence.is_there or presence.obj.in_simulation:
            self._add(change)
            return
        pose, old = presence.pose, presence.obj.shapes
        back = pose.inverse() @ _pose(change)
        added = [replace(each, pose=back @ each.pose) for each in _shapes(change)]
        self._remove(change)
        self._put(change["name"], [*old, *added], pose)

    def _move(self, change: Change) -> None:
        if not self._is_physical(change["name"]):
            self.cell.move_in_scene(change["name"], _pose(change))

    def _remove(self, change: Change) -> None:
        scene = self.cell.scene
        for name in [change["name"]] if change["name"] else self._of_clients():
            if name in scene.attached():
                raise StepFailed("INVALID_OBJECT_NAME", f"'{name}' is attached: detach it first")
            if name not in scene.object_names():
                raise StepFailed("INVALID_OBJECT_NAME", f"'{name}' is not in the planning scene")
            if self._is_physical(name):
                scene.remove_object(name)
            else:
                self.cell.remove_from_scene(name)

    def _attach(self, change: Change) -> None:
        cell, robot = self.cell, self.cell.description
        link = link_of(cell, change["link"])
        hand = robot.of_arm.get(robot.arm_of_link.get(link, ""), robot).gripper
        touch = change["touch_links"] or (hand.links if hand else ())
        for each in touch:
            link_of(cell, each)
        if cell.scene.attached().get(change["name"]) == link:
            return
        cell.attach(change["name"], link, touch)

    def _detach(self, change: Change) -> None:
        attached = self.cell.scene.attached()
        every = [name for name, link in attached.items() if change["link"] in ("", link)]
        for name in [change["name"]] if change["name"] else every:
            self.cell.detach(name)

    def _allow(self, change: Change) -> None:
        scene, self._rules = self.cell.scene, change
        known = {*self.cell.description.link_names, *scene.object_names()}
        pairs = {(min(pair), max(pair)) for pair in change["pairs"] if known.issuperset(pair)}
        pairs |= {*_by_default(change.get("defaults", {}), known)} - {
            (min(pair), max(pair)) for pair in change.get("forbidden", ())
        }
        pairs -= {*self.cell.description.allowed_collisions}
        scene.set_allowed(sorted(self._allowed - pairs), allowed=False)
        scene.set_allowed(sorted(pairs - self._allowed), allowed=True)
        self._allowed = pairs

    def _is_physical(self, name: str) -> bool:
        presence = self.cell.presence.get(name)
        return presence is not None and presence.is_there and presence.obj.in_simulation

    def _of_clients(self) -> list[str]:
        scene = self.cell.scene
        free = [name for name in scene.object_names() if name not in scene.attached()]
        return [name for name in free if not self._is_physical(name)]

    def as_message(self) -> Any:
        """The planning scene as a PlanningScene message."""
        cell, scene = self.cell, self.cell.scene
        cell.sync_scene()
        start, attached = cell.planning_start(), scene.attached()
        bodies = [
            message(
                "moveit_msgs/msg/AttachedCollisionObject",
                link_name=link,
                object=self._object(name, scene.object_pose(name, start)),
            )
            for name, link in attached.items()
        ]
        objects = [
            self._object(name, scene.object_pose(name, start))
            for name in scene.object_names()
            if name not in attached
        ]
        return message(
            "moveit_msgs/msg/PlanningScene",
            name="(noname)",
            robot_model_name=cell.description.name,
            robot_state=state_message(cell, start, attached_collision_objects=bodies),
            allowed_collision_matrix=self._matrix(),
            world=message("moveit_msgs/msg/PlanningSceneWorld", collision_objects=objects),
        )

    def _object(self, name: str, pose: SE3) -> Any:
        """A CollisionObject."""
        shapes = self.cell.presence[name].obj.shapes
        fields: dict[str, list[Any]] = {}
        for shape in shapes:
            key, content = _shape_message(shape.geometry)
            fields.setdefault("meshes" if key == "mesh" else f"{key}s", []).append(content)
            at = pose_message(list(shape.pose.as_vector()))
            fields.setdefault(f"{key}_poses", []).append(at)
        return message(
            "moveit_msgs/msg/CollisionObject",
            header=header(self.cell.simulator.time, "world"),
            id=name,
            pose=pose_message(list(pose.as_vector())),
            **fields,
        )

    def _matrix(self) -> Any:
        names = [*self.cell.description.link_names, *self.cell.scene.object_names()]
        allowed = {*self.cell.description.allowed_collisions, *self._allowed}
        pairs = {pair for each in allowed for pair in (each, each[::-1])}
        rows = [
            message(
                "moveit_msgs/msg/AllowedCollisionEntry",
                enabled=np.array([(first, second) in pairs for second in names]),
            )
            for first in names
        ]
        kind = "moveit_msgs/msg/AllowedCollisionMatrix"
        return message(kind, entry_names=names, entry_values=rows)


def _by_default(defaults: Mapping[str, bool], names: set[str]) -> Iterator[tuple[str, str]]:
    """The pairs that may touch by the defaults of their names, both where both have one."""
    for name, is_allowed in defaults.items():
        for other in names if is_allowed and name in names else ():
            if other != name and defaults.get(other, True):
                yield min(name, other), max(name, other)


def _pose(values: Change) -> SE3:
    return SE3.from_vector(values["pose"]) if "pose" in values else SE3.identity()


def _shapes(change: Change) -> list[Shape]:
    return [Shape(GEOMETRIES[each["kind"]](each), _pose(each)) for each in change["shapes"]]


def _shape_message(geometry: Geometry) -> tuple[str, Any]:
    """A shape of shape_msgs, and whether it is a `primitive`, a `mesh` or a `plane`."""
    if isinstance(geometry, Capsule):  # MoveIt has none; the cylinder around it
        geometry = Cylinder(geometry.radius, geometry.length + 2 * geometry.radius)
    match geometry:
        case Box(size):
            kind, sizes = BOX, [*size]
        case Sphere(radius):
            kind, sizes = SPHERE, [radius]
        case Cylinder(radius, length):
            kind, sizes = CYLINDER, [length, radius]
        case Plane():
            return "plane", message("shape_msgs/msg/Plane", coef=np.array([0.0, 0.0, 1.0, 0.0]))
        case Mesh():
            return "mesh", _mesh_message(geometry)
    primitive = "shape_msgs/msg/SolidPrimitive"
    return "primitive", message(primitive, type=kind, dimensions=np.array(sizes, dtype=float))


@lru_cache(maxsize=64)
def _mesh_message(mesh: Mesh) -> Any:
    """The triangles of a file."""
    read = read_triangles(mesh)
    points = [
        message("geometry_msgs/msg/Point", x=float(x), y=float(y), z=float(z))
        for x, y, z in read.vertices
    ]
    faces = [
        message("shape_msgs/msg/MeshTriangle", vertex_indices=face.astype(np.uint32))
        for face in read.faces
    ]
    return message("shape_msgs/msg/Mesh", triangles=faces, vertices=points)
