"""Finds the joints of an arm's own hand: by the SRDF's groups, else by the tree of joints."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from harness.robot.description import PlanningGroup
from harness.robot.srdf.srdf import Srdf, SrdfGroup
from harness.robot.urdf.urdf import Urdf

HAND = "gripper"
"""Name of the group of a hand that no SRDF names."""


def named_hand(
    name: str, srdf: Srdf, groups: Mapping[str, PlanningGroup], arm: PlanningGroup
) -> PlanningGroup | None:
    """The hand that a scenario names by its group or end effector; None for another gripper."""
    tools = {tool.name: tool.group for tool in srdf.end_effectors}
    hand = groups.get(tools.get(name, name))
    if hand is None:
        return None
    own = tuple(each for each in hand.joint_names if each not in arm.joint_names)
    return replace(hand, joint_names=own)


def hand_candidates(
    urdf: Urdf, srdf: Srdf, groups: Mapping[str, PlanningGroup], arm: PlanningGroup
) -> Iterator[tuple[PlanningGroup, Srdf]]:
    """Groups that may be the arm's hand, the likeliest first, each with the SRDF that has it.

    The groups of the arm's end effectors come first, then other groups whose joints the arm
    carries, then the movable joints that the arm carries and no group names: those that others
    mimic, then all, then those of the fingers' first links.
    """
    carried = carried_joints(urdf, arm.joint_names)
    tools = [tool.group for tool in srdf.end_effectors if tool.parent_group in ("", arm.name)]
    others = sorted(groups, key=lambda name: len(groups[name].joint_names))
    named = [
        groups[name]
        for name in dict.fromkeys((*tools, *others))
        if name in groups and groups[name].joint_names
    ]
    named = [hand for hand in named if not set(hand.joint_names) & set(arm.joint_names)]
    yield from (
        (hand, srdf) for hand in named if hand.name in tools or set(hand.joint_names) <= carried
    )
    left = carried - {name for hand in named for name in hand.joint_names} - set(srdf.passive)
    driven = tuple(joint.name for joint in urdf.joints if joint.name in left and not joint.mimic)
    followed = {joint.mimic.joint for joint in urdf.joints if joint.mimic}
    name = next(each for each in (HAND, f"{arm.name}_{HAND}", "hand_") if each not in groups)
    leaders = tuple(joint for joint in driven if joint in followed)
    distal = {name for each in driven for name in carried_joints(urdf, (each,))}
    proximal = tuple(joint for joint in driven if joint not in distal)
    for joints in dict.fromkeys(each for each in (leaders, driven, proximal) if each):
        added = replace(srdf, groups=(*srdf.groups, SrdfGroup(name, joints=joints)))
        yield PlanningGroup(name, joints), added


def carried_joints(urdf: Urdf, arm: Sequence[str]) -> set[str]:
    """Names of the movable joints distal to all of an arm's joints."""
    above: dict[str, frozenset[str]] = {}
    found: set[str] = set()
    for joint in urdf.joints:  # parents before children
        before = above.get(joint.parent, frozenset())
        above[joint.child] = before | ({joint.name} & set(arm))
        if joint.is_movable and joint.name not in arm and before.issuperset(arm):
            found.add(joint.name)
    return found
