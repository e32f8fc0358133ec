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

MuJoCo raises the time constant to two steps where those are longer. The friction of a contact has
the time constant alone: an object carried on a curve creeps by half of it times its centripetal
acceleration, except between fingers and free objects.
"""

CONTACT_SOLIMP = (0.0, 0.999, 0.0001, 0.5, 2.0)
"""Impedance d of a contact: at touch, when pressed, width of the change [m], its shape.

MuJoCo's friction is the convex relaxation of Coulomb's: a contact that slides with velocity v is
also pushed apart, with mu b v for b = 2 / time constant. Only its compliance (1 - d) / d times the
force balances that. With a nearly rigid contact, d = 0.99 at touch, a box that slides faster than
0.25 mm/s hops instead: it leaves the ground for some milliseconds, is free of friction meanwhile,
and strikes the ground and the finger that pushes it. A contact that begins soft finds its balance
within the width, at any speed; one narrower than 0.1 mm is too steep for a step of 1 ms. The large
damping ratio keeps d near 1 at rest: without it, d is 0.3 there, cylinders rock by 0.01 rad/s and
what stands on a slope creeps by 0.2 mm/s. In return, bodies that overlap part with a time constant
of 0.25 s: an object that falls by 20 cm is 0.6 mm too deep for that long. A box of 2 kg that is
pushed across the ground, mu 0.4 (friction needs 7.84 N), by a finger at 0.1 m/s:

    d at touch, damping ratio   finger [N]       ground [N]      creep at 0.91 of the cone
    0.99, width 1 mm, 1         0 to 55.9        0 to 172        0.002 mm/s
    0, 0.1 mm, 1                7.80 to 8.72     19.5 to 21.1    0.18 mm/s
    0, 0.1 mm, 4                7.70 to 9.36     19.2 to 22.8    0.03 mm/s
    0, 0.1 mm, 8                7.69 to 9.10     19.2 to 21.9    0.01 mm/s
    0, 0.1 mm, 16               7.68 to 9.14     19.2 to 22.4    0.003 mm/s

An object sinks 0.08 mm into what it stands on.
"""

STIFF_SOLREF = (0.002, 1.0)
STIFF_SOLIMP = (0.97, 0.999, 1e-5, 0.5, 2.0)
"""The same of a contact of a free object with a finger, or with a body that has a hole.

A grasp sticks and is pressed by a motor instead of a weight: it is stiffer, so that what is held
creeps less. At 0.95 of Coulomb's limit a cylinder of 0.1 kg creeps by 0.01 mm in 3 s; with the
values of other contacts by 1.6 mm. Walls of a hole that give way by 0.1 mm would let a peg in
that is 0.1 mm too thick, pressed with 10 N.
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
