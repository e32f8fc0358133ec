"""MoveIt's joint_limits.yaml and kinematics.yaml."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from harness.language.files.source import Located
from harness.plugins.formats.yaml_data import known_entry, number, read_data, refuse
from harness.robot.mechanism import Joint

SOLVER_KEYS = ("kinematics_solver", "position_only_ik")
WRAPPERS = ("/**", "ros__parameters", "robot_description_planning", "robot_description_kinematics")
"""Keys that ROS 2 launch and parameter files wrap around the content."""


def with_joint_limits(
    joints: Sequence[Joint], path: Path, robot: str, notes: list[str]
) -> tuple[tuple[Joint, ...], frozenset[str]]:
    """The joints with the limits of a joint_limits.yaml, and those with an acceleration there.

    Positions, velocities and efforts only narrow the limits of the robot's file; accelerations,
    and velocities that are assumed because it lacks them, are used unchanged.

    Raises:
        SpecError: A joint is unknown, or a limit is not a number; at line and column.
    """
    root = read_data(path, ("joint_limits",), "joint_limits.yaml")
    entry = _content(root).mapping().get("joint_limits")
    if entry is None:
        refuse(root, "MoveIt's joint_limits.yaml has `joint_limits` at the top")
    sections = entry.value.mapping()
    names = [joint.name for joint in joints]
    limits = {name: known_entry(sections, name, names, "joint", robot) for name in sections}
    changed = tuple(
        _limited(joint, limits[joint.name], notes) if joint.name in limits else joint
        for joint in joints
    )
    given = {name for name, item in limits.items() if _value(item, "acceleration") is not None}
    return changed, frozenset(given)


def _limited(joint: Joint, item: Located, notes: list[str]) -> Joint:
    velocity, acceleration, effort = (
        _value(item, key) for key in ("velocity", "acceleration", "effort")
    )
    lower, upper = _value(item, "position", "min_position"), _value(item, "position")
    widest_velocity = np.inf if joint.is_velocity_assumed else joint.velocity
    for what, value, widest in (
        ("velocity", velocity, widest_velocity),
        ("effort", effort, joint.effort),
        ("position", upper, joint.upper),
        ("position", None if lower is None else -lower, -joint.lower),
    ):
        if value is not None and value > widest + 1e-6:
            notes.append(
                f"joint_limits.yaml: {joint.name} has a wider {what} limit than the robot's file, "
                "which stays"
            )
    bounds = (
        max(joint.lower, joint.lower if lower is None else lower),
        min(joint.upper, joint.upper if upper is None else upper),
    )
    if bounds[0] >= bounds[1]:
        refuse(item, f"nothing is between {bounds[0]:g} and {bounds[1]:g}, the limits left")
    return replace(
        joint,
        lower=bounds[0],
        upper=bounds[1],
        velocity=joint.velocity if velocity is None else min(velocity, widest_velocity),
        is_velocity_assumed=joint.is_velocity_assumed and velocity is None,
        acceleration=acceleration or joint.acceleration,
        effort=min(joint.effort, effort or joint.effort),
    )


def _value(item: Located, what: str, key: str = "") -> float | None:
    """An enabled limit: for example `has_velocity_limits: true` and `max_velocity`."""
    entries = item.mapping()
    switch = entries.get(f"has_{what}_limits")
    entry = entries.get(key or f"max_{what}")
    if entry is None or (switch is not None and switch.value.value is not True):
        return None
    value = number(entry.value)
    if what != "position" and value <= 0:
        refuse(entry.value, f"a {what} limit of {value:g}; it has to be above zero")
    return value


def position_only_groups(path: Path, groups: Collection[str], robot: str) -> frozenset[str]:
    """Groups of a kinematics.yaml with `position_only_ik: true`.

    Raises:
        SpecError: A group is unknown; at its key.
    """
    root = _content(read_data(path, SOLVER_KEYS, "kinematics.yaml"))
    sections = root.mapping()
    found: set[str] = set()
    for name in sections:
        item = known_entry(sections, name, groups, "group", robot)
        entry = item.mapping().get("position_only_ik")
        if entry is None:
            continue
        if not isinstance(entry.value.value, bool):
            refuse(entry.value, "`position_only_ik` is true or false")
        if entry.value.value:
            found.add(name)
    return frozenset(found)


def _content(root: Located) -> Located:
    """The content inside the wrapper keys."""
    while len(root.mapping()) == 1 and (key := next(iter(root.mapping()))) in WRAPPERS:
        root = root.mapping()[key].value
    return root
