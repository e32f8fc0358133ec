"""Finds the joints of an arm's own hand: by the SRDF's groups, else by the tree of joints."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from harness.robot.description import PlanningGroup
from harness.robot.srdf.srdf import Srdf, SrdfGroup
from harness.robot.urdf.urdf import Urdf

HAND = "gripper"  # Name of the group of a hand that no SRDF names


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

    The groups of the arm's end effectors come first, then other groups whose joints hang on a link
    of the arm, from the last link on, then the movable joints that no group names on its last link,
    or the last one with shapes: those that others mimic, then all, then those of the fingers' first
    links.
    """
    links, joints = _places(urdf, arm.joint_names)
    tools = [tool.group for tool in srdf.end_effectors if tool.parent_group in ("", arm.name)]
    others = sorted(groups, key=lambda name: len(groups[name].joint_names))
    named = [
        groups[name]
        for name in dict.fromkeys((*tools, *others))
        if name in groups and groups[name].joint_names
    ]
    named = [hand for hand in named if not set(hand.joint_names) & set(arm.joint_names)]

    def count(hand: PlanningGroup) -> int:
        return min(joints[name].count for name in hand.joint_names)

    def is_on_arm(hand: PlanningGroup) -> bool:
        own = set(hand.joint_names)
        return count(hand) == len(arm.joint_names) or all(
            joints[name].count and joints[name].others <= own for name in own
        )

    yield from ((hand, srdf) for hand in named if hand.name in tools)
    for hand in sorted(named, key=count, reverse=True):
        if hand.name not in tools and is_on_arm(hand):
            yield hand, srdf
    solid = (links[link.name] for link in urdf.links if link.collisions and link.name in links)
    last = max((place.count for place in solid if not place.others), default=1)
    most = max((place.count for place in joints.values()), default=0)
    carried = {name for name, place in joints.items() if place.count == most >= last}
    left = carried - {name for hand in named for name in hand.joint_names} - set(srdf.passive)
    driven = tuple(joint.name for joint in urdf.joints if joint.name in left and not joint.mimic)
    followed = {joint.mimic.joint for joint in urdf.joints if joint.mimic}
    name = next(each for each in (HAND, f"{arm.name}_{HAND}", "hand_") if each not in groups)
    leaders = tuple(joint for joint in driven if joint in followed)
    distal = {
        name for each in driven for name, place in _places(urdf, (each,))[1].items() if place.count
    }
    proximal = tuple(joint for joint in driven if joint not in distal)
    for names in dict.fromkeys(each for each in (leaders, driven, proximal) if each):
        added = replace(srdf, groups=(*srdf.groups, SrdfGroup(name, joints=names)))
        yield PlanningGroup(name, names), added


@dataclass(frozen=True)
class _Place:
    """Where a joint or link is.

    Attributes:
        count: Number of the arm's joints before it.
        others: Driven joints between the last of these and it.
    """

    count: int = 0
    others: frozenset[str] = frozenset()


def _places(urdf: Urdf, arm: Sequence[str]) -> tuple[dict[str, _Place], dict[str, _Place]]:
    """The places of links, and those of movable joints that are not the arm's."""
    links, joints = dict[str, _Place](), dict[str, _Place]()
    for joint in urdf.joints:  # parents before children
        place = links.get(joint.parent, _Place())
        if joint.name in arm:
            place = _Place(place.count + 1)
        elif joint.is_movable:
            joints[joint.name] = place
            if joint.mimic is None:
                place = replace(place, others=place.others | {joint.name})
        links[joint.child] = place
    return links, joints
