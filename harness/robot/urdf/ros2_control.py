"""Reads a URDF's `<ros2_control>`: command interfaces of joints and their limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from harness.language.files.xml_file import XmlElement
from harness.robot.description import Joint
from harness.robot.urdf.values import text_number


def with_interfaces(
    joints: Sequence[Joint], root: XmlElement, notes: list[str]
) -> tuple[Joint, ...]:
    """The joints with their command interfaces, limited by the interfaces' `min` and `max`.

    The program drives every joint by its effort; the interfaces' names are kept for users. Their
    bounds only narrow `<limit>`, as in ros2_control's limiter.

    Raises:
        SpecError: A bound is not a number, or the range is empty; located.
    """
    known = {joint.name: joint for joint in joints}
    for item in (each for block in root.findall("ros2_control") for each in block.findall("joint")):
        name = item.need("name")
        if name not in known or not known[name].is_movable:
            notes.append(f"ros2_control: there is no joint '{name}' that moves: ignored")
            continue
        commands = item.findall("command_interface")
        if not commands and known[name].mimic is None:
            notes.append(f"ros2_control: joint '{name}' has no command interface; it is driven")
        joint = known[name]
        for command in commands:
            joint = _narrowed(joint, command)
        known[name] = joint
    return tuple(known[joint.name] for joint in joints)


def _narrowed(joint: Joint, command: XmlElement) -> Joint:
    interface = command.need("name")
    joint = replace(joint, command_interfaces=(*joint.command_interfaces, interface))
    bounds = {
        param.get("name"): text_number(param)
        for param in command.findall("param")
        if param.get("name") in ("min", "max")
    }
    low, high = bounds.get("min", -math.inf), bounds.get("max", math.inf)
    if interface == "position":
        lower, upper = max(joint.lower, low), min(joint.upper, high)
        if lower >= upper:
            command.refuse(f"joint '{joint.name}': nothing is between {lower:g} and {upper:g}")
        bounded = joint.kind == "continuous" and lower > -math.inf and upper < math.inf
        kind = "revolute" if bounded else joint.kind
        return (
            joint if kind == "continuous" else replace(joint, kind=kind, lower=lower, upper=upper)
        )
    most = min(abs(low), abs(high))
    if most == 0 and interface in ("velocity", "effort"):
        command.refuse(f"joint '{joint.name}': a {interface} of 0 lets nothing move")
    if interface == "velocity":
        return replace(joint, velocity=min(joint.velocity, most))
    if interface == "effort":
        return replace(joint, effort=min(joint.effort, most))
    return joint
