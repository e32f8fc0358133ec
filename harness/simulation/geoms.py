"""MuJoCo geoms of the program's shapes, and contact parameters that every surface shares."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import mujoco

from harness.core.geometry import (
    Box,
    Capsule,
    Cylinder,
    Friction,
    Geometry,
    Mesh,
    Plane,
    Shape,
    Sphere,
)
from harness.robot.mesh_file import hull_points

CONTACT_SOLREF = (0.002, 8.0)
"""Time constant [s] and damping ratio of a contact.

The friction of a contact has the time constant alone: an object carried on a curve creeps by half
of it times its centripetal acceleration, except between fingers and free objects.
"""

CONTACT_SOLIMP = (0.0, 0.999, 0.0001, 0.5, 2.0)
"""Impedance d of a contact: at touch, when pressed, width of the change [m], its shape.

MuJoCo's friction also pushes apart what slides. A contact that is rigid at touch hops; one that
begins soft finds its balance within the width, at any speed, and one narrower than 0.1 mm is too
steep for a step of 1 ms. The large damping ratio keeps d near 1 at rest: without it cylinders rock,
and what stands on a slope creeps. In return, bodies that overlap part with a time constant of
0.25 s. docs/explanation/friction.md has what was measured with other values.
"""

STIFF_SOLREF = (0.002, 1.0)
STIFF_SOLIMP = (0.97, 0.999, 1e-5, 0.5, 2.0)
"""The same of a contact of a free object with a finger, or with a body that has a hole.

A grasp sticks and is pressed by a motor instead of a weight: it is stiffer, so that what is held
creeps less. Walls of a hole that give way by 0.1 mm would let a peg in that is too thick by that.
"""

CONTACT_DIMENSIONS = 6
"""Normal force, two sliding, one torsional and two rolling friction directions."""


def roughness(friction: Friction) -> tuple[float, float, float]:
    """The frictions of a surface as MuJoCo orders them."""
    return friction.sliding, friction.torsional, friction.rolling


def set_smaller_frictions(model: mujoco.MjModel) -> None:
    """Let the smaller friction of two surfaces in contact apply, as the geoms have them now.

    MuJoCo takes the larger friction of a pair unless one geom has a higher `priority`; then that
    geom's values count. So the surface with the least friction gets the highest priority. An
    explicit pair has its own values.
    """
    frictions = [tuple(row) for row in model.geom_friction]
    ranked = sorted(set(frictions), reverse=True)
    model.geom_priority[:] = [ranked.index(friction) for friction in frictions]
    pairs = zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), strict=True)
    for pair, (first, second) in enumerate(pairs):
        sliding, torsional, rolling = min(frictions[first], frictions[second])
        model.pair_friction[pair] = sliding, sliding, torsional, rolling, rolling


def add_collision_geom(spec: mujoco.MjSpec, body: mujoco.MjsBody, shape: Shape) -> None:
    """Put a massless contact geom on a body; its friction is set in the compiled model."""
    kind, size = geom_kind_and_size(shape.geometry)
    geom = body.add_geom(name=f"{body.name} {len(body.geoms)}", type=kind, size=size)
    geom.pos = shape.pose.translation
    geom.quat = shape.pose.quat_wxyz
    if isinstance(shape.geometry, Mesh):
        geom.meshname = add_mesh(spec, shape.geometry)
    geom.mass = 0.0
    geom.rgba = shape.rgba
    geom.condim = CONTACT_DIMENSIONS
    geom.solref = CONTACT_SOLREF
    geom.solimp = CONTACT_SOLIMP
    geom.contype = geom.conaffinity = 1


def geom_kind_and_size(geometry: Geometry) -> tuple[mujoco.mjtGeom, list[float]]:
    """MuJoCo's geom type and its `size`: half lengths, radius first."""
    match geometry:
        case Box(size=(x, y, z)):
            return mujoco.mjtGeom.mjGEOM_BOX, [x / 2, y / 2, z / 2]
        case Cylinder(radius=radius, length=length):
            return mujoco.mjtGeom.mjGEOM_CYLINDER, [radius, length / 2, 0.0]
        case Sphere(radius=radius):
            return mujoco.mjtGeom.mjGEOM_SPHERE, [radius, 0.0, 0.0]
        case Capsule(radius=radius, length=length):
            return mujoco.mjtGeom.mjGEOM_CAPSULE, [radius, length / 2, 0.0]
        case Plane():
            return mujoco.mjtGeom.mjGEOM_PLANE, [0.0, 0.0, 0.01]
        case Mesh():
            return mujoco.mjtGeom.mjGEOM_MESH, [0.0, 0.0, 0.0]


def add_mesh(spec: mujoco.MjSpec, geometry: Mesh) -> str:
    """Register a mesh file once, as its hull or part collides; returns the asset's name.

    Raises:
        RobotError: The file cannot be read, or is flat.
    """
    name = f"{geometry.path}|{geometry.scale}|{geometry.part}"
    if spec.mesh(name) is None:
        mesh = spec.add_mesh(name=name)
        mesh.uservert = hull_points(geometry).ravel()
        mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX
    return name
