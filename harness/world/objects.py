"""Resolves the objects of a file: shapes, mass, inertia, friction."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from harness.core.errors import RobotError
from harness.core.files import is_file
from harness.core.geometry import (
    Box,
    Capsule,
    CollisionMode,
    Cylinder,
    Friction,
    Geometry,
    Mesh,
    Plane,
    Rgba,
    Shape,
    Sphere,
)
from harness.core.slow_work import reported
from harness.core.solids import is_inertia_of_a_body, point_inertia
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.core.world import Hole, Light, World, WorldObject
from harness.language.world import (
    GEOMETRIES,
    FrictionSpec,
    ObjectSpec,
    ShapeSpec,
    WorldSpec,
)
from harness.robot.collision_shapes import collision_shapes
from harness.robot.mesh_file import shape_solid, with_hull

DEFAULT_DENSITY = 1000.0  # [kg/m^3]
DEFAULT_COLOR: Rgba = (0.62, 0.66, 0.72, 1.0)


class ObjectUnusableError(ValueError):
    """An object lacks something that only its author can say."""


def resolve_object(
    spec: ObjectSpec, pose: SE3, base_dir: Path, collision: CollisionMode | None = None
) -> WorldObject:
    """The object with every number known.

    Raises:
        ObjectUnusableError: A dynamic object of planes, one without shapes, mass and inertia, or
            a mesh file that is not there or cannot be used.
    """
    parts = spec.shapes or ((spec,) if _has_geometry(spec) else ())
    given, holes = _bored(parts, [_shape(part, spec.color, base_dir) for part in parts])
    try:
        with reported(f"computing convex shapes of '{spec.name}'"):
            shapes = tuple(map(with_hull, collision_shapes(given, collision)))
    except RobotError as error:
        raise ObjectUnusableError(str(error)) from error
    mass, center, inertia = 0.0, np.array(spec.center_of_mass, dtype=float), np.zeros((3, 3))
    if not spec.static:
        with np.errstate(over="ignore", invalid="ignore"):  # the physics refuses what overflows
            mass, center, inertia = _mass_properties(spec, shapes)
    return WorldObject(
        name=spec.name,
        shapes=shapes,
        pose=pose,
        is_static=spec.static,
        mass=mass,
        center_of_mass=center,
        inertia=inertia,
        friction=_friction(spec.friction),
        in_planning=spec.in_ in ("planning", "both"),
        in_simulation=spec.in_ in ("simulation", "both"),
        visuals=_looks(spec, parts, base_dir) or (given if len(shapes) > len(given) else ()),
        surface_motion=spec.surface_motion,
        holes=holes,
    )


def _bored(
    parts: Sequence[ObjectSpec | ShapeSpec], shapes: Sequence[Shape]
) -> tuple[tuple[Shape, ...], tuple[Hole, ...]]:
    """The shapes, boxes with a hole as the boxes around it, and the holes."""
    given: list[Shape] = []
    holes: list[Hole] = []
    for part, shape in zip(parts, shapes, strict=True):
        if part.box is None or part.box.hole is None:
            given.append(shape)
            continue
        around, hole = part.box.hole.bored(shape)
        given += around
        holes.append(hole)
    return tuple(given), tuple(holes)


def _looks(
    spec: ObjectSpec, parts: Sequence[ObjectSpec | ShapeSpec], base_dir: Path
) -> tuple[Shape, ...]:
    """What pictures show instead of the shapes; nothing where the shapes themselves will do."""
    if not spec.visuals and all(part.marker is None for part in parts):
        return ()
    looks: list[Shape] = []
    for part in spec.visuals or parts:
        shape = _shape(part, spec.color, base_dir)
        looks += [shape] if part.marker is None else part.marker.printed(shape.pose, shape.name)
    return tuple(looks)


def resolve_world(spec: WorldSpec, objects: tuple[WorldObject, ...]) -> World:
    """The world around resolved objects."""
    return World(
        name=spec.world,
        objects=objects,
        gravity=spec.physics.gravity,
        timestep=spec.physics.timestep,
        lights=tuple(
            Light(light.direction, light.diffuse[:3], light.casts_shadow) for light in spec.lights
        ),
    )


def _has_geometry(spec: ObjectSpec) -> bool:
    return any(getattr(spec, kind) is not None for kind in GEOMETRIES)


def primitive(spec: ObjectSpec | ShapeSpec) -> Geometry | None:
    """The box, cylinder, sphere or capsule of a shape; None for other shapes."""
    if spec.box is not None:
        return Box(spec.box.size)
    if spec.cylinder is not None:
        return Cylinder(spec.cylinder.radius, spec.cylinder.length)
    if spec.sphere is not None:
        return Sphere(spec.sphere.radius)
    if spec.capsule is not None:
        return Capsule(spec.capsule.radius, spec.capsule.length)
    return None


def _geometry(spec: ObjectSpec | ShapeSpec, base_dir: Path) -> Geometry:
    if (solid := primitive(spec)) is not None:
        return solid
    if spec.marker is not None:
        return spec.marker.solid()
    if spec.mesh is not None:
        path = base_dir / spec.mesh.file
        if not is_file(path):
            raise ObjectUnusableError(f"there is no mesh file '{spec.mesh.file}' next to the file")
        scale = spec.mesh.scale
        factors = scale if isinstance(scale, tuple) else (scale, scale, scale)
        return Mesh(path, factors, spec.mesh.collision)
    return Plane()


def _shape(spec: ObjectSpec | ShapeSpec, color: Rgba | None, base_dir: Path) -> Shape:
    pose = spec.pose.se3() if isinstance(spec, ShapeSpec) else SE3.identity()
    own = spec.color or color or DEFAULT_COLOR
    is_own = isinstance(spec, ShapeSpec) and spec.friction is not None
    friction = _friction(spec.friction) if is_own else None
    return Shape(_geometry(spec, base_dir), pose, own, spec.name or "", friction)


def _friction(spec: float | FrictionSpec | None) -> Friction:
    if spec is None:
        return Friction()
    if isinstance(spec, FrictionSpec):
        return Friction(spec.sliding, spec.torsional, spec.rolling)
    return Friction(sliding=spec)


def _mass_properties(
    spec: ObjectSpec, shapes: tuple[Shape, ...]
) -> tuple[float, FloatArray, FloatArray]:
    """Mass [kg], centre of mass [m] and inertia about it [kg m^2], from the file or from solids."""
    if any(isinstance(shape.geometry, Plane) for shape in shapes):
        raise ObjectUnusableError("a plane has no mass: say `static: true`")
    if not shapes and (spec.mass is None or spec.inertia is None):
        raise ObjectUnusableError(
            "what moves and has no shape needs `mass` and `inertia`, or `static: true`"
        )
    solids = [] if spec.inertia is not None and spec.mass is not None else _solids(shapes)
    total = sum(volume for volume, _, _ in solids)
    mass = spec.mass if spec.mass is not None else DEFAULT_DENSITY * total
    given_center = np.array(spec.center_of_mass, dtype=float)
    if spec.inertia is not None:
        i = spec.inertia
        tensor = np.array([[i.ixx, i.ixy, i.ixz], [i.ixy, i.iyy, i.iyz], [i.ixz, i.iyz, i.izz]])
        _check_inertia(tensor)
        return mass, given_center, tensor
    density = mass / total
    centroids = [volume / total * centroid for volume, centroid, _ in solids]
    center = given_center if np.any(given_center) else np.sum(centroids, axis=0)
    inertia = np.zeros((3, 3))
    for volume, centroid, tensor in solids:
        inertia += density * tensor
        inertia += point_inertia(density * volume, centroid - center)
    return mass, center, inertia


def _solids(shapes: Sequence[Shape]) -> list[tuple[float, FloatArray, FloatArray]]:
    """The solid of each shape; of a mesh its convex parts, which are what touches."""
    try:
        return [solid for shape in shapes if (solid := shape_solid(shape)) is not None]
    except RobotError as error:
        raise ObjectUnusableError(str(error)) from error


def _check_inertia(tensor: FloatArray) -> None:
    if not is_inertia_of_a_body(tensor):
        moments = np.linalg.eigvalsh(tensor)
        raise ObjectUnusableError(
            "no body has this inertia: its principal moments are "
            + ", ".join(f"{moment:.6g}" for moment in moments)
            + " kg m^2, and each must be positive and no more than the sum of the others"
        )
