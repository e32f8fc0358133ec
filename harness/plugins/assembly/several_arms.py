"""Joins the robots of a scenario's `robots` into one robot with several arms."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import astuple, replace

from harness.core.errors import RobotError, RobotOptionError
from harness.robot.compose import refuse_clashes, robot_of_tree
from harness.robot.description import (
    ALL_ARMS,
    Arm,
    NamedState,
    RobotDescription,
    TrackingTolerances,
)
from harness.robot.end_effector import Gripper
from harness.robot.mechanism import WORLD, Joint, Link
from harness.robot.srdf.srdf import Srdf, SrdfGroup, link_pair, parse_srdf, write_srdf
from harness.robot.tree import in_tree_order

Name = Callable[[str], str]


def joined_arms(robots: Mapping[str, RobotDescription]) -> RobotDescription:
    """One robot of several, each with its base fixed in the world.

    Links, joints, groups and cameras of a robot get its name and `_` in front of their own; its
    arm's group gets the name alone. The group `arms` has the joints of all arms, and the named
    states that each of them has. No contact between two arms is allowed.

    Args:
        robots: The robots by the names of their arms.

    Raises:
        RobotError: Two links, joints, groups or cameras would have the same name.
    """
    renamed = [_renamed(name, robot) for name, robot in robots.items()]
    source = ", ".join(f"{name}: {robot.name}" for name, robot in robots.items())
    links = (Link(WORLD, None), *(link for robot in renamed for link in robot.links[1:]))
    joints = [joint for robot in renamed for joint in robot.joints]
    refuse_clashes(links, joints, source)
    links, ordered = in_tree_order(links, joints, source)
    srdf = _joined_srdf([parse_srdf(robot.srdf, source) for robot in renamed], [*robots], source)
    cameras = {name: camera for robot in renamed for name, camera in robot.cameras.items()}
    if len(cameras) < sum(len(robot.cameras) for robot in renamed):
        raise RobotError(f"{source}: two cameras have the same name")
    first = renamed[0]
    solvers, controllers = (
        {getattr(robot, key) for robot in renamed} for key in ("ik_solver", "joint_controller")
    )
    if len(controllers) > 1:
        raise RobotOptionError(
            "joint_controller", "all arms have the same one: " + ", ".join(sorted(controllers))
        )
    return replace(
        robot_of_tree(source, links, ordered, srdf),
        arm_group=first.arm_group,
        gripper=first.gripper,
        tcp_link=first.tcp_link,
        base_link=first.base_link,
        start_state={key: value for robot in renamed for key, value in robot.start_state.items()},
        cameras=cameras,
        wrench_sensors={k: v for robot in renamed for k, v in robot.wrench_sensors.items()},
        tracking=_widest([robot.tracking for robot in renamed]),
        ik_solver=solvers.pop() if len(solvers) == 1 else "auto",
        position_only_groups=frozenset().union(*(robot.position_only_groups for robot in renamed)),
        joint_controller=first.joint_controller,
        notes=tuple(note for robot in renamed for note in robot.notes),
        rejected_grippers=tuple(why for robot in renamed for why in robot.rejected_grippers),
        arms=tuple(
            Arm(
                name,
                robot.tcp_link,
                robot.base_link,
                robot.gripper,
                _in_namespace(name, own.controller_names),
                robot.controller_tolerances,
                robot.joint_names,
            )
            for (name, own), robot in zip(robots.items(), renamed, strict=True)
        ),
        default_arm=next(iter(robots)) if len(robots) == 1 else "",
    )


def _in_namespace(arm: str, all_of: Mapping[str, tuple[str, ...]]) -> Mapping[str, tuple[str, ...]]:
    """Names of controllers below the name of their arm."""
    return {kind: tuple(f"{arm}/{own}" for own in names) for kind, names in all_of.items()}


def _renamed(arm: str, robot: RobotDescription) -> RobotDescription:
    """The robot with the name of its arm in front of every name."""

    def name(own: str) -> str:
        return own if own in ("", WORLD) else f"{arm}_{own}"

    def group(own: str) -> str:
        return arm if own == robot.default_group else name(own)

    hand = robot.gripper
    return replace(
        robot,
        srdf=write_srdf(robot.name, _renamed_srdf(parse_srdf(robot.srdf, robot.name), name, group)),
        links=tuple(replace(link, name=name(link.name)) for link in robot.links),
        joints=tuple(_renamed_joint(joint, name) for joint in robot.joints),
        groups={},
        named_states=(),
        arm_group=group(robot.arm_group),
        gripper=None if hand is None else _renamed_gripper(hand, name, group),
        tcp_link=name(robot.tcp_link),
        base_link=name(robot.base_link),
        start_state={name(joint): value for joint, value in robot.start_state.items()},
        cameras={
            name(camera.name): replace(camera, name=name(camera.name), frame=name(camera.frame))
            for camera in robot.cameras.values()
        },
        wrench_sensors={
            name(each.name): replace(each, name=name(each.name), link=name(each.link))
            for each in robot.wrench_sensors.values()
        },
        position_only_groups=frozenset(map(group, robot.position_only_groups)),
        notes=tuple(f"{arm}: {note}" for note in robot.notes),
        rejected_grippers=tuple(f"{arm}: {why}" for why in robot.rejected_grippers),
    )


def _renamed_joint(joint: Joint, name: Name) -> Joint:
    mimic = joint.mimic and replace(joint.mimic, joint=name(joint.mimic.joint))
    names = {"name": name(joint.name), "parent": name(joint.parent), "child": name(joint.child)}
    return replace(joint, **names, mimic=mimic)


def _renamed_gripper(hand: Gripper, name: Name, group: Name) -> Gripper:
    return replace(
        hand,
        group=group(hand.group),
        joint=name(hand.joint),
        sides={side: tuple(map(name, links)) for side, links in hand.sides.items()},
        pads={side: name(link) for side, link in hand.pads.items()},
        palm_link=name(hand.palm_link),
        cups=tuple(replace(cup, link=name(cup.link)) for cup in hand.cups),
    )


def _renamed_state(state: NamedState, name: Name, group: Name) -> NamedState:
    positions = {name(joint): position for joint, position in state.positions.items()}
    return NamedState(state.name, group(state.group), positions)


def _renamed_srdf(srdf: Srdf, name: Name, group: Name) -> Srdf:
    return Srdf(
        groups=tuple(
            SrdfGroup(
                group(each.name),
                tuple(map(name, each.joints)),
                tuple(map(name, each.links)),
                tuple((name(base), name(tip)) for base, tip in each.chains),
                tuple(map(group, each.subgroups)),
            )
            for each in srdf.groups
        ),
        states=tuple(_renamed_state(state, name, group) for state in srdf.states),
        end_effectors=tuple(
            replace(
                tool,
                name=name(tool.name),
                parent_link=name(tool.parent_link),
                group=group(tool.group),
                parent_group=group(tool.parent_group) if tool.parent_group else "",
            )
            for tool in srdf.end_effectors
        ),
        passive=tuple(map(name, srdf.passive)),
        disabled={link_pair(name(a), name(b)): why for (a, b), why in srdf.disabled.items()},
        virtual_joints=tuple(
            replace(joint, name=name(joint.name), child_link=name(joint.child_link))
            for joint in srdf.virtual_joints
        ),
    )


def _joined_srdf(parts: list[Srdf], arms: list[str], source: str) -> Srdf:
    """The groups of all arms, and the group of all of them with the states that all have."""
    groups = [group for part in parts for group in part.groups]
    names = [*(group.name for group in groups), ALL_ARMS]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise RobotError(
            f"{source}: several planning groups would be called {', '.join(twice)}: give an arm"
            " another name"
        )
    whole = Srdf(
        groups=tuple(groups),
        states=tuple(state for part in parts for state in part.states),
        end_effectors=tuple(tool for part in parts for tool in part.end_effectors),
        passive=tuple(name for part in parts for name in part.passive),
        disabled={pair: why for part in parts for pair, why in part.disabled.items()},
        virtual_joints=tuple(joint for part in parts for joint in part.virtual_joints),
    )
    return whole.with_group_of_all(arms)


def _widest(tolerances: list[TrackingTolerances]) -> TrackingTolerances:
    """The tolerances with which the joints of every arm are tracked."""
    return TrackingTolerances(*map(max, zip(*map(astuple, tolerances), strict=True)))
