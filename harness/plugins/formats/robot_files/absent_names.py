"""What an SRDF says of joints and links that its URDF does not have.

Makers share one SRDF among the variants of a robot, or keep it when they mount another gripper.
MoveIt prints an error for each such name and goes on without it. So do groups here, with a note,
unless it could be a mistake in the group of an arm.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace

from harness.robot.groups import planning_groups
from harness.robot.srdf.srdf import Srdf, SrdfGroup
from harness.robot.urdf.urdf import Urdf

Absent = frozenset[tuple[str, str]]
"""Things that are not there, by kind (`group`, `joint`) and name."""


def without_absent(srdf: Srdf, urdf: Urdf, source: str) -> tuple[Srdf, Absent]:
    """The SRDF without what its groups name and the URDF does not have.

    Groups of which nothing is left go, with their states and end effectors. Nothing goes where the
    group of an arm would lose a member, or no arm would be left.

    Args:
        srdf: The SRDF as it was read.
        urdf: The URDF, with all joints and links that there are.
        source: Name of the file in messages.

    Returns:
        The SRDF with a note on each such group, and the groups and joints that went.

    Raises:
        SpecError: A group names an unknown group, or a chain does not lead from its base to its
            tip.
    """
    joints = {joint.name for joint in urdf.joints} | {joint.name for joint in srdf.virtual_joints}
    links = {link.name for link in urdf.links}
    absent = {group.name: _absent(group, joints, links) for group in srdf.groups}
    if not any(absent.values()):
        return srdf, frozenset()
    empty_before = {group.name for group in srdf.groups if _is_empty(group)}
    kept, gone = srdf.groups, set[str]()
    while True:
        parts = [_part(group, joints, links, gone) for group in kept]
        empty = {part.name for part in parts if _is_empty(part)} - empty_before
        kept = tuple(part for part in parts if part.name not in empty)
        if not empty:
            break
        gone |= empty
    resolved = planning_groups(replace(srdf, groups=kept), urdf.joints, source)
    arms = [name for name, group in resolved.items() if group.tip_link]
    if not arms or any(absent[name] for name in arms):
        return srdf, frozenset()
    lost = {name for group in srdf.groups for name in group.joints} - joints
    srdf = replace(
        srdf,
        groups=kept,
        states=tuple(
            replace(state, positions={n: p for n, p in state.positions.items() if n not in lost})
            for state in srdf.states
            if state.group not in gone
        ),
        end_effectors=tuple(
            tool for tool in srdf.end_effectors if not gone & {tool.group, tool.parent_group}
        ),
        passive=tuple(joint for joint in srdf.passive if joint not in lost),
        notes=(*srdf.notes, *_notes(absent, gone)),
    )
    went = [*(("group", name) for name in gone), *(("joint", name) for name in lost)]
    return srdf, frozenset(went)


def _absent(group: SrdfGroup, joints: Collection[str], links: Collection[str]) -> list[str]:
    """The joints and links that a group names and that are not there."""
    ends = [link for chain in group.chains for link in chain]
    return [
        *(joint for joint in group.joints if joint not in joints),
        *dict.fromkeys(link for link in (*group.links, *ends) if link not in links),
    ]


def _part(
    group: SrdfGroup, joints: Collection[str], links: Collection[str], gone: Collection[str]
) -> SrdfGroup:
    """The part of a group that is there."""
    return replace(
        group,
        joints=tuple(joint for joint in group.joints if joint in joints),
        links=tuple(link for link in group.links if link in links),
        chains=tuple(chain for chain in group.chains if all(link in links for link in chain)),
        subgroups=tuple(name for name in group.subgroups if name not in gone),
    )


def _is_empty(group: SrdfGroup) -> bool:
    return not (group.joints or group.links or group.chains or group.subgroups)


def _notes(absent: Mapping[str, Sequence[str]], gone: Collection[str]) -> Iterator[str]:
    for name, names in absent.items():
        if name in gone:
            yield f"SRDF: group '{name}' is left out: the URDF has nothing of it"
        elif names:
            yield (
                f"SRDF: group '{name}' names what the URDF does not have, ignored:"
                f" {', '.join(names)}"
            )
