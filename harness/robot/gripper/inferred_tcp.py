"""The TCP frame of an arm's integrated gripper."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.core.spatial import SE3
from harness.robot.description import Joint, Link, PlanningGroup
from harness.robot.gripper.inferred_gripper import IntegratedGripper
from harness.robot.srdf.default_pairs import urdf_poses
from harness.robot.srdf.srdf import Srdf, SrdfGroup
from harness.robot.tree import carriers
from harness.robot.urdf.urdf import Urdf

NEAR = 0.03
"""Largest distance of an existing TCP frame from the midpoint between the pads [m]."""


def with_integrated_gripper(
    own: IntegratedGripper,
    urdf: Urdf,
    srdf: Srdf,
    arm: PlanningGroup,
    tip: str,
    tcp_link: str | None,
) -> tuple[Urdf, Srdf, str]:
    """The robot with its gripper coupled, and the link that is its TCP.

    The TCP is `tcp_link`, else a frame of the robot at the midpoint between the pads, else a new
    frame there with the axes of the arm's tip. The arm's chain ends at the TCP.
    """
    srdf = replace(srdf, disabled={**dict.fromkeys(own.pairs, "Gripper"), **srdf.disabled})
    urdf = own.urdf
    carrier = carriers(urdf.joints, urdf.root)
    if tcp_link is not None:
        return urdf, _ending_at(srdf, arm, tip, tcp_link, carrier), tcp_link
    if carrier.get(own.facts.palm_link) != carrier.get(tip):
        return urdf, srdf, tip
    poses = urdf_poses(urdf, {})
    palm = poses[own.facts.palm_link]
    center = palm.apply(own.center)
    frames = {
        link.name: float(np.linalg.norm(poses[link.name].translation - center))
        for link in urdf.links
        if carrier[link.name] == carrier[tip] and link.inertial is None and not link.collisions
    }
    nearest = min(frames, key=lambda name: (frames[name], name), default="")
    if nearest and frames[nearest] <= NEAR:
        return urdf, _ending_at(srdf, arm, tip, nearest, carrier), nearest
    name = f"{own.facts.group}_tcp"
    rotation = palm.rotation.T @ poses[tip].rotation
    axis = np.array([1.0, 0.0, 0.0])
    pose = SE3(rotation, own.center)
    joint = Joint(f"{name}_joint", "fixed", own.facts.palm_link, name, pose, axis)
    added = replace(urdf, links=(*urdf.links, Link(name, None)), joints=(*urdf.joints, joint))
    return added, _ending_at(srdf, arm, tip, name, {**carrier, name: carrier[tip]}), name


def _ending_at(
    srdf: Srdf, arm: PlanningGroup, tip: str, link: str, carrier: dict[str, str]
) -> Srdf:
    """The SRDF with the arm's chains from its tip moved to a link rigidly connected with it."""
    if carrier.get(link) != carrier.get(tip):
        return srdf

    def changed(group: SrdfGroup) -> SrdfGroup:
        chains = tuple((base, link if end == tip else end) for base, end in group.chains)
        return replace(group, chains=chains) if group.name == arm.name else group

    return replace(srdf, groups=tuple(changed(group) for group in srdf.groups))
