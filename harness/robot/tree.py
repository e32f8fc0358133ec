"""The tree of links and joints: order and rigid groups."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from itertools import combinations, count

from harness.core.errors import Problem, RobotError, SpecError
from harness.language.files.xml_file import XmlElement
from harness.robot.description import RobotDescription
from harness.robot.mechanism import Joint, Link
from harness.robot.srdf.srdf import link_pair

Elements = Mapping[tuple[str, str], XmlElement]
"""Elements of links and joints, by kind (`link`, `joint`) and name."""


def in_tree_order(
    links: Iterable[Link], joints: Sequence[Joint], source: str, elements: Elements | None = None
) -> tuple[tuple[Link, ...], tuple[Joint, ...]]:
    """Links from the root outwards, joints in the order of their child links.

    Raises:
        SpecError: They are not one tree; at the element of the joint or link.
        RobotError: The same, without an element.
    """
    by_name = {link.name: link for link in links}
    children: dict[str, list[Joint]] = {name: [] for name in by_name}
    parents: dict[str, str] = {}

    def refuse(kind: str, name: str, message: str, hint: str = "") -> None:
        element = (elements or {}).get((kind, name))
        if element is not None:
            element.refuse(message, hint)
        raise RobotError(f"{source}: {message}")

    for joint in joints:
        for name in (joint.parent, joint.child):
            if name not in by_name:
                message = f"joint '{joint.name}' names the unknown link '{name}'"
                refuse("joint", joint.name, message)
        if joint.child in parents:
            refuse("joint", joint.name, f"link '{joint.child}' is the child of two joints")
        parents[joint.child] = joint.parent
        children[joint.parent].append(joint)
    roots = [name for name in by_name if name not in parents]
    if not roots:
        if not by_name:
            raise SpecError([Problem(source, 0, 0, "a robot has one root link, found none")])
        circle = _circle(next(iter(by_name)), parents)
        refuse("link", circle[0], f"joints run in a circle: {' - '.join((*circle, circle[0]))}")
    if len(roots) > 1:
        refuse("link", roots[1], f"a robot has one root link, found {', '.join(roots)}")
    ordered_links, ordered_joints = [by_name[roots[0]]], list[Joint]()
    stack = children[roots[0]][::-1]
    while stack:
        joint = stack.pop()
        ordered_joints.append(joint)
        ordered_links.append(by_name[joint.child])
        stack.extend(children[joint.child][::-1])
    if len(ordered_links) != len(by_name):
        known = {link.name for link in ordered_links}
        circle = _circle(next(name for name in by_name if name not in known), parents)
        refuse("link", circle[0], f"joints run in a circle: {' - '.join((*circle, circle[0]))}")
    return tuple(ordered_links), tuple(ordered_joints)


def free_name(first: str, taken: Container[str]) -> str:
    """A name, with a number after it if it is taken."""
    if first not in taken:
        return first
    return next(name for n in count(2) if (name := f"{first}_{n}") not in taken)


def _circle(start: str, parents: Mapping[str, str]) -> list[str]:
    """The links of the cycle among a link's ancestors, from parent to child."""
    seen: list[str] = []
    link = start
    while link not in seen:
        seen.append(link)
        link = parents[link]
    return seen[seen.index(link) :][::-1]


def joints_to(link: str, joints: Iterable[Joint], base: str = "") -> list[Joint]:
    """The joints that carry a link, from a base, or else the root, to the link."""
    before = {joint.child: joint for joint in joints}
    found: list[Joint] = []
    while link != base and link in before:
        found.append(before[link])
        link = before[link].parent
    return found[::-1]


def carriers(joints: Iterable[Joint], root: str) -> dict[str, str]:
    """For each link, the first link of its rigid group."""
    carrier = {root: root}
    for joint in joints:
        carrier[joint.child] = joint.child if joint.is_movable else carrier[joint.parent]
    return carrier


def carried_by(links: Iterable[str], joints: Iterable[Joint]) -> set[str]:
    """Some links, and all links that they carry; parents stand before children in `joints`."""
    found = {*links}
    for joint in joints:
        if joint.parent in found:
            found.add(joint.child)
    return found


def is_rigid(robot: RobotDescription, first: str, second: str) -> bool:
    """Whether no movable joint is between two links (or a link and `world`)."""
    carrier = carriers(robot.joints, "world")
    return carrier[first] == carrier[second]


def excluded_contacts(robot: RobotDescription) -> frozenset[frozenset[str]]:
    """Pairs of links whose contact the physics leaves out.

    Those are the pairs that the SRDF allows, links that a joint connects, and links that cannot
    move against each other.
    """
    carrier = carriers(robot.joints, "world")
    across = {
        frozenset((carrier[joint.parent], carrier[joint.child])) for joint in robot.movable_joints
    }
    return frozenset(
        frozenset(pair)
        for pair in combinations(robot.link_names, 2)
        if tuple(sorted(pair)) in robot.allowed_collisions
        or len(groups := frozenset(carrier[name] for name in pair)) == 1
        or groups in across
    )


def adjacent_pairs(links: Iterable[Link], joints: Iterable[Joint]) -> dict[tuple[str, str], None]:
    """Every link with shapes, with its nearest ancestor that has shapes, in link order."""
    shaped = dict.fromkeys(link.name for link in links if link.collisions)
    before = {joint.child: joint.parent for joint in joints}
    found: dict[tuple[str, str], None] = {}
    for name in shaped:
        parent = before.get(name)
        while parent is not None and parent not in shaped:
            parent = before.get(parent)
        if parent is not None:
            found[link_pair(name, parent)] = None
    return found
