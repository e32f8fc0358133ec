"""Poses of the links of a robot without an SRDF, and the links that touch each other there."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from harness.core.kinematics import LinkPoses
from harness.core.spatial import SE3
from harness.robot.collision_shapes import collision_shapes
from harness.robot.solids import coal_geometry
from harness.robot.srdf.srdf import link_pair
from harness.robot.tree import adjacent_pairs, carriers
from harness.robot.urdf.urdf import Urdf

NEARNESS = 0.001
"""Distance up to which links count as touching [m], since contact at distance 0 is not robust."""


def touching_pairs(urdf: Urdf, positions: Mapping[str, float]) -> tuple[tuple[str, str], ...]:
    """Pairs of links that touch at joint positions, except adjacent and rigidly connected ones.

    Args:
        urdf: The tree of the robot.
        positions: Positions of the driven joints, by name; mimic joints follow.
    """
    import coal  # here: robots with an SRDF do not need it

    request = coal.CollisionRequest()
    request.security_margin = NEARNESS
    poses = urdf_poses(urdf, positions)
    carrier = carriers(urdf.joints, urdf.root)
    neighbours = adjacent_pairs(urdf.links, urdf.joints)
    solids = [
        (link.name, shape, coal_geometry(shape))
        for link in urdf.links
        for shape in collision_shapes(link.collisions)
    ]
    found: dict[tuple[str, str], None] = {}
    for later, (second, shape, solid) in enumerate(solids):
        T_second = coal_transform(poses[second] @ shape.pose)
        for first, other_shape, other in solids[:later]:
            pair = link_pair(first, second)
            if carrier[first] == carrier[second] or pair in neighbours or pair in found:
                continue
            T_first = coal_transform(poses[first] @ other_shape.pose)
            result = coal.CollisionResult()
            coal.collide(other, T_first, solid, T_second, request, result)
            if result.isCollision():
                found[pair] = None
    return tuple(found)


def urdf_poses(urdf: Urdf, positions: Mapping[str, float]) -> dict[str, SE3]:
    """T_root_link of every link at positions of the driven joints; mimic joints follow."""
    every = dict(positions)
    for joint in urdf.joints:
        if joint.mimic is not None:
            driven = positions.get(joint.mimic.joint, 0.0)
            every[joint.name] = joint.mimic.multiplier * driven + joint.mimic.offset
    row = [every.get(joint.name, 0.0) for joint in urdf.joints if joint.is_movable]
    return {urdf.root: SE3.identity(), **LinkPoses(urdf.joints, np.array(row)).at(0)}


def coal_transform(pose: SE3) -> Any:
    """A pose as Coal's transform."""
    import coal

    return coal.Transform3s(np.asarray(pose.rotation), np.asarray(pose.translation))
