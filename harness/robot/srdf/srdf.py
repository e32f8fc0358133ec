"""SRDF as plain data: groups, states, disabled collision pairs."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from harness.language.files.xml_file import XmlElement, parse_xml
from harness.robot.description import ALL_ARMS, NamedState
from harness.robot.urdf.values import bounded_value

READ = frozenset(
    {"group", "group_state", "end_effector", "passive_joint", "virtual_joint", "disable_collisions"}
)
VIRTUAL = {"name": "virtual_joint", "type": "fixed", "parent_frame": "world", "child_link": ""}


@dataclass(frozen=True)
class SrdfGroup:
    """A `<group>`: joints, links (for their parent joints), chains, other groups."""

    name: str
    joints: tuple[str, ...] = ()
    links: tuple[str, ...] = ()
    chains: tuple[tuple[str, str], ...] = ()
    subgroups: tuple[str, ...] = ()
    element: XmlElement | None = field(default=None, compare=False, repr=False)

    def with_links(self, name: Callable[[str], str]) -> SrdfGroup:
        """The group with other names for the ends of its chains."""
        return replace(self, chains=tuple((name(base), name(tip)) for base, tip in self.chains))


@dataclass(frozen=True)
class EndEffector:
    """A group that is another group's tool."""

    name: str
    parent_link: str
    group: str
    parent_group: str = ""


@dataclass(frozen=True)
class VirtualJoint:
    """The connection of the robot's root with the world."""

    name: str
    kind: str
    parent_frame: str
    child_link: str


@dataclass(frozen=True)
class Srdf:
    """A semantic description.

    Attributes:
        disabled: Link pairs (sorted) that are not checked, with the reason.
    """

    groups: tuple[SrdfGroup, ...] = ()
    states: tuple[NamedState, ...] = ()
    end_effectors: tuple[EndEffector, ...] = ()
    passive: tuple[str, ...] = ()
    disabled: Mapping[tuple[str, str], str] = field(default_factory=dict[tuple[str, str], str])
    virtual_joints: tuple[VirtualJoint, ...] = ()
    notes: tuple[str, ...] = field(default=(), compare=False)
    root_element: XmlElement | None = field(default=None, compare=False, repr=False)

    def has_gripper(self, name: str) -> bool:
        """Whether a scenario's `gripper` is a group or an end effector of the robot itself."""
        return name in {each.name for each in (*self.groups, *self.end_effectors)}

    def with_group_of_all(self, arms: Sequence[str]) -> Srdf:
        """The SRDF with a group of all arms, and the states that each of them has."""
        if ALL_ARMS in {group.name for group in self.groups}:
            return self
        states = {(state.group, state.name): state.positions for state in self.states}
        shared = tuple(
            NamedState(name, ALL_ARMS, {k: v for arm in arms for k, v in states[arm, name].items()})
            for group, name in states
            if group == arms[0] and all((arm, name) in states for arm in arms)
        )
        group = SrdfGroup(ALL_ARMS, subgroups=tuple(arms))
        return replace(self, groups=(*self.groups, group), states=(*self.states, *shared))


def link_pair(first: str, second: str) -> tuple[str, str]:
    """The unordered pair, sorted."""
    return (first, second) if first <= second else (second, first)


def parse_srdf(document: str | bytes | XmlElement, source: str) -> Srdf:
    """Read an SRDF.

    Raises:
        SpecError: It is not an SRDF, an element lacks an attribute, or a position is not a
            number; at line and column.
    """
    root = document if isinstance(document, XmlElement) else parse_xml(document, source)
    if root.tag != "robot":
        root.refuse(f"the root element is <{root.tag}>, an SRDF's is <robot>")
    link = root.find("link")
    if link is not None:
        link.refuse(
            "this is a URDF",
            "its groups, states and allowed pairs are in an SRDF; a URDF is named by `urdf`",
        )
    ignored = Counter(child.tag for child in root.children if child.tag not in READ)
    notes = [
        f"SRDF: {count} <{tag}> element{'s' if count > 1 else ''} ignored"
        for tag, count in sorted(ignored.items())
    ]
    groups = {item.get("name") for item in root.findall("group")}
    lost = sorted({item.need("group") for item in root.findall("end_effector")} - groups)
    notes += [f"SRDF: end effector left out: there is no group '{group}'" for group in lost]
    return Srdf(
        tuple(_group(item) for item in root.findall("group")),
        tuple(
            NamedState(
                item.name(),
                item.get("group"),
                {
                    joint.need("name"): bounded_value(joint)
                    for joint in item.findall("joint")
                    if not has_several_values(joint)
                },
            )
            for item in root.findall("group_state")
        ),
        tuple(
            EndEffector(
                _optional(item, "name", item.need("group"), notes),
                item.need("parent_link"),
                item.need("group"),
                item.get("parent_group"),
            )
            for item in root.findall("end_effector")
            if item.get("group") in groups
        ),
        tuple(item.need("name") for item in root.walk() if item.tag == "passive_joint"),
        {
            link_pair(item.need("link1"), item.need("link2")): item.get("reason")
            for item in root.findall("disable_collisions")
        },
        tuple(
            VirtualJoint(*(_optional(item, *each, notes) for each in VIRTUAL.items()))
            for item in root.findall("virtual_joint")
        ),
        tuple(notes),
        root,
    )


def _optional(item: XmlElement, key: str, default: str, notes: list[str]) -> str:
    """An attribute that nothing depends on; adds a note where it is missing."""
    if key not in item.attributes:
        line = item.place.line
        notes.append(f"SRDF: <{item.tag}> in line {line} has no '{key}': '{default}' is assumed")
    return item.get(key, default)


def has_several_values(joint: XmlElement) -> bool:
    """Whether a state has a joint of several axes, such as a floating or planar one."""
    return len(joint.need("value").split()) > 1


def _group(item: XmlElement) -> SrdfGroup:
    return SrdfGroup(
        item.name(),
        tuple(joint.need("name") for joint in item.findall("joint")),
        tuple(link.need("name") for link in item.findall("link")),
        tuple((c.need("base_link"), c.need("tip_link")) for c in item.findall("chain")),
        tuple(group.need("name") for group in item.findall("group")),
        item,
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
    for joint in srdf.virtual_joints:
        words = {"name": joint.name, "type": joint.kind}
        words |= {"parent_frame": joint.parent_frame, "child_link": joint.child_link}
        ET.SubElement(root, "virtual_joint", words)
    for joint in srdf.passive:
        ET.SubElement(root, "passive_joint", name=joint)
    for (first, second), reason in srdf.disabled.items():
        ET.SubElement(root, "disable_collisions", link1=first, link2=second, reason=reason)
    ET.indent(root)
    return '<?xml version="1.0"?>\n' + ET.tostring(root, encoding="unicode") + "\n"
