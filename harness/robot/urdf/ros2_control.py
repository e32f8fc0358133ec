"""Reads a URDF's `<ros2_control>`: the limits of its command interfaces."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from harness.core.errors import collected
from harness.language.files.xml_file import XmlElement
from harness.robot.mechanism import Joint
from harness.robot.urdf.values import text_number

Ignored = dict[tuple[str, str, float], list[str]]
"""Joints by interface, key and value of a bound that is ignored."""


def with_interfaces(
    joints: Sequence[Joint], root: XmlElement, notes: list[str]
) -> tuple[Joint, ...]:
    """The joints, limited by the `min` and `max` of their command interfaces.

    The program drives every joint by its effort. The bounds only narrow `<limit>`, as in
    ros2_control's limiter.

    Raises:
        SpecError: A bound is not a number, or a range is empty; all of them, located.
    """
    known = {joint.name: joint for joint in joints}
    ignored: Ignored = {}

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
            joint = _narrowed(joint, command, ignored)
        known[name] = joint

    blocks = root.findall("ros2_control")
    collected(read, (item for block in blocks for item in block.findall("joint")))
    notes += [
        f"ros2_control: joint{'s' * (len(names) > 1)} {', '.join(names)}: the `{key}` of {value:g}"
        f" of the {interface} is ignored, since it limits no magnitude"
        for (interface, key, value), names in ignored.items()
    ]
    return tuple(known[joint.name] for joint in joints)


def _narrowed(joint: Joint, command: XmlElement, ignored: Ignored) -> Joint:
    """The joint with the bounds of a command interface.

    Velocity and effort are limited in both directions, so that a `min` of zero or more, or a `max`
    of zero or less, limits nothing; vendors write them where they mean a magnitude.
    """
    interface = command.need("name")
    bounds = {
        param.get("name"): text_number(param)
        for param in command.findall("param")
        if param.get("name") in ("min", "max")
    }
    low, high = bounds.get("min", -math.inf), bounds.get("max", math.inf)
    if interface == "position":
        return _within(joint, low, high, command)
    if interface not in ("velocity", "effort"):
        return joint
    for key, is_none in (("min", low >= 0), ("max", high <= 0)):
        if is_none:
            ignored.setdefault((interface, key, bounds[key]), []).append(joint.name)
    most = min(-low if low < 0 else math.inf, high if high > 0 else math.inf)
    return replace(joint, **{interface: min(getattr(joint, interface), most)})


def _within(joint: Joint, low: float, high: float, command: XmlElement) -> Joint:
    """The joint with its position limits narrowed to a range.

    Raises:
        SpecError: The range is empty, or outside the joint's own.
    """
    lower, upper = max(joint.lower, low), min(joint.upper, high)
    if low > high:
        message = f"its `min` of {low:g} in ros2_control is above its `max` of {high:g}"
        command.refuse(f"joint '{joint.name}': {message}", "swap or remove them")
    if lower > upper:
        message = f"ros2_control allows {low:g} to {high:g}"
        limit = f"its <limit> {joint.lower:g} to {joint.upper:g}"
        command.refuse(f"joint '{joint.name}': {message}, and {limit}: nothing is in both")
    if joint.kind != "continuous":
        return replace(joint, lower=lower, upper=upper)
    is_bounded = lower > -math.inf and upper < math.inf
    return replace(joint, kind="revolute", lower=lower, upper=upper) if is_bounded else joint
