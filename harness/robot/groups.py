"""Planning groups: resolves the groups of an SRDF to joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import NoReturn

from harness.core.errors import RobotError
from harness.robot.description import PlanningGroup
from harness.robot.mechanism import Joint
from harness.robot.srdf.srdf import Srdf, SrdfGroup
from harness.robot.tree import joints_to

LEAST_ARM = 3
"""Fewest joints of a group without a chain that has a tip; groups of fewer joints are fingers."""


def planning_groups(srdf: Srdf, joints: Sequence[Joint], source: str) -> dict[str, PlanningGroup]:
    """Every group with its active joints from base to tip.

    Raises:
        SpecError: A group names an unknown joint, link or group; located, for an SRDF from a file.
        RobotError: The same, for an SRDF without a file.
    """
    by_name = {group.name: group for group in srdf.groups}
    return {group.name: _resolve(group, by_name, joints, srdf, source) for group in srdf.groups}


def _resolve(
    group: SrdfGroup,
    groups: Mapping[str, SrdfGroup],
    joints: Sequence[Joint],
    srdf: Srdf,
    source: str,
) -> PlanningGroup:
    virtual = [joint.name for joint in srdf.virtual_joints]
    members = _members(group, groups, joints, virtual, source, ())
    for tool in srdf.end_effectors:
        if tool.parent_group == group.name and tool.group in groups and tool.group != group.name:
            # A tool is not part of the group that carries it, even if that group lists its links.
            members -= _members(groups[tool.group], groups, joints, virtual, source, ())
    active = tuple(
        joint.name
        for joint in joints
        if joint.name in members
        and joint.is_movable
        and joint.mimic is None
        and joint.name not in srdf.passive
    )
    if len(group.chains) == 1:
        base, tip = group.chains[0]
        if set(active) <= {joint.name for joint in joints_to(tip, joints, base)}:
            return PlanningGroup(group.name, active, base, tip)
    inside = [joint for joint in joints if joint.name in members]
    base = inside[0].parent if inside else ""
    tip = _serial_tip(inside) if len(active) >= LEAST_ARM else ""
    return PlanningGroup(group.name, active, base, tip)


def _serial_tip(inside: Sequence[Joint]) -> str:
    """Last link of joints that form a chain; empty when they do not."""
    for before, after in pairwise(inside):
        if after.parent != before.child:
            return ""
    return inside[-1].child if inside else ""


def _members(
    group: SrdfGroup,
    groups: Mapping[str, SrdfGroup],
    joints: Sequence[Joint],
    virtual: Sequence[str],
    source: str,
    seen: tuple[str, ...],
) -> set[str]:
    """Names of all joints of a group, fixed and mimic ones included.

    A virtual joint may be a member: it fixes the robot in the world and never moves.
    """
    by_child = {joint.child: joint for joint in joints}
    names = {joint.name for joint in joints} | set(virtual)
    links = {joint.parent for joint in joints} | set(by_child)
    for joint in group.joints:
        if joint not in names:
            _refuse(group, "joint", joint, f"names the unknown joint '{joint}'", source)
    members = set(group.joints)
    for link in group.links:
        if link in by_child:
            members.add(by_child[link].name)
        elif link not in links:
            _refuse(group, "link", link, f"names the unknown link '{link}'", source)
    for base, tip in group.chains:
        way = joints_to(tip, joints, base)
        if (way[0].parent if way else tip) != base:
            _refuse(group, "chain", "", f"no chain leads from '{base}' to '{tip}'", source)
        members |= {joint.name for joint in way}
    for name in group.subgroups:
        circle = (*seen, group.name)
        if name not in groups:
            _refuse(group, "group", name, f"names the unknown group '{name}'", source)
        if name in circle:
            cycle = " - ".join((*circle[circle.index(name) :], name))
            _refuse(group, "group", name, f"groups contain each other in a circle: {cycle}", source)
        members |= _members(groups[name], groups, joints, virtual, source, (*seen, group.name))
    return members


def _refuse(group: SrdfGroup, tag: str, name: str, message: str, source: str) -> NoReturn:
    if group.element is not None:
        for item in group.element.findall(tag):
            if tag == "chain" or item.get("name") == name:
                item.refuse(f"group '{group.name}': {message}", at="" if tag == "chain" else "name")
    raise RobotError(f"{source}: group '{group.name}': {message}")
