"""Replaces meshes by their convex parts, with which planner and physics collide."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.errors import RobotOptionError
from harness.core.geometry import CollisionMode, Mesh, Shape, reach, undivided
from harness.core.suggestion import did_you_mean
from harness.robot.description import RobotDescription
from harness.robot.mechanism import Link
from harness.robot.mesh_file import decomposition_of

LEAST_LENGTH = 0.05  # Shorter links are not compared with their collision shapes [m]

LEAST_SHARE = 0.02
"""Of a link's length: smaller collision shapes are a mistake in units, most likely."""

DEFAULT_MODE: CollisionMode = "parts"  # How meshes collide where nothing is stated


def collision_shapes(
    shapes: Iterable[Shape], mode: CollisionMode | None = None
) -> tuple[Shape, ...]:
    """The shapes with which planner and physics collide.

    Args:
        shapes: The shapes of a body. A mesh that has a collision mode keeps it.
        mode: The mode of the other meshes; None for the default.

    Raises:
        RobotError: A mesh cannot be read, or is flat.
    """
    found: list[Shape] = []
    for shape in shapes:
        mesh = shape.geometry
        if not isinstance(mesh, Mesh) or mesh.part is not None:
            found.append(shape)
            continue
        mesh = replace(mesh, collision=mesh.collision or mode or DEFAULT_MODE)
        count = len(decomposition_of(mesh).parts) if mesh.collision == "parts" else 1
        numbers = range(count) if count > 1 else (None,)
        found += [replace(shape, geometry=replace(mesh, part=number)) for number in numbers]
    return tuple(found)


def with_collision_modes(
    links: Iterable[Link],
    words: CollisionMode | Mapping[str, CollisionMode] | None,
    mode: CollisionMode | None,
) -> tuple[Link, ...]:
    """Links whose meshes have their collision mode, still whole; arguments as below."""

    def mode_of(link: str) -> CollisionMode | None:
        return (words.get(link) if isinstance(words, Mapping) else words) or mode

    def with_mode(shape: Shape, link: str) -> Shape:
        mesh = shape.geometry
        if not isinstance(mesh, Mesh):
            return shape
        return replace(shape, geometry=replace(mesh, collision=mesh.collision or mode_of(link)))

    return tuple(
        replace(link, collisions=tuple(with_mode(shape, link.name) for shape in link.collisions))
        for link in links
    )


def with_collision_shapes(
    description: RobotDescription,
    links: CollisionMode | Mapping[str, CollisionMode] | None,
    mode: CollisionMode | None,
) -> RobotDescription:
    """The robot with the shapes with which planner and physics collide.

    Args:
        mode: How the others do; None for the default.

    Raises:
        RobotOptionError: A link is not known.
        RobotError: A mesh cannot be read, or is flat.
    """
    for name in links if isinstance(links, Mapping) else ():
        if name not in description.link_names:
            hint = did_you_mean(name, description.link_names, "links")
            raise RobotOptionError(
                "collision", f"'{description.name}' has no link '{name}'; {hint}"
            )
    described = replace(
        description,
        links=tuple(
            replace(link, collisions=collision_shapes(link.collisions))
            for link in with_collision_modes(description.links, links, mode)
        ),
    )
    notes = [*parts_notes({link.name: link.collisions for link in described.links})]
    if shapeless := described.shapeless_links:
        notes.append(
            "moving links without collision shapes, which pass through everything:"
            f" {', '.join(shapeless)}; give them `<collision>`, in MJCF geoms that collide"
        )
    notes += undersized_note(described)
    return replace(described, notes=(*described.notes, *notes))


def undersized_note(description: RobotDescription) -> tuple[str, ...]:
    """A note on links with collision shapes far smaller than the link is long; empty without."""
    found: dict[str, tuple[float, float]] = {}
    for link in description.links:
        ways = [
            float(np.linalg.norm(joint.pose.translation))
            for joint in description.joints
            if joint.parent == link.name and joint.is_movable
        ]
        length = max(ways, default=0.0)
        if not link.collisions or length < LEAST_LENGTH:
            continue
        size = max(map(_size, undivided(link.collisions)))
        if size < LEAST_SHARE * length:
            found[link.name] = size, length
    if not found:
        return ()
    name, (size, length) = min(found.items(), key=lambda each: each[1][0] / each[1][1])
    return (
        f"the collision shapes of {', '.join(found)} are far smaller than the links, at {name}"
        f" {1e3 * size:.2g} mm of {1e3 * length:.3g} mm, so most of what touches these links is not"
        " seen; look at the units and the `scale` of their meshes",
    )


def _size(shape: Shape) -> float:
    """The largest side of a box that holds a shape [m]."""
    if isinstance(shape.geometry, Mesh):
        return float(np.ptp(decomposition_of(shape.geometry).hull, axis=0).max())
    half = reach(shape.geometry, np.eye(3))
    return np.inf if half is None else 2 * float(half.max())


@dataclass(frozen=True)
class MeshShapes:
    """What stands for a mesh of a body.

    Attributes:
        parts: The number of convex parts; 0 for the triangles.
        excess: How far they reach beyond the mesh at most [m].
    """

    body: str
    file: str
    parts: int
    excess: float

    def __str__(self) -> str:
        if not self.parts:
            return f"{self.body}: the planner checks the triangles of {self.file}"
        shapes = f"{self.parts} convex parts" if self.parts > 1 else "its convex hull"
        larger = f"at most {1e3 * self.excess:.1f} mm larger than the mesh"
        return f"{self.body}: {self.file} collides as {shapes}, {larger}"


def mesh_shapes(bodies: Mapping[str, Iterable[Shape]]) -> tuple[MeshShapes, ...]:
    """What stands for every mesh of bodies, given by name with their collision shapes."""
    found: dict[tuple[str, Mesh], MeshShapes] = {}
    for body, shapes in bodies.items():
        for shape in undivided(shapes):
            mesh = shape.geometry
            if not isinstance(mesh, Mesh):
                continue
            measured = decomposition_of(mesh)
            parts, excess = len(measured.parts), measured.excess
            if mesh.collision == "exact":
                parts, excess = 0, 0.0
            elif mesh.collision == "hull":
                parts, excess = 1, measured.hull_excess
            found[body, mesh] = MeshShapes(body, mesh.path.name, parts, excess)
    return tuple(found.values())


def parts_notes(bodies: Mapping[str, Iterable[Shape]]) -> tuple[str, ...]:
    """A note on the meshes for which convex parts stand; empty where there are none."""
    parts = [each for each in mesh_shapes(bodies) if each.parts > 1]
    if not parts:
        return ()
    worst = max(parts, key=lambda each: each.excess)
    names = ", ".join(dict.fromkeys(each.body for each in parts))
    return (
        f"{sum(each.parts for each in parts)} convex parts stand for the meshes of {names}; they "
        f"reach at most {1e3 * worst.excess:.1f} mm beyond the mesh (at {worst.body})",
    )


def convex_shapes(shapes: Iterable[Shape]) -> tuple[Shape, ...]:
    """The shapes for the physics, where an `exact` mesh collides with its parts."""
    return collision_shapes(
        replace(shape, geometry=replace(shape.geometry, collision="parts"))
        if isinstance(shape.geometry, Mesh) and shape.geometry.collision == "exact"
        else shape
        for shape in shapes
    )
