"""Finds names in robot.yaml and SRDF that the robot does not have."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from harness.core.suggestion import did_you_mean
from harness.language.files.source import Loc
from harness.robot.robot_yaml import RobotYaml
from harness.robot.srdf.srdf import Srdf
from harness.robot.urdf.urdf import Urdf

Unknown = tuple[Loc, str]
"""Key in robot.yaml, and the mistake there."""


def unknown_names(facts: RobotYaml, urdf: Urdf, srdf: Srdf) -> Iterator[Unknown]:
    """Every unknown group, joint and link in a robot.yaml."""
    groups = [group.name for group in srdf.groups]
    links = [link.name for link in urdf.links]
    joints = [joint.name for joint in urdf.joints]
    yield from _unknown(("arm_group",), facts.arm_group, groups, "group", "SRDF")
    if facts.kind == "arm":
        yield from _unknown(("tcp_link",), facts.tcp_link, links, "link", "URDF")
        yield from _unknown(("flange_link",), facts.flange_link, links, "link", "URDF")
    if facts.flange is not None:
        yield from _unknown(("flange", "link"), facts.flange.link, links, "link", "URDF")
    for name in facts.collision:
        yield from _unknown(("collision", name), name, links, "link", "URDF")
    for name in facts.joints:
        yield from _unknown(("joints", name), name, joints, "joint", "URDF")
    movable = [joint.name for joint in urdf.joints if joint.is_movable]
    for name in facts.start_state.joints or {}:
        yield from _unknown(("start_state", "joints", name), name, movable, "movable joint", "URDF")
    hand = facts.gripper
    if hand is None:
        return
    yield from _unknown(("gripper", "group"), hand.group, groups, "group", "SRDF")
    yield from _unknown(("gripper", "joint"), hand.joint, movable, "movable joint", "URDF")
    yield from _unknown(("gripper", "palm_link"), hand.palm_link, links, "link", "URDF")
    for cup, facts_of_cup in (hand.cups or {}).items():
        yield from _unknown(
            ("gripper", "cups", cup, "link"), facts_of_cup.link, links, "link", "URDF"
        )
    for side, finger in (hand.sides or {}).items():
        key = ("gripper", "sides", side)
        for index, link in enumerate(finger.links):
            yield from _unknown((*key, "links", index), link, links, "link", "URDF")
        yield from _unknown((*key, "pad"), finger.pad, finger.links, "link", "side")


def _unknown(
    key: Loc, name: str | None, known: Collection[str], what: str, where: str
) -> Iterator[Unknown]:
    if name is not None and name not in known:
        hint = did_you_mean(name, sorted(known), f"{what}s")
        yield key, f"the {where} has no {what} '{name}'; {hint}"


def refuse_incomplete_states(srdf: Srdf, urdf: Urdf, facts: RobotYaml) -> None:
    """Refuse named states with unknown joints, or without the joint of the gripper.

    Raises:
        SpecError: At the state's place in the SRDF.
    """
    joints = {joint.name for joint in urdf.joints}
    joints |= {joint.name for joint in srdf.virtual_joints}
    hand, root = facts.gripper, srdf.root_element
    for item in root.findall("group_state") if root is not None else ():
        named = {joint.get("name"): joint for joint in item.findall("joint")}
        for name, element in named.items():
            if name not in joints:
                state = item.get("name")
                element.refuse(f"state '{state}': the URDF has no joint '{name}'", at="name")
        if hand is not None and item.get("group") == hand.group and hand.joint not in named:
            item.refuse(
                f"state '{item.get('name')}' of the gripper does not place '{hand.joint}'",
                f'add <joint name="{hand.joint}" value="..."/>',
            )
