"""Removes the gripper of a bundled arm, so that another one can be mounted."""

from __future__ import annotations

from dataclasses import replace

from harness.core.spatial import SE3
from harness.robot.compose import RobotPart
from harness.robot.mechanism import Link, fixed_joint
from harness.robot.srdf.srdf import Srdf
from harness.robot.tree import carried_by

FLANGE = "flange"


def without_gripper(part: RobotPart) -> RobotPart:
    """The arm without its fingers and TCP, with the flange of its robot.yaml.

    The arm's chain ends at the flange; groups, states and pairs of the gripper are removed. An arm
    without a gripper, or whose robot.yaml has no `flange`, is returned unchanged.
    """
    hand, place = part.facts.gripper, part.facts.flange
    if hand is None or place is None:
        return part
    removed = {link for links in hand.links_by_side.values() for link in links}
    removed = carried_by([*removed, part.facts.tcp_link or ""], part.urdf.joints)
    links = tuple(link for link in part.urdf.links if link.name not in removed)
    joints = tuple(joint for joint in part.urdf.joints if joint.child not in removed)
    held = SE3.from_xyz_rpy(place.xyz, place.rpy)
    flange = fixed_joint(f"{FLANGE}_joint", place.link, FLANGE, held)
    urdf = replace(part.urdf, links=(*links, Link(FLANGE, None)), joints=(*joints, flange))
    facts = part.facts.model_copy(
        update={"gripper": None, "tcp_link": FLANGE, "flange_link": FLANGE, "ik_solver": "auto"}
    )
    srdf = _srdf(part.srdf, hand.group, removed, {joint.name for joint in joints})
    return replace(part, urdf=urdf, srdf=srdf, facts=facts)


def _srdf(srdf: Srdf, hand: str, removed: set[str], joints: set[str]) -> Srdf:
    groups = tuple(
        group.with_links(lambda link: FLANGE if link in removed else link)
        for group in srdf.groups
        if group.name != hand
    )
    return replace(
        srdf,
        groups=groups,
        states=tuple(state for state in srdf.states if state.group != hand),
        end_effectors=tuple(tool for tool in srdf.end_effectors if tool.group != hand),
        passive=tuple(name for name in srdf.passive if name in joints),
        disabled={pair: why for pair, why in srdf.disabled.items() if not removed & set(pair)},
    )
