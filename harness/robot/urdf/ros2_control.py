"""Reads a URDF's `<ros2_control>`: command interfaces of joints and their limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from harness.core.errors import collected
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
        SpecError: A bound is not a number, or a range is empty; all of them, located.
    """
    known = {joint.name: joint for joint in joints}

    def read(item: XmlElement) -> None:
        name = item.need("name")
        if name not in known or not known[name].is_movable:
            notes.append(f"ros2_control: there is no joint '{name}' that moves: ignored")
            return
        commands = item.findall("command_interface")
        if not commands and known[name].mimic is None:
            notes.append(f"ros2_control: joint '{name}' has no command interface; it is driven")
        joint = known[name]
        for command in commands:
            joint = _narrowed(joint, command)
        known[name] = joint

    blocks = root.findall("ros2_control")
    collected(read, (item for block in blocks for item in block.findall("joint")))
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
        if low >= high:
            message = f"its `min` of {low:g} in ros2_control is not below its `max` of {high:g}"
            command.refuse(f"joint '{joint.name}': {message}", "swap or remove them")
        if lower >= upper:
            message = f"ros2_control allows {low:g} to {high:g}"
            limit = f"its <limit> {joint.lower:g} to {joint.upper:g}"
            command.refuse(f"joint '{joint.name}': {message}, and {limit}: nothing is in both")
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
