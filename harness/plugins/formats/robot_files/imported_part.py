"""Derives the content of robot.yaml for an imported robot from its URDF and SRDF."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from harness.core.errors import RobotError, RobotOptionError
from harness.core.suggestion import did_you_mean
from harness.language.scenario import RobotSpec, StartState
from harness.plugins.formats.robot_files.assumed_limits import ACCELERATION, VELOCITY
from harness.plugins.formats.robot_files.default_group import DEFAULT_GROUP, MOST_FINGER_JOINTS
from harness.plugins.formats.robot_files.find_hand import hand_candidates, named_hand
from harness.plugins.formats.robot_files.inferred_gripper import (
    IntegratedGripper,
    NoGripperError,
    recognise,
)
from harness.plugins.formats.robot_files.inferred_tcp import (
    tcp_without_gripper,
    with_integrated_gripper,
)
from harness.plugins.formats.touching_links import touching_pairs
from harness.robot.compose import PartArm, RobotPart
from harness.robot.description import PlanningGroup
from harness.robot.groups import planning_groups
from harness.robot.mechanism import Joint
from harness.robot.robot_yaml import RobotYaml
from harness.robot.srdf.srdf import EndEffector, Srdf
from harness.robot.urdf.urdf import Urdf

DAMPED_SHARE = 0.5  # Share of a joint's effort that its damping may take at the velocity limit

START_STATES = ("home", "ready", "start", "default", "init", "rest")
"""Names of start states of an imported arm, in order of preference."""


def with_reflected_friction(joints: Sequence[Joint]) -> tuple[Joint, ...]:
    """The joints with the damping and friction of mimic joints moved to the joint they follow.

    A rigid coupling transmits both, so the motion is the same. The physics couples joints by a
    force that it chooses from their inertia, and then integrates damping implicitly: a follower
    whose damping times the time step is much larger than its inertia would hardly obey.
    """
    damping = {joint.name: joint.damping for joint in joints}
    friction = {joint.name: joint.friction for joint in joints}
    for joint in joints:
        if joint.mimic is None:
            continue
        ratio = abs(joint.mimic.multiplier)
        damping[joint.mimic.joint] += ratio**2 * joint.damping
        friction[joint.mimic.joint] += ratio * joint.friction
        damping[joint.name] = friction[joint.name] = 0.0
    return tuple(
        replace(joint, damping=damping[joint.name], friction=friction[joint.name])
        for joint in joints
    )


def imported_part(spec: RobotSpec, urdf: Urdf, srdf: Srdf, path: Path, source: str) -> RobotPart:
    """The robot in the form of a folder with a robot.yaml.

    Args:
        spec: The `robot:` of the scenario.
        urdf: The tree of the robot.
        srdf: The SRDF to be checked against it.
        path: The path of the robot's file.
        source: Name of the SRDF in messages.

    Raises:
        RobotError: There is no arm, or an option refers to an unknown name.
    """
    name = (urdf.name or path.stem)[:100]
    notes = [*urdf.notes, *srdf.notes]
    joints = with_reflected_friction(urdf.joints)
    described_in = "the MJCF" if spec.mjcf else "the SDF" if spec.sdf else "the URDF"
    limited = tuple(_limited(joint, described_in, notes) for joint in joints)
    urdf = replace(urdf, joints=limited)
    groups = planning_groups(srdf, urdf.joints, source)
    srdf = _with_parent_groups(srdf, groups)
    arm = _arm_group(spec, srdf, groups, source)
    last = next(j.child for j in urdf.joints[::-1] if j.name == arm.joint_names[-1])
    tip = arm.tip_link or last
    start = _start(urdf.joints, srdf, arm)
    if not srdf.disabled:
        pairs = touching_pairs(urdf, start)
        srdf = replace(srdf, disabled=dict.fromkeys(pairs, "Default"))
        if pairs:
            notes.append(
                "no allowed pairs are given, so the pairs that touch at the start are allowed:"
                f" {_listed(pairs)}"
            )
    gripper, rejected = None, list[str]()
    own = _own_gripper(spec, urdf, srdf, groups, arm, rejected)
    notes += rejected if own is None else []
    if own is not None:
        urdf, srdf, tcp_link = with_integrated_gripper(own, arm, tip, spec.tcp_link, notes)
        gripper = own.facts
    elif spec.tcp_link is not None or spec.gripper is not None:
        tcp_link = spec.tcp_link or tip
    else:
        tcp_link = tcp_without_gripper(urdf, srdf, arm, tip)
    arms = [PartArm(arm.name, tcp_link, arm.base_link, gripper)]
    for other in other_arms(arm, srdf, groups):
        urdf, srdf, added = _other_arm(spec, urdf, srdf, other, source, notes)
        arms.append(added)
    is_stated = bool(spec.group or spec.tcp_link or spec.gripper)
    if len(arms) > 1:
        srdf = srdf.with_group_of_all([each.group for each in arms])
    facts = RobotYaml(
        robot=name,
        kind="arm",
        urdf=path.name,
        srdf=source,
        arm_group=arm.name,
        tcp_link=tcp_link,
        flange_link=spec.flange_link or tip,
        ik_solver="auto",
        max_acceleration=ACCELERATION[False][0],
        effort_source="",
        start_state=StartState(joints=start),
        gripper=gripper,
    )
    return RobotPart(
        name,
        facts,
        urdf,
        srdf,
        source,
        tuple(notes),
        tuple(rejected),
        arms=tuple(arms) if len(arms) > 1 else (),
        default_arm=arm.name if len(arms) > 1 and is_stated else "",
    )


def _with_parent_groups(srdf: Srdf, groups: Mapping[str, PlanningGroup]) -> Srdf:
    """The SRDF with the arm of each of several end effectors that name none.

    As in MoveIt, it is the group that ends at the parent link with the fewest joints: an arm, and
    not the arm with its torso.
    """
    if len(srdf.end_effectors) < 2:
        return srdf

    def parent_group(tool: EndEffector) -> str:
        ends = [each for each in groups.values() if each.tip_link == tool.parent_link]
        nearest = min(ends, key=lambda each: len(each.joint_names), default=None)
        return tool.parent_group or (nearest.name if nearest else "")

    tools = tuple(replace(tool, parent_group=parent_group(tool)) for tool in srdf.end_effectors)
    return replace(srdf, end_effectors=tools)


def other_arms(
    first: PlanningGroup, srdf: Srdf, groups: Mapping[str, PlanningGroup]
) -> list[PlanningGroup]:
    """The arms besides the first: chains of other joints that carry a tool, or are no fingers."""
    parents = {tool.parent_group for tool in srdf.end_effectors}
    found = [first]
    for group in sorted(groups.values(), key=lambda each: each.name not in parents):
        is_chain = bool(group.tip_link and group.joint_names)
        is_arm = group.name in parents or len(group.joint_names) > MOST_FINGER_JOINTS
        taken = {name for each in found for name in each.joint_names}
        if is_chain and is_arm and taken.isdisjoint(group.joint_names):
            found.append(group)
    return found[1:]


def _other_arm(
    spec: RobotSpec, urdf: Urdf, srdf: Srdf, arm: PlanningGroup, source: str, notes: list[str]
) -> tuple[Urdf, Srdf, PartArm]:
    """An arm besides the first, with its own gripper if it has one, found as that of the first."""
    groups = planning_groups(srdf, urdf.joints, source)
    rejected = list[str]()
    named = spec.model_copy(update={"gripper": None})
    own = _own_gripper(named, urdf, srdf, groups, arm, rejected)
    if own is None:
        notes += rejected
        tcp = tcp_without_gripper(urdf, srdf, arm, arm.tip_link)
        return urdf, srdf, PartArm(arm.name, tcp, arm.base_link, None)
    urdf, srdf, tcp = with_integrated_gripper(own, arm, arm.tip_link, None, notes)
    return urdf, srdf, PartArm(arm.name, tcp, arm.base_link, own.facts)


def _own_gripper(
    spec: RobotSpec,
    urdf: Urdf,
    srdf: Srdf,
    groups: Mapping[str, PlanningGroup],
    arm: PlanningGroup,
    rejected: list[str],
) -> IntegratedGripper | None:
    """The arm's own gripper: the named group, else the first group that is a gripper.

    Why groups before it are none is added to `rejected`.

    Raises:
        RobotError: The named group is not a gripper.
    """
    if spec.gripper is not None:
        hand = named_hand(spec.gripper, srdf, groups, arm)
        try:
            return None if hand is None else recognise(urdf, srdf, hand)
        except NoGripperError as error:
            raise RobotOptionError(
                "gripper", f"'{spec.gripper}' is not a gripper: {error}"
            ) from error
    for hand, with_hand in hand_candidates(urdf, srdf, groups, arm):
        try:
            return recognise(urdf, with_hand, hand)
        except NoGripperError as error:
            rejected.append(f"'{hand.name}' is not used as a gripper: {error}")
    return None


def _listed(pairs: Sequence[tuple[str, str]]) -> str:
    return ", ".join(f"{first} - {second}" for first, second in pairs)


def _limited(joint: Joint, source: str, notes: list[str]) -> Joint:
    """A joint with defaults for the limits that its file, the source, lacks."""
    if not joint.is_movable:
        return joint
    joint = replace(
        joint,
        acceleration=ACCELERATION[joint.kind == "prismatic"][0],
        effort_source=source if np.isfinite(joint.effort) else "",
    )
    if not np.isfinite(joint.velocity) and joint.mimic is None:
        velocity = VELOCITY[joint.kind == "prismatic"][0]
        joint = replace(joint, velocity=velocity, is_velocity_assumed=True)
    most = DAMPED_SHARE * joint.effort / joint.damping if joint.damping > 0 else np.inf
    if joint.velocity > most:
        notes.append(
            f"joint '{joint.name}': its damping takes {joint.damping * joint.velocity:.3g} of its "
            f"effort of {joint.effort:.3g} at {joint.velocity:.3g}; at most {most:.3g} is planned"
        )
        joint = replace(joint, velocity=most, is_velocity_assumed=False)
    return joint


def _arm_group(
    spec: RobotSpec, srdf: Srdf, groups: Mapping[str, PlanningGroup], source: str
) -> PlanningGroup:
    """The default group of motion steps."""
    movable = {name: group for name, group in groups.items() if group.joint_names}
    if spec.group is not None:
        if spec.group not in movable:
            raise RobotOptionError(
                "group",
                f"there is no group '{spec.group}' with joints that move; "
                + did_you_mean(spec.group, movable, "groups"),
            )
        return movable[spec.group]
    parents = [tool.parent_group for tool in srdf.end_effectors if tool.parent_group in movable]
    if parents:
        return movable[parents[0]]
    written = {group.name: group for group in srdf.groups}
    chains = [group for group in movable.values() if group.tip_link]
    single = [group for group in chains if not written[group.name].subgroups]
    if spec.srdf is None and len(single) > 1:  # arms of which the first is the default's
        single = [group for group in single if group.name != DEFAULT_GROUP]
    candidates = single or chains or list(movable.values())
    if not candidates:
        raise RobotError(f"{source}: no group has a joint that moves: there is no arm to plan for")
    return max(candidates, key=lambda group: len(group.joint_names))


def refuse_unknown_links(spec: RobotSpec, urdf: Urdf) -> None:
    """Refuse a TCP or a flange that is no link of the robot.

    Raises:
        RobotOptionError: One is not known.
    """
    names = [link.name for link in urdf.links]
    for key in ("tcp_link", "flange_link"):
        name = getattr(spec, key)
        if name is not None and name not in names:
            hint = did_you_mean(name, names, "links")
            raise RobotOptionError(key, f"the robot has no link '{name}'; {hint}")


def _start(joints: Sequence[Joint], srdf: Srdf, arm: PlanningGroup) -> dict[str, float]:
    """Positions of all driven joints: a state of the arm's, else zero, inside the limits."""
    movable = [joint for joint in joints if joint.is_movable and joint.mimic is None]
    positions = {joint.name: float(np.clip(0.0, joint.lower, joint.upper)) for joint in movable}
    states = {
        state.name.lower(): state
        for state in srdf.states
        if state.group == arm.name or set(arm.joint_names) <= set(state.positions)
    }
    name = next((name for name in START_STATES if name in states), None)
    chosen = states[name] if name else next(iter(states.values()), None)
    for joint in movable:
        if chosen is not None and joint.name in chosen.positions:
            value = chosen.positions[joint.name]
            positions[joint.name] = float(np.clip(value, joint.lower, joint.upper))
    return positions
