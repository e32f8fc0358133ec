"""The cell as viser draws it: links, objects, ghosts of goals and plans, the handle on the TCP."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import viser

from harness.cameras.meshes import coarsen, mesh_parts
from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Plane, Shape, Sphere
from harness.core.spatial import SE3
from harness.core.types import FloatArray, IntArray
from harness.core.world import WorldObject
from harness.robot.description import RobotDescription
from harness.robot.forward_kinematics import LinkPoses, quats_wxyz

MOST_TRIANGLES = 20_000
"""Triangles of the whole robot; its meshes are coarsened until they are no more."""

GRID = 0.002
"""The first cell size in which vertices are merged [m]."""

GHOST, REFUSED, PLANNED = (70, 130, 220), (214, 60, 50), (40, 160, 90)
PLANE_SIZE = 6.0  # [m]

Color = tuple[int, int, int]
OnDrag = Callable[[int, str, SE3, str], None]
OnChoose = Callable[[int, int], None]
"""Called with the number of the page's connection and that of the way."""


@dataclass(frozen=True, eq=False)
class Triangles:
    """A part of a body in one colour, in the body's frame."""

    vertices: FloatArray
    faces: IntArray
    color: Color
    opacity: float


def triangles_of(shapes: Iterable[Shape], grid: float = GRID) -> list[Triangles]:
    """The triangles of a body's shapes, one part for each colour of each shape."""
    found: list[Triangles] = []
    for shape in shapes:
        for vertices, faces, rgba in _parts(shape, grid):
            red, green, blue, alpha = rgba
            color = (round(255 * red), round(255 * green), round(255 * blue))
            found.append(Triangles(shape.pose.apply(vertices), faces, color, alpha))
    return found


def robot_triangles(description: RobotDescription) -> dict[str, list[Triangles]]:
    """The triangles of every link that has a visual, at most MOST_TRIANGLES of them."""
    grid = GRID
    while True:
        links = {
            link.name: triangles_of(link.visuals or link.collisions, grid)
            for link in description.links
        }
        count = sum(len(part.faces) for parts in links.values() for part in parts)
        if count <= MOST_TRIANGLES or grid > 0.1:
            return {name: parts for name, parts in links.items() if parts}
        grid *= max(1.1, (count / MOST_TRIANGLES) ** 0.5)


def _parts(shape: Shape, grid: float) -> Iterable[tuple[FloatArray, IntArray, Any]]:
    match shape.geometry:
        case Mesh() as mesh:
            for part in mesh_parts(mesh):
                vertices, faces = part.vertices, part.faces
                if grid > GRID:
                    vertices, faces = coarsen(vertices, faces, grid)
                yield vertices, faces, part.rgba or shape.rgba
        case Box(size=size):
            yield *_box(size, 0.0), shape.rgba
        case Plane():
            yield *_box((PLANE_SIZE, PLANE_SIZE, 0.002), -0.001), shape.rgba
        case Cylinder(radius=radius, length=length):
            half = 0.5 * length
            profile = [(0.0, -half), (radius, -half), (radius, half), (0.0, half)]
            yield *_revolved(np.array(profile)), shape.rgba
        case Sphere(radius=radius):
            yield *_revolved(_half_circle(radius, 0.0)), shape.rgba
        case Capsule(radius=radius, length=length):
            yield *_revolved(_half_circle(radius, 0.5 * length)), shape.rgba


def _box(size: tuple[float, float, float], height: float) -> tuple[FloatArray, IntArray]:
    """A box whose centre is at a height on the z axis."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [(a, b, c) for a, b, c, _ in quads] + [(a, c, d) for a, _, c, d in quads]
    return 0.5 * corners * size + [0.0, 0.0, height], np.array(faces)


def _half_circle(radius: float, offset: float) -> FloatArray:
    """Radii and heights from pole to pole; the halves are moved apart along the axis."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, 14)
    heights = radius * np.sin(angles) + np.where(angles < 0, -offset, offset)
    return np.stack([radius * np.cos(angles), heights], axis=1)


def _revolved(profile: FloatArray, sections: int = 24) -> tuple[FloatArray, IntArray]:
    """The surface that a profile of radii and heights, shape (N, 2), draws about the z axis."""
    angles = np.linspace(0.0, 2 * np.pi, sections, endpoint=False)
    turns = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    flat = profile[:, :1, None] * turns[None]
    heights = np.broadcast_to(profile[:, 1:, None], (len(profile), sections, 1))
    vertices = np.concatenate([flat, heights], axis=2).reshape(-1, 3)
    ring, step = np.meshgrid(np.arange(len(profile) - 1), np.arange(sections), indexing="ij")
    after = (step + 1) % sections
    a, b = ring * sections + step, ring * sections + after
    quads = np.stack([a, b, b + sections, a + sections], axis=-1).reshape(-1, 4)
    return vertices, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


@dataclass(frozen=True, eq=False)
class Ghost:
    """The robot a second time, at other joint positions.

    Attributes:
        positions: Joint positions in description order, shape (n,).
        way: The number of the way that a click chooses; -1 where there is nothing to choose.
    """

    positions: FloatArray
    color: Color
    opacity: float = 0.25
    way: int = -1


@dataclass
class _Body:
    """A frame of the scene with the pose that was sent last."""

    handle: Any
    pose: FloatArray = field(default_factory=lambda: np.full(7, np.nan))

    def move(self, pose: FloatArray) -> None:
        if np.abs(pose - self.pose).max() > 1e-6 or np.isnan(self.pose[0]):
            self.pose = pose
            self.handle.position, self.handle.wxyz = tuple(pose[:3]), tuple(pose[3:])


def reach_of(description: RobotDescription) -> float:
    """The length of the arm from its base to its TCP [m]: how far away the camera stands."""
    before = {joint.child: joint for joint in description.joints}
    length, link = 0.0, description.tcp_link
    while link in before and before[link].parent != "world":
        length += float(np.linalg.norm(before[link].pose.translation))
        link = before[link].parent
    return max(0.2, length)


class SceneView:
    """Everything that viser shows of one cell; it is cleared and drawn again for another one."""

    def __init__(
        self,
        server: viser.ViserServer,
        on_drag: OnDrag = lambda *_: None,
        on_choose: OnChoose = lambda *_: None,
    ) -> None:
        self._server = server
        self._on_drag, self._on_choose = on_drag, on_choose
        self._links: dict[str, _Body] = {}
        self._objects: dict[str, _Body] = {}
        self._ghosts: Sequence[Ghost] = ()
        self._bodies: list[dict[str, _Body]] = []
        self.handle: Any = None
        self._object_handle: Any = None
        self._path: Any = None
        self._clearance: Any = None
        self._shapes: dict[str, list[Triangles]] = {}

    def show_cell(self, description: RobotDescription, tcp_pose: SE3 | None = None) -> None:
        """Draw another robot, without objects, and put a handle on its TCP where it is given."""
        scene = self._server.scene
        scene.reset()
        self._objects, self._ghosts, self._bodies = {}, (), []
        self._path = self._object_handle = self._clearance = None
        self._description = description
        self._shapes = robot_triangles(description)
        reach = reach_of(description)
        [base] = self._link_poses(description.start_positions(), [description.base_link])
        look_at = base[:3] + np.array([0.0, 0.0, 0.3 * reach])
        self._server.initial_camera.look_at = tuple(look_at)
        self._server.initial_camera.position = tuple(look_at + reach * np.array([1.1, -0.9, 0.6]))
        self._server.scene.set_up_direction("+z")
        scene.add_grid(
            "/grid", width=4, height=4, cell_size=0.1, section_size=0.5, position=(0, 0, 5e-4)
        )
        self._links = {
            name: self._body(f"/robot/{name}", parts) for name, parts in self._shapes.items()
        }
        self._scale = 0.25 * reach
        if tcp_pose is None:
            return
        self.handle = scene.add_transform_controls(
            "/tcp", scale=self._scale, depth_test=False, line_width=3.0
        )
        self.move_handle(tcp_pose)

        @self.handle.on_update
        async def _(event: Any) -> None:
            pose = SE3.from_xyz_quat(event.target.position, event.target.wxyz)
            self._on_drag(event.client_id, event.phase, pose, "")

    def show_objects(self, objects: Sequence[WorldObject]) -> None:
        """Draw these objects in place of those shown."""
        for body in self._objects.values():
            body.handle.remove()
        self._objects = {
            obj.name: self._body(f"/objects/{obj.name}", triangles_of(obj.visuals or obj.shapes))
            for obj in objects
        }

    def move(self, joint_positions: FloatArray, objects: Mapping[str, FloatArray]) -> None:
        """Show the robot at joint positions and the objects at their poses; others are hidden."""
        names = list(self._links)
        poses = self._link_poses(joint_positions, names)
        with self._server.atomic():
            for name, pose in zip(names, poses, strict=True):
                self._links[name].move(pose)
            for name, body in self._objects.items():
                if body.handle.visible != (name in objects):
                    body.handle.visible = name in objects
                if name in objects:
                    body.move(objects[name])

    def show_ghosts(self, ghosts: Sequence[Ghost]) -> None:
        """Show these ghosts in place of those shown."""
        self._ghosts = ghosts
        with self._server.atomic():
            while len(self._bodies) < len(ghosts):
                self._bodies.append(self._ghost_body(len(self._bodies)))
            for bodies in self._bodies[len(ghosts) :]:
                for body in bodies.values():
                    if body.handle.visible:
                        body.handle.visible = False
            for ghost, bodies in zip(ghosts, self._bodies, strict=False):
                poses = self._link_poses(ghost.positions, list(bodies))
                for body, pose in zip(bodies.values(), poses, strict=True):
                    if not body.handle.visible:
                        body.handle.visible = True
                    body.move(pose)
                    for part in body.handle.parts:
                        if tuple(part.color) != ghost.color:
                            part.color = ghost.color
                        if part.opacity != ghost.opacity:
                            part.opacity = ghost.opacity

    def _ghost_body(self, number: int) -> dict[str, _Body]:
        """The links of a further ghost; a click on them chooses its way."""
        found = {
            name: self._body(f"/ghost/{number}/{name}", parts, opacity=0.25)
            for name, parts in self._shapes.items()
        }

        async def choose(event: Any) -> None:
            if number < len(self._ghosts) and self._ghosts[number].way >= 0:
                self._on_choose(event.client_id, self._ghosts[number].way)

        for body in found.values():
            for part in body.handle.parts:
                part.on_click(choose)
        return found

    def show_path(self, points: FloatArray | None) -> None:
        """Show the path of the TCP, shape (N, 3); None removes it."""
        if self._path is not None:
            self._path.remove()
            self._path = None
        if points is not None and len(points) > 1:
            segments = np.stack([points[:-1], points[1:]], axis=1)
            self._path = self._server.scene.add_line_segments(
                "/path", segments, PLANNED, thickness=0.006
            )

    def show_clearance(self, points: FloatArray | None) -> None:
        """Show a line between the nearest points of two bodies, shape (2, 3)."""
        if self._clearance is not None:
            self._clearance.remove()
            self._clearance = None
        if points is not None:
            self._clearance = self._server.scene.add_line_segments(
                "/clearance", points[None], REFUSED, thickness=0.003
            )

    def show_object_handle(self, name: str, pose: SE3 | None) -> None:
        """Put a second handle on an object; None takes it away."""
        if self._object_handle is not None:
            self._object_handle.remove()
            self._object_handle = None
        if pose is None:
            return
        vector = pose.as_vector()
        self._object_handle = self._server.scene.add_transform_controls(
            "/object_handle",
            scale=self._scale,
            depth_test=False,
            position=tuple(vector[:3]),
            wxyz=tuple(vector[3:]),
        )

        @self._object_handle.on_update
        async def _(event: Any) -> None:
            pose = SE3.from_xyz_quat(event.target.position, event.target.wxyz)
            self._on_drag(event.client_id, event.phase, pose, name)

    def move_handle(self, pose: SE3) -> None:
        """Put the handle on a pose T_world_tcp."""
        vector = pose.as_vector()
        self.handle.position, self.handle.wxyz = tuple(vector[:3]), tuple(vector[3:])

    def _link_poses(self, joint_positions: FloatArray, names: Sequence[str]) -> FloatArray:
        """T_world_link (xyz, quat wxyz) of some links, shape (n, 7)."""
        poses = LinkPoses(self._description, joint_positions, names)
        translations = np.array([poses.translations[name][0] for name in names])
        rotations = np.array([poses.rotations[name][0] for name in names])
        return np.hstack([translations, quats_wxyz(rotations)])

    def _body(self, name: str, parts: Sequence[Triangles], opacity: float | None = None) -> _Body:
        scene = self._server.scene
        frame: Any = scene.add_frame(name, show_axes=False)
        frame.parts = [
            scene.add_mesh_simple(
                f"{name}/{number}",
                part.vertices.astype(np.float32),
                part.faces.astype(np.uint32),
                color=part.color,
                flat_shading=True,
                opacity=opacity or (part.opacity if part.opacity < 1 else None),
                cast_shadow=False,
            )
            for number, part in enumerate(parts)
        ]
        return _Body(frame)
