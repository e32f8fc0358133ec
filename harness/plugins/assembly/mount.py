"""Puts an arm on a pedestal and on rails, which are joints of its group."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from harness.core.errors import RobotOptionError
from harness.core.geometry import Box, Shape
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.plugins.assembly.keys.mount import MountSpec, RailSpec
from harness.robot.description import RobotDescription
from harness.robot.groups import planning_groups
from harness.robot.mechanism import WORLD, Inertial, Joint, Link, fixed_joint
from harness.robot.srdf.srdf import link_pair, parse_srdf, write_srdf
from harness.robot.tree import in_tree_order
from harness.robot.urdf.write import write_urdf

BEAM = (0.12, 0.05)  # [m], width and thickness of a rail, whose upper side carries the next one
CARRIAGE = Inertial(5.0, np.zeros(3), np.diag([0.02, 0.02, 0.02]))
"""What moves on a rail that carries another one."""

LEVEL = 0.9  # share of an axis along z from which a rail counts as upright
GRAY = (0.35, 0.37, 0.40, 1.0)


def mounted(description: RobotDescription, mount: MountSpec) -> RobotDescription:
    """The robot on its pedestal and rails.

    Args:
        description: The composed robot, whose first joint fixes its base in the world.
        mount: The pedestal and the rails.

    Raises:
        RobotOptionError: A name is taken, or there is no arm that a rail could carry.
    """
    held, *others = description.joints
    taken = {*description.joint_by_name, *description.link_names}
    names = [rail.name for rail in mount.rails]
    for name in names:
        if name in taken or names.count(name) > 1:
            whose = (
                f"the robot has something called '{name}'"
                if name in taken
                else (f"{names.count(name)} rails are called '{name}'")
            )
            raise RobotOptionError("mount", f"{whose}: give each rail a `name` of its own")
    if names and not description.arm_group:
        raise RobotOptionError("mount", "a rail carries an arm, and this robot has none")
    links: list[Link] = []
    joints: list[Joint] = []
    below = held  # leads to what comes next
    if mount.pedestal is not None:
        height = mount.pedestal[2]
        box = Shape(Box(mount.pedestal), SE3.from_xyz_rpy((0, 0, height / 2)), GRAY)
        links.append(Link("pedestal", None, (box,), (box,)))
        joints.append(replace(below, child="pedestal"))
        below = fixed_joint("pedestal_joint", "pedestal", "", SE3.from_xyz_rpy((0, 0, height)))
    for rail in mount.rails:
        beam = f"{rail.name}_beam"
        stands = below.kind == "fixed"
        links.append(Link(beam, None if stands else CARRIAGE, *_shapes(rail)))
        joints.append(replace(below, child=beam))
        below = _joint(rail, beam)
    joints.append(replace(below, child=held.child))
    tree_links, tree_joints = in_tree_order(
        [*description.links, *links], [*joints, *others], description.name
    )
    return _described(description, tree_links, tree_joints, names)


def _joint(rail: RailSpec, beam: str) -> Joint:
    """The prismatic joint of a rail; its child is what comes next."""
    return Joint(
        rail.name,
        "prismatic",
        beam,
        "",
        SE3.identity(),
        np.array(rail.direction),
        lower=rail.range[0],
        upper=rail.range[1],
        velocity=rail.max_velocity,
        acceleration=rail.max_acceleration,
        effort=rail.max_effort,
        effort_source="the scenario's `mount`",
    )


def _shapes(rail: RailSpec) -> tuple[tuple[Shape, ...], tuple[Shape, ...]]:
    """A beam along the rail, below what it carries: for pictures, and nothing that touches."""
    width, thickness = BEAM
    axis = np.array(rail.direction)
    side = np.array([0.0, 0.0, 1.0]) if abs(axis[2]) < LEVEL else np.array([1.0, 0.0, 0.0])
    up = side - axis * float(axis @ side)
    up /= np.linalg.norm(up)
    turn: FloatArray = np.column_stack([axis, np.cross(up, axis), up])
    lower, upper = rail.range
    middle = axis * (lower + upper) / 2 - up * thickness / 2
    size = (upper - lower + width, width, thickness)
    return (Shape(Box(size), SE3(turn, middle), GRAY),), ()


def _below(link: str, joints: Sequence[Joint]) -> list[str]:
    """The links that carry a link, without the world."""
    parents = {joint.child: joint.parent for joint in joints}
    found: list[str] = []
    while (link := parents[link]) != WORLD:
        found.append(link)
    return found


def _fixed_to(link: str, joints: Sequence[Joint]) -> list[str]:
    """The links that never move relative to a link that carries them; parents come first."""
    found = [link]
    for joint in joints:
        if joint.kind == "fixed" and joint.parent in found:
            found.append(joint.child)
    return found


def _described(
    description: RobotDescription,
    links: tuple[Link, ...],
    joints: tuple[Joint, ...],
    rails: list[str],
) -> RobotDescription:
    """The description of the tree with the mount; the rails are the first joints of the arm."""
    srdf = parse_srdf(description.srdf, description.name)
    groups = tuple(
        replace(group, joints=(*rails, *group.joints))
        if group.name == description.arm_group
        else group
        for group in srdf.groups
    )
    allowed = dict(description.allowed_collisions)
    below, base = _below(description.base_link, joints), _fixed_to(description.base_link, joints)
    for first, second in product(below, base):  # the base slides on what carries it
        allowed.setdefault(link_pair(first, second), "Adjacent")
    srdf = replace(srdf, groups=groups, disabled=allowed)
    start = {
        joint.name: min(max(0.0, joint.lower), joint.upper)
        for joint in joints
        if joint.name in rails
    }
    return replace(
        description,
        urdf=write_urdf(description.name, links, joints),
        srdf=write_srdf(description.name, srdf),
        links=links,
        joints=joints,
        groups=planning_groups(srdf, joints, description.name),
        allowed_collisions=allowed,
        start_state=start | dict(description.start_state),
        ik_solver="numeric" if rails else description.ik_solver,
    )
