"""A robot from files of its own: what its robot.yaml would say is taken from URDF and SRDF."""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from harness.core.errors import RobotError
from harness.robot.compose import WORLD, Part
from harness.robot.default_pairs import touching_pairs
from harness.robot.description import Joint, Link, PlanningGroup
from harness.robot.groups import planning_groups
from harness.robot.mass import refuse_weightless
from harness.robot.packages import NotFoundError, PackagePath
from harness.robot.robot_yaml import RobotYaml
from harness.robot.srdf import Srdf, parse_srdf
from harness.robot.srdf_check import checked_srdf, default_srdf
from harness.robot.urdf import Urdf, parse_urdf
from harness.robot.xacro_file import render
from harness.spec.scenario import RobotSpec, StartState
from harness.spec.xml_file import read_bounded

ROOT_CALLED_WORLD = "robot_world"
"""What a robot's own root link is called that had the name of ours."""

ACCELERATION = {"prismatic": 1.0}
"""Acceleration limits that no URDF says [m/s^2]; MoveIt's own default for all others: [rad/s^2]."""
TURNING_ACCELERATION = 5.0

VELOCITY = {"prismatic": 0.2}
"""Velocity limits where the file gives none [m/s]; for turning joints [rad/s]."""
TURNING_VELOCITY = 1.5

START_STATES = ("home", "ready", "start", "default", "init", "rest")
"""Names of group states that an imported arm stands in at the start, the first that is there."""


def read_robot(spec: RobotSpec, base_dir: Path) -> Part:
    """The robot of `urdf:` or `xacro:`, with what its SRDF says, or a plain one without.

    Args:
        spec: The scenario's `robot:`.
        base_dir: The scenario's folder, where relative names start.

    Raises:
        SpecError: A file says what cannot be meant; at its line and column.
        RobotError: A file is not found, or an option does not fit it.
    """
    key = "urdf" if spec.urdf is not None else "xacro"
    given = tuple(_folder(each, base_dir) for each in spec.packages)
    path = find_file(getattr(spec, key), key, base_dir, given)
    packages = PackagePath.of_file(path, given)
    if key == "xacro":
        text = render(path, spec.args, packages).encode()
    elif spec.args:
        raise RobotError("robot.args: a `urdf` takes no arguments; a `xacro` does")
    else:
        text = read_bounded(path)
    urdf = _own_world(parse_urdf(text, path.parent, str(path), packages))
    refuse_weightless(urdf, str(path))
    srdf = default_srdf(urdf, spec.tcp_link)
    source = str(path)
    if spec.srdf is not None:
        srdf_path = find_file(spec.srdf, "srdf", base_dir, given)
        source = str(srdf_path)
        parsed = parse_srdf(read_bounded(srdf_path), source)
        if urdf.root == ROOT_CALLED_WORLD:
            parsed = _with_own_world(parsed)
        srdf = checked_srdf(parsed, urdf, source)
    return _part(spec, urdf, srdf, path, source)


def find_file(name: str, key: str, base_dir: Path, given: Sequence[Path]) -> Path:
    """A robot's file: a path from the scenario's folder, or package://name/path.

    Raises:
        RobotError: It is not there.
    """
    if name.startswith("package://"):
        try:
            return PackagePath.of_file(base_dir / "scenario", given).file(name, base_dir)
        except NotFoundError as error:
            raise RobotError(f"robot.{key}: {error}") from error
    path = base_dir / Path(name).expanduser()
    if not path.is_file():
        near = difflib.get_close_matches(path.name, _names(path.parent), 1)
        hint = f"; did you mean '{near[0]}'?" if near else ""
        raise RobotError(f"robot.{key}: there is no file {path}{hint}")
    return path


def _names(folder: Path) -> list[str]:
    return sorted(each.name for each in folder.iterdir()) if folder.is_dir() else []


def _folder(name: str, base_dir: Path) -> Path:
    folder = base_dir / Path(name).expanduser()
    if not folder.is_dir():
        raise RobotError(f"robot.packages: there is no folder {folder}")
    return folder


def _own_world(urdf: Urdf) -> Urdf:
    """The tree with its root renamed where that is called as ours."""
    if WORLD not in {link.name for link in urdf.links}:
        return urdf

    def name(link: str) -> str:
        return ROOT_CALLED_WORLD if link == WORLD else link

    links = tuple(replace(link, name=name(link.name)) for link in urdf.links)
    joints = tuple(
        replace(joint, parent=name(joint.parent), child=name(joint.child)) for joint in urdf.joints
    )
    elements = {**urdf.elements, ("link", ROOT_CALLED_WORLD): urdf.elements["link", WORLD]}
    return replace(urdf, links=links, joints=joints, elements=elements)


def _with_own_world(srdf: Srdf) -> Srdf:
    """Chains that began at the root begin at its new name."""
    groups = tuple(
        replace(
            group,
            chains=tuple(
                (ROOT_CALLED_WORLD if base == WORLD else base, tip) for base, tip in group.chains
            ),
        )
        for group in srdf.groups
    )
    return replace(srdf, groups=groups)


def _part(spec: RobotSpec, urdf: Urdf, srdf: Srdf, path: Path, source: str) -> Part:
    notes: list[str] = []
    urdf = replace(urdf, joints=tuple(_limited(joint, notes) for joint in urdf.joints))
    groups = planning_groups(srdf, urdf.joints, source)
    arm = _arm_group(spec, srdf, groups, source)
    last = urdf.joints[-1].child if urdf.joints else urdf.root
    tip = arm.tip_link or next(
        (j.child for j in urdf.joints[::-1] if j.name == arm.joint_names[-1]), last
    )
    for key in ("tcp_link", "flange_link"):
        _refuse_unknown_link(getattr(spec, key), key, urdf.links)
    start = _start(urdf.joints, srdf, arm)
    if not srdf.disabled:
        pairs = touching_pairs(urdf, start)
        srdf = replace(srdf, disabled=dict.fromkeys(pairs, "Default"))
        notes += [f"no allowed pairs: those that touch at the start are: {_told(pairs)}"] * bool(
            pairs
        )
    facts = RobotYaml(
        robot=path.stem[:100],
        kind="arm",
        urdf=path.name,
        srdf=source,
        arm_group=arm.name,
        tcp_link=spec.tcp_link or tip,
        flange_link=spec.flange_link or tip,
        ik_solver="auto",
        max_acceleration=TURNING_ACCELERATION,
        effort_source="",
        start_state=StartState(joints=start),
    )
    return Part(path.stem, facts, urdf, srdf, source, (*urdf.notes, *srdf.notes, *notes))


def _told(pairs: Sequence[tuple[str, str]]) -> str:
    return ", ".join(f"{first} - {second}" for first, second in pairs)


def _limited(joint: Joint, notes: list[str]) -> Joint:
    """A joint with the limits that its file does not give."""
    if not joint.is_movable:
        return joint
    joint = replace(
        joint,
        acceleration=ACCELERATION.get(joint.kind, TURNING_ACCELERATION),
        effort_source="the URDF" if np.isfinite(joint.effort) else "",
    )
    if not np.isfinite(joint.velocity) and joint.mimic is None:
        velocity = VELOCITY.get(joint.kind, TURNING_VELOCITY)
        unit = "m/s" if joint.kind == "prismatic" else "rad/s"
        notes.append(f"joint '{joint.name}' has no velocity limit: {velocity} {unit} is assumed")
        joint = replace(joint, velocity=velocity)
    return joint


def _arm_group(
    spec: RobotSpec, srdf: Srdf, groups: Mapping[str, PlanningGroup], source: str
) -> PlanningGroup:
    """The group that motion steps speak of by default."""
    movable = {name: group for name, group in groups.items() if group.joint_names}
    if spec.group is not None:
        if spec.group not in movable:
            near = difflib.get_close_matches(spec.group, list(movable), 1)
            hint = f"did you mean '{near[0]}'? " if near else ""
            raise RobotError(
                f"robot.group: there is no group '{spec.group}' with joints that move; {hint}"
                f"known are {', '.join(movable) or 'none'}"
            )
        return movable[spec.group]
    parents = [tool.parent_group for tool in srdf.end_effectors if tool.parent_group in movable]
    if parents:
        return movable[parents[0]]
    written = {group.name: group for group in srdf.groups}
    chains = [group for group in movable.values() if group.tip_link]
    single = [group for group in chains if not written[group.name].subgroups]
    candidates = single or chains or list(movable.values())
    if not candidates:
        raise RobotError(f"{source}: no group has a joint that moves: there is no arm to plan for")
    return max(candidates, key=lambda group: len(group.joint_names))


def _refuse_unknown_link(name: str | None, key: str, links: Sequence[Link]) -> None:
    names = [link.name for link in links]
    if name is not None and name not in names:
        near = difflib.get_close_matches(name, names, 1)
        hint = f"did you mean '{near[0]}'? " if near else ""
        raise RobotError(
            f"robot.{key}: the robot has no link '{name}'; {hint}links: {', '.join(names)}"
        )


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
