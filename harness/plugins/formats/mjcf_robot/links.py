"""MJCF's bodies and geoms as links and shapes."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.geometry import Box, Capsule, Cylinder, Geometry, Mesh, Shape, Sphere
from harness.core.spatial import rotation_from_quat_wxyz
from harness.plugins.formats.mjcf_robot.joints import mjcf_pose
from harness.robot.mechanism import Inertial, Link
from harness.robot.mesh_file import SUFFIXES
from harness.robot.urdf.links import corrected_note, possible_moments

SHARE = 1e-3  # Share of a body's mass that each link between two of its joints gets
RADIUS = 0.01  # Radius of such a link, which is a solid sphere [m]


def body_link(spec: Any, model: Any, folder: Path, body: int, name: str, notes: list[str]) -> Link:
    """A body with its mass, its collision geoms and its visual geoms."""
    mass = float(model.body_mass[body])
    inertial = stated = None
    if mass > 0:
        R = rotation_from_quat_wxyz(model.body_iquat[body])
        moments = np.array(model.body_inertia[body], dtype=float)
        if moments.min() <= 0.0:  # MuJoCo accepts it for a body that a joint moves with others
            order = np.argsort(moments)
            stated = moments[order]
            moments[order] = possible_moments(stated, mass)
            notes.append(corrected_note(name, stated, moments[order]))
        tensor = R @ np.diag(moments) @ R.T
        tensor = 0.5 * (tensor + tensor.T)
        inertial = Inertial(mass, np.array(model.body_ipos[body]), tensor, stated)
    visuals: list[Shape] = []
    collisions: list[Shape] = []
    first = int(model.body_geomadr[body])
    for geom in range(first, first + int(model.body_geomnum[body])):
        shape = _shape(spec, model, folder, geom, name, notes)
        if shape is None:
            continue
        touches = model.geom_contype[geom] or model.geom_conaffinity[geom]
        (collisions if touches else visuals).append(shape)
    return Link(name, inertial, tuple(visuals or collisions), tuple(collisions))


def links_between(names: Sequence[str], joint_count: int, own: Link) -> list[Link]:
    """A body's links: those between its joints, then the body itself.

    In MuJoCo a body can have several joints; here each joint has a child link. Every moving link
    needs mass, so the links between joints get a small share of the body's mass.
    """
    if own.inertial is None or joint_count < 2:
        return [*(Link(name, None) for name in names), own]
    mass = SHARE * own.inertial.mass
    tensor = 0.4 * mass * RADIUS**2 * np.eye(3)
    bead = Inertial(mass, np.zeros(3), tensor)
    left = own.inertial.mass - (joint_count - 1) * mass
    rest = replace(own.inertial, mass=left, inertia=own.inertial.inertia * left / own.inertial.mass)
    beads = [
        Link(name, bead if number < joint_count - 1 else None) for number, name in enumerate(names)
    ]
    return [*beads, replace(own, inertial=rest)]


def _shape(
    spec: Any, model: Any, folder: Path, geom: int, link: str, notes: list[str]
) -> Shape | None:
    import mujoco

    kinds = mujoco.mjtGeom
    pose = mjcf_pose(model.geom_pos[geom], model.geom_quat[geom])
    radius, half, third = (float(size) for size in model.geom_size[geom])
    geometry: Geometry | None = None
    match mujoco.mjtGeom(int(model.geom_type[geom])):
        case kinds.mjGEOM_BOX:
            geometry = Box((2 * radius, 2 * half, 2 * third))
        case kinds.mjGEOM_SPHERE:
            geometry = Sphere(radius)
        case kinds.mjGEOM_CYLINDER:
            geometry = Cylinder(radius, 2 * half)
        case kinds.mjGEOM_CAPSULE:
            geometry = Capsule(radius, 2 * half)
        case kinds.mjGEOM_MESH:
            number = int(model.geom_dataid[geom])
            geometry = _mesh(spec, folder, model.mesh(number).name)
            pose = pose @ mjcf_pose(model.mesh_pos[number], model.mesh_quat[number]).inverse()
        case _:
            pass
    if geometry is None:
        kind = kinds(int(model.geom_type[geom])).name.removeprefix("mjGEOM_").lower()
        notes.append(f"body '{link}': a {kind} is left out")
        return None
    red, green, blue, alpha = (float(value) for value in model.geom_rgba[geom])
    return Shape(geometry, pose, (red, green, blue, alpha))


def _mesh(spec: Any, folder: Path, name: str) -> Mesh | None:
    asset = spec.mesh(name)
    if asset is None or not asset.file or Path(asset.file).suffix.lower() not in SUFFIXES:
        return None
    x, y, z = (float(value) for value in asset.scale)
    inside = folder / (spec.meshdir or spec.compiler.meshdir or "")
    return Mesh((inside / asset.file).resolve(), (x, y, z))
