"""Composes arm, gripper and base pose into one robot that is fixed in the world."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from harness.core.camera import Camera
from harness.core.errors import RobotError
from harness.core.registry import absent_plugins, registry
from harness.core.spatial import SE3
from harness.core.suggestion import did_you_mean
from harness.core.wrench_sensor import WrenchSensor
from harness.robot.description import Arm, NamedState, RobotDescription, TrackingTolerances
from harness.robot.end_effector import Cup, Gripper
from harness.robot.groups import planning_groups
from harness.robot.mechanism import WORLD, Joint, Link, fixed_joint
from harness.robot.robot_yaml import GripperFacts, Mount, RobotYaml
from harness.robot.srdf.srdf import EndEffector, Srdf, write_srdf
from harness.robot.tree import adjacent_pairs, free_name, in_tree_order
from harness.robot.urdf.urdf import Urdf
from harness.robot.urdf.write import write_urdf
from harness.robot.wrench_sensors import flaw


@dataclass(frozen=True, eq=False)
class RobotPart:
    """The content of one robot folder: an arm or a gripper.

    Attributes:
        name: Its name in the scenario (the variant, if it has variants).
        srdf: The groups of the gripper.
        arms: The arms of a robot with several; the facts are those of the first.
        default_arm: The arm that the scenario states; empty where it states none.
    """

    name: str
    facts: RobotYaml
    urdf: Urdf
    srdf: Srdf
    source: str
    notes: tuple[str, ...] = ()
    rejected_grippers: tuple[str, ...] = ()
    arms: tuple[PartArm, ...] = ()
    default_arm: str = ""
    wrench_sensors: Mapping[str, WrenchSensor] = field(default_factory=dict[str, WrenchSensor])


@dataclass(frozen=True, eq=False)
class PartArm:
    """One of several arms of a part.

    Attributes:
        base_link: The first link of the arm.
        gripper: What is known of its gripper; None for an arm without one.
    """

    group: str
    tcp_link: str
    base_link: str
    gripper: GripperFacts | None


def compose_robot(arm: RobotPart | None, gripper: RobotPart | None, base: SE3) -> RobotDescription:
    """One description of an arm, a gripper on its flange, or a gripper alone, fixed in the world.

    Args:
        arm: The arm; None for a gripper without an arm.
        gripper: The gripper; None for an arm without one, or with an integrated one.

    Raises:
        RobotError: The arm has no flange, or names clash between arm and gripper.
    """
    parts = [part for part in (arm, gripper) if part is not None]
    first = parts[0]
    source = " + ".join(part.name for part in parts)
    links: list[Link] = [Link(WORLD, None)]
    taken = {joint.name for part in parts for joint in part.urdf.joints}
    held = free_name("world_joint", taken)
    joints: list[Joint] = [fixed_joint(held, WORLD, first.urdf.root, base)]
    for part in parts:
        links += part.urdf.links
        joints += part.urdf.joints
    tcp_link = first.facts.tcp_link or ""
    srdf = first.srdf
    if gripper is not None and gripper.facts.mount is not None:
        mount = gripper.facts.mount
        flange = _flange(arm, gripper) if arm is not None else ""
        frame, added = _mounted(gripper, mount, flange)
        links.append(frame)
        joints += added
        tcp_link = frame.name
        if arm is not None:
            srdf = _joined(arm, gripper, flange, tcp_link)
    refuse_clashes(links, joints, source)
    tree_links, tree_joints = in_tree_order(links, joints, source)
    srdf = replace(srdf, disabled=_allowed(srdf, tree_links, tree_joints, source))
    facts = next((part.facts.gripper for part in parts[::-1] if part.facts.gripper), None)
    bounds = first.facts.controller_tolerances
    tolerances = None if bounds is None else TrackingTolerances(**bounds.model_dump())
    controllers = {
        kind: names
        for part in parts
        for kind, names in part.facts.controllers.model_dump().items()
        if names
    }
    hand = None if facts is None else _gripper(facts)
    return replace(
        robot_of_tree(source, tree_links, tree_joints, srdf),
        arm_group="" if arm is None else arm.facts.arm_group or "",
        gripper=hand,
        tcp_link=tcp_link,
        base_link=first.urdf.root,
        start_state=_start_state(parts, srdf),
        cameras=_cameras(parts, tree_links),
        wrench_sensors=_wrench_sensors(parts, tree_links, tree_joints),
        tracking=TrackingTolerances(**first.facts.tracking.model_dump()),
        controller_tolerances=tolerances,
        ik_solver=first.facts.ik_solver,
        controllers=controllers,
        notes=tuple(note for part in parts for note in part.notes),
        rejected_grippers=tuple(why for part in parts for why in part.rejected_grippers),
        arms=tuple(
            Arm(
                each.group,
                each.tcp_link if number else tcp_link,
                each.base_link,
                (each.gripper and _gripper(each.gripper)) if number else hand,
                {} if number else controllers,
                tolerances,
            )
            for number, each in enumerate(first.arms)
        ),
        default_arm=first.default_arm,
    )


def robot_of_tree(
    name: str, links: tuple[Link, ...], joints: tuple[Joint, ...], srdf: Srdf
) -> RobotDescription:
    """A robot of which only its tree and its SRDF are known yet."""
    return RobotDescription(
        name=name,
        urdf=write_urdf(name, links, joints),
        srdf=write_srdf(name, srdf),
        links=links,
        joints=joints,
        groups=planning_groups(srdf, joints, name),
        named_states=srdf.states,
        allowed_collisions=srdf.disabled,
        arm_group="",
        gripper=None,
        tcp_link="",
        base_link="",
        start_state={},
    )


def _flange(arm: RobotPart, gripper: RobotPart) -> str:
    if not arm.facts.flange_link:
        raise RobotError(
            f"'{arm.name}' has no flange that the gripper '{gripper.name}' could be mounted on; "
            f"leave `gripper` out"
        )
    return arm.facts.flange_link


def _mounted(gripper: RobotPart, mount: Mount, flange: str) -> tuple[Link, list[Joint]]:
    """The gripper's TCP frame, and the joints that attach it and the gripper's root."""
    root = gripper.urdf.root
    on_root = SE3.from_xyz_rpy(mount.tcp.xyz, mount.tcp.rpy)
    frame = Link(mount.tcp.link, None)
    if not flange:
        return frame, [fixed_joint(mount.tcp.joint, root, frame.name, on_root)]
    on_flange = SE3.from_xyz_rpy(mount.xyz, mount.rpy)
    return frame, [
        fixed_joint(mount.joint, flange, root, on_flange),
        fixed_joint(mount.tcp.joint, flange, frame.name, on_flange @ on_root),
    ]


def _joined(arm: RobotPart, gripper: RobotPart, flange: str, tcp_link: str) -> Srdf:
    """Groups of both; chains that ended at the flange end at the gripper's TCP."""
    groups = tuple(
        replace(
            group,
            chains=tuple((base, tcp_link if tip == flange else tip) for base, tip in group.chains),
        )
        for group in arm.srdf.groups
    )
    tools = tuple(
        EndEffector(tool.name, flange, tool.group, arm.facts.arm_group or "")
        for tool in gripper.srdf.end_effectors
    )
    return Srdf(
        groups + gripper.srdf.groups,
        arm.srdf.states + gripper.srdf.states,
        arm.srdf.end_effectors + tools,
        arm.srdf.passive + gripper.srdf.passive,
        {**arm.srdf.disabled, **gripper.srdf.disabled},
        arm.srdf.virtual_joints,
    )


def refuse_clashes(links: Sequence[Link], joints: Sequence[Joint], source: str) -> None:
    """Refuse links or joints of the same name.

    Raises:
        RobotError: There are some.
    """
    for kind, names in (
        ("link", [link.name for link in links]),
        ("joint", [joint.name for joint in joints]),
    ):
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise RobotError(f"{source}: {kind} names are defined twice: {', '.join(twice)}")


def _allowed(
    srdf: Srdf, links: tuple[Link, ...], joints: tuple[Joint, ...], source: str
) -> dict[tuple[str, str], str]:
    """The SRDF's pairs, and adjacent links."""
    names = {link.name for link in links}
    allowed = dict(srdf.disabled)
    for pair in allowed:
        for name in pair:
            if name not in names:
                raise RobotError(f"{source}: disable_collisions names the unknown link '{name}'")
    for pair in adjacent_pairs(links, joints):
        allowed.setdefault(pair, "Adjacent")
    return allowed


def _gripper(facts: GripperFacts) -> Gripper:
    if facts.cups and "suction" not in registry("grip"):
        raise RobotError("; ".join(["no plug-in holds by `cups` here", *absent_plugins()]))
    axis = None if facts.approach_axis is None else np.array(facts.approach_axis)
    return Gripper(
        group=facts.group,
        joint=facts.joint,
        sides=facts.links_by_side,
        pads=facts.pads,
        palm_link=facts.palm_link,
        open_position=facts.open_position,
        closed_position=facts.closed_position,
        grip_effort=facts.grip_effort,
        max_effort=facts.max_effort,
        widths=np.array(facts.widths or _valve(facts)),
        friction=facts.friction,
        approach_axis=None if axis is None else axis / np.linalg.norm(axis),
        cups=tuple(
            Cup(name, cup.link, cup.radius, cup.lip, cup.depth)
            for name, cup in (facts.cups or {}).items()
        ),
        vacuum=facts.vacuum or 0.0,
    )


def _valve(facts: GripperFacts) -> list[tuple[float, float]]:
    """The table of a valve: how far it is from open, at its two ends, with rising position."""
    ends = facts.open_position, facts.closed_position
    return sorted((end, abs(facts.closed_position - end)) for end in ends)


def _cameras(parts: list[RobotPart], links: tuple[Link, ...]) -> dict[str, Camera]:
    """Cameras of every part's robot.yaml, by name."""
    cameras: dict[str, Camera] = {}
    names = [link.name for link in links]
    for part in parts:
        for name, facts in part.facts.cameras.items():
            where = f"{Path(part.source) / 'robot.yaml'}: cameras.{name}"
            if name in cameras:
                raise RobotError(f"{where}: another camera has the name '{name}'")
            if facts.link not in names:
                hint = did_you_mean(facts.link, names, "links")
                raise RobotError(f"{where}.link: there is no link '{facts.link}'; {hint}")
            pose = SE3.from_xyz_rpy(facts.pose.xyz, facts.pose.rpy)
            cameras[name] = facts.camera(name, facts.link, pose)
    return cameras


def _wrench_sensors(
    parts: list[RobotPart], links: tuple[Link, ...], joints: tuple[Joint, ...]
) -> dict[str, WrenchSensor]:
    """Sensors of every part's files, by name."""
    sensors: dict[str, WrenchSensor] = {}
    for part in parts:
        own = {name: facts.sensor(name) for name, facts in part.facts.wrench_sensors.items()}
        for name, sensor in own.items():
            where = f"{Path(part.source) / 'robot.yaml'}: wrench_sensors.{name}"
            if name in sensors:
                raise RobotError(f"{where}: another sensor has the name '{name}'")
            if reason := flaw(sensor, links, joints):
                raise RobotError(f"{where}.link: {reason}")
        sensors |= {**part.wrench_sensors, **own}
    return sensors


def _start_state(parts: list[RobotPart], srdf: Srdf) -> Mapping[str, float]:
    """Start positions of robot.yaml: a named state, overridden by single joints."""
    positions: dict[str, float] = {}
    for part in parts:
        start = part.facts.start_state
        if start.named_target is not None:
            positions |= _state(srdf.states, start.named_target, part.source).positions
        positions |= start.joints or {}
    return positions


def _state(states: tuple[NamedState, ...], name: str, source: str) -> NamedState:
    for state in states:
        if state.name == name:
            return state
    known = ", ".join(state.name for state in states)
    raise RobotError(f"{source}: start_state names the unknown state '{name}'; known are {known}")
