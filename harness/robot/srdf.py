"""SRDF as plain data: groups, their states, pairs that are not checked."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from harness.core.errors import RobotError
from harness.robot.description import Joint, NamedState, PlanningGroup
from harness.robot.urdf import parse_xml


@dataclass(frozen=True)
class SrdfGroup:
    """What a `<group>` lists: joints, links (their parent joints), chains, other groups."""

    name: str
    joints: tuple[str, ...] = ()
    links: tuple[str, ...] = ()
    chains: tuple[tuple[str, str], ...] = ()
    subgroups: tuple[str, ...] = ()


@dataclass(frozen=True)
class EndEffector:
    """A group that is another group's tool."""

    name: str
    parent_link: str
    group: str
    parent_group: str = ""


@dataclass(frozen=True)
class Srdf:
    """A semantic description.

    Attributes:
        disabled: Link pair (sorted) that is not checked, with the reason.
        passive: Joints that nothing drives.
    """

    groups: tuple[SrdfGroup, ...] = ()
    states: tuple[NamedState, ...] = ()
    end_effectors: tuple[EndEffector, ...] = ()
    passive: tuple[str, ...] = ()
    disabled: Mapping[tuple[str, str], str] = field(default_factory=dict[tuple[str, str], str])


def link_pair(first: str, second: str) -> tuple[str, str]:
    """The unordered pair, sorted."""
    return (first, second) if first <= second else (second, first)


def parse_srdf(text: str, source: str) -> Srdf:
    """Read an SRDF; virtual joints are left to the composition, which fixes the robot in the world.

    Raises:
        RobotError: An element lacks an attribute, or a position is no number.
    """
    root = parse_xml(text, source)
    try:
        return Srdf(
            tuple(_group(item) for item in root.findall("group")),
            tuple(
                NamedState(
                    item.attrib["name"],
                    item.attrib["group"],
                    {j.attrib["name"]: float(j.attrib["value"]) for j in item.findall("joint")},
                )
                for item in root.findall("group_state")
            ),
            tuple(
                EndEffector(
                    item.attrib["name"],
                    item.attrib["parent_link"],
                    item.attrib["group"],
                    item.get("parent_group", ""),
                )
                for item in root.findall("end_effector")
            ),
            tuple(item.attrib["name"] for item in root.findall("passive_joint")),
            {
                link_pair(item.attrib["link1"], item.attrib["link2"]): item.get("reason", "")
                for item in root.findall("disable_collisions")
            },
        )
    except KeyError as error:
        raise RobotError(f"{source}: an element lacks its attribute {error}") from error
    except ValueError as error:
        raise RobotError(f"{source}: a group state's value is no number: {error}") from error


def _group(item: ET.Element) -> SrdfGroup:
    return SrdfGroup(
        item.attrib["name"],
        tuple(joint.attrib["name"] for joint in item.findall("joint")),
        tuple(link.attrib["name"] for link in item.findall("link")),
        tuple((c.attrib["base_link"], c.attrib["tip_link"]) for c in item.findall("chain")),
        tuple(group.attrib["name"] for group in item.findall("group")),
    )


def write_srdf(name: str, srdf: Srdf) -> str:
    """The SRDF as text."""
    root = ET.Element("robot", name=name)
    for group in srdf.groups:
        element = ET.SubElement(root, "group", name=group.name)
        for base, tip in group.chains:
            ET.SubElement(element, "chain", base_link=base, tip_link=tip)
        for tag, names in (
            ("joint", group.joints),
            ("link", group.links),
            ("group", group.subgroups),
        ):
            for item in names:
                ET.SubElement(element, tag, name=item)
    for state in srdf.states:
        element = ET.SubElement(root, "group_state", name=state.name, group=state.group)
        for joint, position in state.positions.items():
            ET.SubElement(element, "joint", name=joint, value=repr(float(position)))
    for tool in srdf.end_effectors:
        words = {"name": tool.name, "parent_link": tool.parent_link, "group": tool.group}
        if tool.parent_group:
            words["parent_group"] = tool.parent_group
        ET.SubElement(root, "end_effector", words)
    for joint in srdf.passive:
        ET.SubElement(root, "passive_joint", name=joint)
    for (first, second), reason in srdf.disabled.items():
        ET.SubElement(root, "disable_collisions", link1=first, link2=second, reason=reason)
    ET.indent(root)
    return '<?xml version="1.0"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def planning_groups(srdf: Srdf, joints: Sequence[Joint], source: str) -> dict[str, PlanningGroup]:
    """Every group with its active joints from base to tip.

    Args:
        srdf: Whose groups.
        joints: Of the whole robot, parents before children.
        source: What messages call the file.

    Raises:
        RobotError: A group names a joint, link or group that is not there.
    """
    by_name = {group.name: group for group in srdf.groups}
    return {
        group.name: _resolve(group, by_name, joints, frozenset(srdf.passive), source)
        for group in srdf.groups
    }


def _resolve(
    group: SrdfGroup,
    groups: Mapping[str, SrdfGroup],
    joints: Sequence[Joint],
    passive: frozenset[str],
    source: str,
) -> PlanningGroup:
    by_child = {joint.child: joint for joint in joints}
    members = _members(group, groups, joints, source, ())
    active = tuple(
        joint.name
        for joint in joints
        if joint.name in members
        and joint.is_movable
        and joint.mimic is None
        and joint.name not in passive
    )
    if len(group.chains) == 1 and not (group.joints or group.links or group.subgroups):
        base, tip = group.chains[0]
        return PlanningGroup(group.name, active, base, tip)
    first = next((joint.parent for joint in by_child.values() if joint.name in members), "")
    return PlanningGroup(group.name, active, first)


def _members(
    group: SrdfGroup,
    groups: Mapping[str, SrdfGroup],
    joints: Sequence[Joint],
    source: str,
    seen: tuple[str, ...],
) -> set[str]:
    """Names of all joints of a group, fixed and mimic ones included."""
    by_child = {joint.child: joint for joint in joints}
    names = {joint.name for joint in joints}
    for joint in group.joints:
        if joint not in names:
            raise RobotError(f"{source}: group '{group.name}' names the unknown joint '{joint}'")
    members = set(group.joints)
    for link in group.links:
        if link in by_child:
            members.add(by_child[link].name)
    for base, tip in group.chains:
        link = tip
        while link != base:
            if link not in by_child:
                raise RobotError(
                    f"{source}: group '{group.name}': no chain leads from '{base}' to '{tip}'"
                )
            members.add(by_child[link].name)
            link = by_child[link].parent
    for name in group.subgroups:
        if name not in groups or name in seen:
            raise RobotError(f"{source}: group '{group.name}' cannot hold the group '{name}'")
        members |= _members(groups[name], groups, joints, source, (*seen, group.name))
    return members
