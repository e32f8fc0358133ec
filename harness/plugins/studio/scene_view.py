"""The cell as viser draws it: links, objects, ghosts of goals and plans, the handle on the TCP."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import viser

from harness.cameras.meshes import coarsen, mesh_parts
from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Plane, Shape, Sphere
from harness.core.kinematics import LinkPoses
from harness.core.spatial import SE3
from harness.core.types import FloatArray, IntArray
from harness.core.world import WorldObject
from harness.robot.description import RobotDescription

MOST_TRIANGLES = 20_000  # of the whole robot; its meshes are coarsened until they are no more
GRID = 0.002  # the first cell size in which vertices are merged [m]

GHOST, REFUSED, PLANNED = (70, 130, 220), (214, 60, 50), (40, 160, 90)
PLANE_SIZE = 6.0  # [m]

Color = tuple[int, int, int]
Handle = Literal["tcp", "object", "size"]  # the TCP's goal, an object, or its size's corner
OnDrag = Callable[[int, str, SE3, Handle], None]  # connection, phase, and the new pose
OnChoose = Callable[[int, int], None]  # number of the page's connection, and of the way


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
    import trimesh.creation as create

    match shape.geometry:
        case Mesh() as mesh:
            for part in mesh_parts(mesh):
                vertices, faces = part.vertices, part.faces
                if grid > GRID:
                    vertices, faces = coarsen(vertices, faces, grid)
                yield vertices, faces, part.rgba or shape.rgba
            return
        case Box(size=size):
            solid = create.box(size)
        case Plane():
            solid = create.box((PLANE_SIZE, PLANE_SIZE, 0.002)).apply_translation([0, 0, -0.001])
        case Cylinder(radius=radius, length=length):
            solid = create.cylinder(radius, length, sections=24)
        case Sphere(radius=radius):
            solid = create.icosphere(3, radius)
        case Capsule(radius=radius, length=length):
            solid = create.capsule(length, radius, count=[24, 14])
            solid.apply_translation(-solid.bounds.mean(axis=0))
    yield np.array(solid.vertices), np.array(solid.faces), shape.rgba


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

    def show(self, is_visible: bool) -> None:
        if self.handle.visible != is_visible:
            self.handle.visible = is_visible


def reach_of(description: RobotDescription) -> float:
    """The length of the arm from its base to its TCP [m]: how far away the camera stands."""
    before = {joint.child: joint for joint in description.joints}
    length, link = 0.0, description.tcp_link
    while link in before and before[link].parent != "world":
        length += float(np.linalg.norm(before[link].pose.translation))
        link = before[link].parent
    return max(0.2, length)


class SceneView:
    """Everything that viser shows of one cell."""

    def __init__(
        self,
        server: viser.ViserServer,
        on_drag: OnDrag = lambda *_: None,
        on_choose: OnChoose = lambda *_: None,
    ) -> None:
        self._server = server
        self._on_drag, self._on_choose = on_drag, on_choose
        self._robot = b""
        self._links: dict[str, _Body] = {}
        self._objects: dict[str, _Body] = {}
        self._ghosts: Sequence[Ghost] = ()
        self._bodies: list[dict[str, _Body]] = []
        self.handles: dict[Handle, Any] = {}
        self._lines: dict[str, Any] = {}
        self._shapes: dict[str, list[Triangles]] = {}

    def show_robot(self, description: RobotDescription, tcp_pose: SE3 | None = None) -> None:
        """Draw another robot, without objects; an equal one stays as it is.

        Args:
            tcp_pose: Where a handle is put on the TCP; None: there is no handle.
        """
        robot = pickle.dumps(description)
        if robot != self._robot:
            self._robot = robot
            self._draw_robot(description)
        if tcp_pose is not None:
            self.put_handle("tcp", tcp_pose)

    def _draw_robot(self, description: RobotDescription) -> None:
        scene = self._server.scene
        scene.reset()
        self._objects, self._ghosts, self._bodies = {}, (), []
        self._lines, self.handles = {}, {}
        self._description = description
        self._shapes = robot_triangles(description)
        reach = reach_of(description)
        ends = [description.base_link, description.tcp_link]
        look_at = self._link_poses(description.start_positions(), ends)[:, :3].mean(axis=0)
        self._server.initial_camera.look_at = tuple(look_at)
        self._server.initial_camera.position = tuple(look_at + reach * np.array([0.9, -0.9, 0.5]))
        scene.set_up_direction("+z")
        scene.add_grid(
            "/grid", width=4, height=4, cell_size=0.1, section_size=0.5, position=(0, 0, 5e-4)
        )
        self._links = {
            name: self._body(f"/robot/{name}", parts) for name, parts in self._shapes.items()
        }
        self._scale = 0.25 * reach

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
                body.show(name in objects)
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
                    body.show(False)
            for ghost, bodies in zip(ghosts, self._bodies, strict=False):
                poses = self._link_poses(ghost.positions, list(bodies))
                for body, pose in zip(bodies.values(), poses, strict=True):
                    body.show(True)
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
        segments = None if points is None else np.stack([points[:-1], points[1:]], axis=1)
        self._show_lines("/path", segments, PLANNED, 0.006)

    def show_clearance(self, points: FloatArray | None) -> None:
        """Show a line between the nearest points of two bodies, shape (2, 3)."""
        self._show_lines("/clearance", None if points is None else points[None], REFUSED, 0.003)

    def _show_lines(
        self, name: str, segments: FloatArray | None, color: Color, thickness: float
    ) -> None:
        """Show lines, shape (N, 2, 3), in place of those of the same name."""
        before = self._lines.pop(name, None)
        if before is not None:
            before.remove()
        if segments is not None and len(segments):
            self._lines[name] = self._server.scene.add_line_segments(
                name, segments, color, thickness=thickness
            )

    def put_handle(self, kind: Handle, pose: SE3 | None, axes: Sequence[int] = ()) -> None:
        """Put a handle on a pose in the world; None takes it away.

        Args:
            kind: What the handle moves.
            axes: The axes along which alone it moves; without any, it moves and turns freely.
        """
        vector = None if pose is None else pose.as_vector()
        handle = self.handles.get(kind)
        if handle is not None and (vector is None or axes):
            self.handles.pop(kind).remove()
            handle = None
        if vector is None:
            return
        if handle is None:
            handle = self.handles[kind] = self._new_handle(kind, axes)
        handle.position, handle.wxyz = tuple(vector[:3]), tuple(vector[3:])

    def _new_handle(self, kind: Handle, axes: Sequence[int]) -> Any:
        handle = self._server.scene.add_transform_controls(
            f"/handle/{kind}",
            scale=(0.5 if axes else 1.0) * self._scale,
            depth_test=False,
            line_width=3.0,
            active_axes=(0 in axes, 1 in axes, 2 in axes) if axes else (True, True, True),
            disable_sliders=bool(axes),
            disable_rotations=bool(axes),
        )

        @handle.on_update
        async def _(event: Any) -> None:
            pose = SE3.from_xyz_quat(event.target.position, event.target.wxyz)
            self._on_drag(event.client_id, event.phase, pose, kind)

        return handle

    def _link_poses(self, joint_positions: FloatArray, names: Sequence[str]) -> FloatArray:
        """T_world_link (xyz, quat wxyz) of some links, shape (n, 7)."""
        poses = LinkPoses(self._description.joints, joint_positions, names)
        return np.array([poses.rows(name)[0] for name in names])

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
