"""The cell as pages draw it: bodies once, then their poses; ghosts of goals, and plans."""

from __future__ import annotations

import base64
import pickle
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from harness.cameras.meshes import MeshPart, coarsen, mesh_parts
from harness.core.geometry import Mesh, Shape, bounding_radius
from harness.core.kinematics import LinkPoses
from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.plugins.studio.session import Message
from harness.reporting.html.scene import MeshKey, plain_shape
from harness.robot.description import RobotDescription

MOST_TRIANGLES = 20_000  # of the whole robot; its meshes are coarsened until they are no more
GRID = 0.002  # the first cell size in which vertices are merged [m]
LARGE = 0.6  # an object that reaches farther does not widen the first view [m]
MOST_FRAMES = 61  # poses of a plan; the page draws those between them
STILL = 1e-4  # a pose that differs by less is not sent again [m, and parts of a quaternion]

Tone = Literal["--accent", "--bad"]
GOAL: Tone = "--accent"
REFUSED: Tone = "--bad"


@dataclass(frozen=True, eq=False)
class Ghost:
    """The robot a second time, at other joint positions.

    Attributes:
        positions: Joint positions in description order, shape (n,).
        tone: A colour of the page's style sheet.
        is_solid: Whether it is drawn clearly, and not as one of several.
        way: The number of the way that it shows; -1 where there is nothing to choose.
    """

    positions: FloatArray
    tone: Tone = GOAL
    is_solid: bool = True
    way: int = -1


def coarse_meshes(shapes: Sequence[Shape]) -> dict[MeshKey, list[MeshPart]]:
    """The meshes of shapes, which are drawn with at most MOST_TRIANGLES in all."""
    used = [shape.geometry for shape in shapes if isinstance(shape.geometry, Mesh)]
    uses = Counter((mesh.path, mesh.scale) for mesh in used)
    parts = {(mesh.path, mesh.scale): list(mesh_parts(mesh)) for mesh in used}
    grid, drawn = GRID, parts
    while True:
        count = sum(uses[key] * sum(len(p.faces) for p in found) for key, found in drawn.items())
        if count <= MOST_TRIANGLES or grid > 0.1:
            return drawn
        grid *= max(1.1, (count / MOST_TRIANGLES) ** 0.5)
        drawn = {
            key: [MeshPart(*coarsen(p.vertices, p.faces, grid), p.rgba) for p in found]
            for key, found in parts.items()
        }


def bodies_message(
    kind: str, bodies: Mapping[str, Sequence[Shape]], more: Mapping[str, Message]
) -> Message:
    """Bodies by their names, with their shapes in their own frames.

    Args:
        kind: The type of the message.
        bodies: The shapes of each body.
        more: What else a page has to know of a body.
    """
    meshes: list[Message] = []
    numbers: dict[MeshKey, list[list[Any]]] = {}
    for key, parts in coarse_meshes([s for shapes in bodies.values() for s in shapes]).items():
        numbers[key] = []
        for part in parts:
            numbers[key].append([len(meshes), part.rgba and list(part.rgba)])
            meshes.append(
                {
                    "positions": _base64(part.vertices.astype(np.float32)),
                    "indices": _base64(part.faces.astype(np.uint32)),
                }
            )
    return {
        "type": kind,
        "meshes": meshes,
        "bodies": [
            {
                "name": name,
                "shapes": [plain_shape(shape, numbers) for shape in shapes],
                **more[name],
            }
            for name, shapes in bodies.items()
        ],
    }


class SceneView:
    """Everything that pages draw of one cell, for those that are open and those that come."""

    def __init__(self, broadcast: Callable[[Message], None]) -> None:
        self._broadcast = broadcast
        self._shown: dict[str, Message] = {}
        self._robot = b""
        self._links: list[str] = []
        self._last = np.zeros(0)

    def greeting(self) -> list[Message]:
        """What a page that comes has to know."""
        return list(self._shown.values())

    def _show(self, message: Message) -> None:
        self._shown[message["type"]] = message
        self._broadcast(message)

    def show_robot(self, description: RobotDescription) -> None:
        """Draw another robot; an equal one stays as it is."""
        robot = pickle.dumps((description.links, description.joints))
        if robot == self._robot:
            return
        self._robot, self._description = robot, description
        joints = {joint.child: joint.name for joint in description.joints if joint.kind != "fixed"}
        bodies = {link.name: link.visuals or link.collisions for link in description.links}
        self._links = [name for name, shapes in bodies.items() if shapes]
        more = {name: {"joint": joints.get(name, "")} for name in bodies}
        message = bodies_message("links", {name: bodies[name] for name in self._links}, more)
        self._last = np.zeros(0)
        self._show({**message, **self._views()})

    def _views(self) -> Message:
        """What the first view holds, and a sphere around what the sun's shadow covers."""
        description = self._description
        start = description.link_poses(description.start_positions())
        points = np.array(
            [start[name].translation for name in {*self._links, description.tcp_link}]
        )
        bases = [arm.base_link for arm in description.arms] or [description.base_link]
        tips = [arm.tcp_link for arm in description.arms] or [description.tcp_link]
        ends = zip(bases, tips, strict=True)
        reach = max(0.2, *(_length(description, base, tip) for base, tip in ends))
        around = 0.55 * reach * np.array([[1, 0, 0], [-0.5, 0, 0], [0, 1, 0], [0, -1, 0]])
        points = np.concatenate([points, *(start[base].translation + around for base in bases)])
        low, high = points.min(axis=0), points.max(axis=0)
        radius = 1.2 * reach + 0.5 * float(np.linalg.norm(high - low))
        return {
            "focus": {"points": points.round(4).tolist(), "arm": round(reach, 4)},
            "bounds": {"center": ((low + high) / 2).tolist(), "radius": radius},
        }

    def show_objects(self, objects: Sequence[WorldObject]) -> None:
        """Draw these objects in place of those shown."""
        bodies = {obj.name: obj.visuals or obj.shapes for obj in objects}
        more = {
            obj.name: {
                "isGhost": not obj.in_simulation,
                "canMove": not any(bounding_radius(shape) > LARGE for shape in obj.shapes),
            }
            for obj in objects
        }
        self._last = np.zeros(0)
        self._show(bodies_message("objects", bodies, more))

    def move(
        self, joint_positions: FloatArray, objects: Mapping[str, FloatArray], more: Message
    ) -> None:
        """Show the robot at joint positions and the objects at their poses; others are hidden.

        Args:
            joint_positions: Positions in description order.
            objects: T_world_object (xyz, quat wxyz) by name, shape (7,) each.
            more: What is sent along where something has moved.
        """
        links = self.link_poses(joint_positions)
        now = np.concatenate([links.ravel(), *objects.values()])
        names = list(objects)
        frame = self._shown.get("frame", {"objects": ()})
        is_same = len(now) == len(self._last) and names == list(frame["objects"])
        if is_same and np.abs(now - self._last).max(initial=0.0) < STILL:
            return
        self._last = now
        poses = {name: _rounded(pose) for name, pose in objects.items()}
        self._show({"type": "frame", "links": _rounded(links), "objects": poses, **more})

    def link_poses(self, joint_positions: FloatArray) -> FloatArray:
        """T_world_link (xyz, quat wxyz) of the links that are drawn, shape (n, 7)."""
        if not self._links:  # nothing is drawn yet
            return np.zeros((0, 7))
        poses = LinkPoses(self._description.joints, joint_positions, self._links)
        return np.array([poses.rows(name)[0] for name in self._links])

    def show_ghosts(self, ghosts: Iterable[Ghost]) -> None:
        """Show these ghosts in place of those shown."""
        shown = [
            {
                "poses": _rounded(self.link_poses(each.positions)),
                "tone": each.tone,
                "solid": each.is_solid,
                "way": each.way,
            }
            for each in ghosts
        ]
        self._show({"type": "ghosts", "ghosts": shown})

    def show_plan(
        self, positions: FloatArray | None, path: FloatArray | None = None, duration: float = 0.0
    ) -> None:
        """Show a motion as a ghost on a clock; None takes it away.

        Args:
            positions: Joint positions at equal times, description order, shape (N, n).
            path: Positions of the TCP along it, shape (M, 3).
            duration: The time it takes [s].
        """
        frames: list[Any] = []
        if positions is not None:
            rows = np.unique(np.linspace(0, len(positions) - 1, MOST_FRAMES).astype(int))
            frames = [_rounded(self.link_poses(positions[row])) for row in rows]
        points = [] if path is None else _rounded(path)
        self._show({"type": "plan", "frames": frames, "path": points, "duration": duration})

    def show_clearance(self, points: FloatArray | None) -> None:
        """Show a line between the nearest points of two bodies, shape (2, 3)."""
        message = {"type": "clearance", "points": None if points is None else _rounded(points)}
        if message != self._shown.get("clearance"):
            self._show(message)

    def put_handle(self, pose: FloatArray, turns: str) -> None:
        """Put the handle of the TCP's goal on a pose in the world.

        Args:
            pose: The pose (xyz, quat wxyz), shape (7,).
            turns: `all`, or `pitch` for arms that cannot choose the whole orientation.
        """
        self._show({"type": "handle", "pose": pose.tolist(), "turns": turns})


def _length(description: RobotDescription, base: str, tip: str) -> float:
    """The length of a chain of links [m]."""
    before = {joint.child: joint for joint in description.joints}
    length = 0.0
    while tip in before and tip != base and before[tip].parent != "world":
        length += float(np.linalg.norm(before[tip].pose.translation))
        tip = before[tip].parent
    return length


def _rounded(values: FloatArray) -> list[Any]:
    return np.round(values, 5).tolist()


def _base64(values: Any) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()
