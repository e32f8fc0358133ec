"""The TCP frame of an imported arm: its maker's, else one between the pads of its gripper."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from harness.core.spatial import SE3
from harness.plugins.formats.robot_files.inferred_gripper import IntegratedGripper
from harness.plugins.formats.touching_links import urdf_poses
from harness.robot.description import PlanningGroup
from harness.robot.mechanism import Link, fixed_joint
from harness.robot.srdf.srdf import Srdf
from harness.robot.tree import carriers
from harness.robot.urdf.urdf import Urdf

TCP_NAMES = re.compile(r"tcp|grasp|pinch|grip_site|tool_?cent", re.IGNORECASE)
TOOL_NAMES = re.compile(r"(?<![a-z])ee(?![a-z])|end_?effector|gripper_frame", re.IGNORECASE)

FARTHEST = (0.1, 0.08, 0.03)
"""Largest distances between the pads' midpoint and a frame, by rank [m]: a link named as a TCP, or
stated by the SRDF as a chain's tip or an end effector's parent; a tool frame; any other frame."""


def with_integrated_gripper(
    own: IntegratedGripper, arm: PlanningGroup, tip: str, tcp_link: str | None, notes: list[str]
) -> tuple[Urdf, Srdf, str]:
    """The robot with its gripper coupled, and the link that is its TCP.

    The TCP is `tcp_link`, else a frame of the robot at the pads, else a new frame at the midpoint
    between the pads with the axes of the arm's tip. The arm's chain ends at the TCP.
    """
    urdf = own.urdf
    srdf = replace(own.srdf, disabled={**dict.fromkeys(own.pairs, "Gripper"), **own.srdf.disabled})
    notes += own.notes
    carrier = carriers(urdf.joints, urdf.root)
    if tcp_link is not None:
        return urdf, _ending_at(srdf, arm, tip, tcp_link, carrier), tcp_link
    if carrier.get(own.facts.palm_link) != carrier.get(tip):
        notes.append(
            f"TCP: '{tip}', which moves relative to the gripper's palm '{own.facts.palm_link}':"
            " a `pick` requires a group that ends at the palm"
        )
        return urdf, srdf, tip
    poses = urdf_poses(urdf, {})
    palm = poses[own.facts.palm_link]
    center = palm.apply(own.center)
    palms = (palm.apply(own.body), palm.translation, palm.translation)
    ranked = sorted(
        (rank, float(np.linalg.norm(poses[frame].translation - center)), frame)
        for rank, frame in _frames(urdf, srdf, arm, tip)
        if _is_at_the_pads(poses[frame].translation, palms[rank], center, FARTHEST[rank])
    )
    if ranked:
        _, distance, frame = ranked[0]
        notes.append(f"TCP: '{frame}', {1000 * distance:.0f} mm from the middle between the pads")
        return urdf, _ending_at(srdf, arm, tip, frame, carrier), frame
    name = f"{own.facts.group}_tcp"
    rotation = palm.rotation.T @ poses[tip].rotation
    pose = SE3(rotation, own.center)
    joint = fixed_joint(f"{name}_joint", own.facts.palm_link, name, pose)
    added = replace(urdf, links=(*urdf.links, Link(name, None)), joints=(*urdf.joints, joint))
    away = 1000 * float(np.linalg.norm(center - poses[tip].translation))
    notes.append(
        f"TCP: no frame is between the pads; '{name}' is added there, {away:.0f} mm from '{tip}'"
    )
    return added, _ending_at(srdf, arm, tip, name, {**carrier, name: carrier[tip]}), name


def tcp_without_gripper(urdf: Urdf, srdf: Srdf, arm: PlanningGroup, tip: str) -> str:
    """The TCP of an arm without a gripper.

    It is the tip of a chain that the SRDF states, as in MoveIt; else a frame that is rigidly
    connected with the arm's last link and is named as a TCP or an end effector's parent.
    """
    if _states_chain(srdf, arm):
        return tip
    return next((frame for rank, frame in _frames(urdf, srdf, arm, tip) if rank == 0), tip)


def _states_chain(srdf: Srdf, arm: PlanningGroup) -> bool:
    """Whether the file of an SRDF has a chain of the arm."""
    stated = any(group.name == arm.name and group.chains for group in srdf.groups)
    return stated and srdf.root_element is not None


def _frames(urdf: Urdf, srdf: Srdf, arm: PlanningGroup, tip: str) -> Iterator[tuple[int, str]]:
    """Links that may be the TCP, rigidly connected with the arm's tip, and their ranks.

    Those that the SRDF states may have shapes, and those named as frames a visible marker.
    """
    carrier = carriers(urdf.joints, urdf.root)
    parents = {
        tool.parent_link
        for tool in srdf.end_effectors
        if arm.name in (tool.parent_group, tool.group) or not tool.parent_group
    }
    stated = parents | ({tip} if _states_chain(srdf, arm) else set())
    for link in urdf.links:
        if carrier[link.name] != carrier.get(tip):
            continue
        if link.name in stated:
            yield 0, link.name
        elif link.collisions:
            continue
        elif TCP_NAMES.search(link.name):
            yield 0, link.name
        elif TOOL_NAMES.search(link.name):
            yield 1, link.name
        elif not link.visuals and link.inertial is None:
            yield 2, link.name


def _is_at_the_pads(
    frame: np.ndarray, palm: np.ndarray, center: np.ndarray, farthest: float
) -> bool:
    """Whether a frame is near the pads' midpoint, and nearer to it than to the palm."""
    away = float(np.linalg.norm(frame - center))
    return away <= farthest and away < float(np.linalg.norm(frame - palm))


def _ending_at(
    srdf: Srdf, arm: PlanningGroup, tip: str, link: str, carrier: dict[str, str]
) -> Srdf:
    """The SRDF with the arm's chains from its tip moved to a link rigidly connected with it."""
    if carrier.get(link) != carrier.get(tip):
        return srdf

    def moved(end: str) -> str:
        return link if end == tip else end

    groups = (each.with_links(moved) if each.name == arm.name else each for each in srdf.groups)
    return replace(srdf, groups=tuple(groups))
