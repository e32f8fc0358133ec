"""A URDF's joints: kinds, axes, limits, mimics."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from harness.core.kinematics import JointKind
from harness.language.files.xml_file import XmlElement
from harness.robot.mechanism import Joint, Mimic, fixed_joint
from harness.robot.urdf.values import number, pose, three
from harness.robot.urdf.write import NO_LIMIT

KINDS: dict[str, JointKind] = {
    "fixed": "fixed",
    "revolute": "revolute",
    "continuous": "continuous",
    "prismatic": "prismatic",
}
FREE = ("floating", "planar")

MOST_TURNS = 4  # Turns from zero that are no mistake in a revolute joint


def placeholder_limits(joints: Sequence[XmlElement]) -> list[str]:
    """A note on each velocity or effort limit that is no limit, with the joints that have it."""
    found: dict[tuple[str, float], list[str]] = {}
    for joint in joints:
        limit = joint.find("limit")
        if limit is None or joint.get("type") == "fixed":
            continue
        for key in ("velocity", "effort"):
            if key in limit.attributes and (value := float(limit.get(key))) <= 0:
                found.setdefault((key, value), []).append(joint.get("name"))
    return [
        f"joint{'s' * (len(names) > 1)} {', '.join(names)}: the {key} limit of {value:g} counts as"
        " none"
        for (key, value), names in found.items()
    ]


def ranges_of_continuous(joints: Sequence[XmlElement]) -> list[str]:
    """A note on the joints that have a range and are continuous, so that it counts for nothing."""
    limits = {joint.get("name"): joint.find("limit") for joint in joints}
    names = [
        joint.get("name")
        for joint in joints
        if joint.get("type") == "continuous"
        and (limit := limits[joint.get("name")]) is not None
        and any(number(limit, key, 0.0) for key in ("lower", "upper"))
    ]
    plural = "s" if len(names) > 1 else ""
    text = f"joint{plural} {', '.join(names)}: `lower` and `upper` are ignored, since the type is"
    return [f"{text} continuous; `revolute` has them"] if names else []


def ranges_of_many_turns(joints: Iterable[Joint]) -> list[str]:
    """A note on the joints whose limits may be degrees: more turns than a cable takes."""
    return [
        f"joint {joint.name} turns from {joint.lower:g} to {joint.upper:g} rad,"
        f" {farthest / (2 * np.pi):.0f} turns from zero: angles in a URDF are radians"
        for joint in joints
        if joint.kind == "revolute"
        and MOST_TURNS * 2 * np.pi < (farthest := max(abs(joint.lower), abs(joint.upper))) <= 720
    ]


def read_joint(element: XmlElement) -> Joint:
    """A joint.

    Soft limits of a `safety_controller` narrow the position limits, as in MoveIt. A velocity or
    effort limit of zero or less counts as none: with zero the joint could not move, and a negative
    one means "no limit" in SDFormat.

    Raises:
        SpecError: It has a mistake.
    """
    name = element.name()
    kind = _kind(element, name)
    parent, child = element.find("parent"), element.find("child")
    if parent is None or child is None:
        element.refuse(f"joint '{name}' has a <parent> and a <child>")
    axis_element = element.find("axis")
    axis = np.array((1.0, 0.0, 0.0) if axis_element is None else three(axis_element, "xyz"))
    length = float(np.linalg.norm(axis))
    if kind != "fixed" and length < 1e-9:
        (axis_element or element).refuse(f"joint '{name}' has an axis of no length", at="xyz")
    lower, upper = _positions(element, name, kind)
    limit, dynamics = element.find("limit"), element.find("dynamics")
    mimic = element.find("mimic")
    moves = kind != "fixed"
    damping = 0.0 if dynamics is None else number(dynamics, "damping", 0.0)
    friction = 0.0 if dynamics is None else number(dynamics, "friction", 0.0)
    return Joint(
        name,
        kind,
        parent.need("link"),
        child.need("link"),
        pose(element),
        axis / length if moves else axis,
        lower,
        upper,
        _rate(limit, "velocity") if moves else np.inf,
        effort=_rate(limit, "effort") if moves else np.inf,
        damping=max(damping, 0.0),
        friction=max(friction, 0.0),
        mimic=None
        if mimic is None or not moves
        else Mimic(
            mimic.need("joint"), number(mimic, "multiplier", 1.0), number(mimic, "offset", 0.0)
        ),
    )


def _kind(element: XmlElement, name: str) -> JointKind:
    word = element.need("type")
    if word in FREE:
        element.refuse(
            f"joint '{name}' is {word}; an arm has a fixed base",
            "make it fixed; the scenario's `base` places the robot",
            at="type",
        )
    if word not in KINDS:
        element.refuse(
            f"joint '{name}' has the type '{word}'; known are {', '.join(KINDS)}", at="type"
        )
    return KINDS[word]


def _positions(element: XmlElement, name: str, kind: JointKind) -> tuple[float, float]:
    limit, safety = element.find("limit"), element.find("safety_controller")
    lower, upper = -np.inf, np.inf
    if kind in ("revolute", "prismatic"):
        if limit is None:
            if element.find("mimic") is not None:
                return lower, upper
            element.refuse(f"joint '{name}' is {kind} and has no <limit>")
        lower, upper = number(limit, "lower", 0.0), number(limit, "upper", 0.0)
        if lower > upper:
            limit.refuse(f"joint '{name}': lower {lower:g} is above upper {upper:g}", at="lower")
    if safety is not None and kind != "fixed":
        soft = (
            max(lower, number(safety, "soft_lower_limit", -1e9)),
            min(upper, number(safety, "soft_upper_limit", 1e9)),
        )
        if kind != "continuous" and soft[0] < soft[1]:
            lower, upper = soft
    return lower, upper


def _rate(limit: XmlElement | None, key: str) -> float:
    if limit is None or key not in limit.attributes:
        return np.inf
    if limit.get(key).strip() in ("inf", "+inf"):
        return np.inf
    value = number(limit, key)
    return value if 0 < value < NO_LIMIT else np.inf


def held_without_range(joints: Sequence[Joint], notes: list[str]) -> tuple[Joint, ...]:
    """The joints, where those whose limits are one position are fixed there.

    What follows such a joint is fixed as well.
    """
    held = {
        joint.name: joint.lower
        for joint in joints
        if joint.is_movable and joint.mimic is None and joint.lower == joint.upper
    }
    if held:
        places = ", ".join(f"{name} at {value:g}" for name, value in held.items())
        notes.append(
            f"joints whose `lower` and `upper` are equal cannot move and are fixed: {places}"
        )
    while following := [
        joint
        for joint in joints
        if joint.name not in held and joint.mimic is not None and joint.mimic.joint in held
    ]:
        for joint in following:
            assert joint.mimic is not None
            followed = held[joint.mimic.joint]
            held[joint.name] = joint.mimic.multiplier * followed + joint.mimic.offset
        notes.append(f"they follow a fixed joint: {', '.join(joint.name for joint in following)}")
    return tuple(
        fixed_joint(joint.name, joint.parent, joint.child, joint.at(held[joint.name]))
        if joint.name in held
        else joint
        for joint in joints
    )


def resolved_mimics(
    joints: Sequence[Joint], elements: dict[tuple[str, str], XmlElement]
) -> tuple[Joint, ...]:
    """The joints with each mimic resolved to a driven joint.

    Raises:
        SpecError: A mimic follows an unknown or a fixed joint, or itself in the end.
    """
    by_name = {joint.name: joint for joint in joints}

    def followed(joint: Joint) -> Joint:
        multiplier, offset, seen, mimic = 1.0, 0.0, [joint.name], joint.mimic
        while mimic is not None:
            element = elements["joint", seen[-1]].find("mimic") or elements["joint", seen[-1]]
            if mimic.joint not in by_name or not by_name[mimic.joint].is_movable:
                word = "fixed" if mimic.joint in by_name else "unknown"
                element.refuse(
                    f"joint '{seen[-1]}' mimics the {word} joint '{mimic.joint}'", at="joint"
                )
            if mimic.joint in seen:
                element.refuse(
                    f"joints mimic each other in a circle: {' - '.join((*seen, mimic.joint))}",
                    at="joint",
                )
            offset += multiplier * mimic.offset
            multiplier *= mimic.multiplier
            seen.append(mimic.joint)
            mimic = by_name[mimic.joint].mimic
        return replace(joint, mimic=Mimic(seen[-1], multiplier, offset)) if joint.mimic else joint

    return tuple(followed(joint) for joint in joints)
