"""Vectors, rotations and poses of ROS messages in YAML: with their names, or as lists."""

from __future__ import annotations

import math
from collections.abc import Generator
from contextlib import contextmanager

from pydantic import ValidationError

from harness.core.spatial import SE3, wxyz_from_xyzw
from harness.language.base import LARGEST_NUMBER
from harness.language.files.source import Located
from harness.plugins.formats.plain_values import first_mistake
from harness.plugins.formats.yaml_data import number, refuse


def child(item: Located, *names: str) -> Located | None:
    """The value under a path of keys; None where one is missing or empty."""
    for name in names:
        entry = item.mapping().get(name) if isinstance(item.value, dict) else None
        if entry is None or entry.value.value is None:
            return None
        item = entry.value
    return item


def children(item: Located, *names: str) -> list[Located]:
    """The items of the list under a path of keys; empty where there is none."""
    found = child(item, *names)
    return found.items() if found is not None and isinstance(found.value, list) else []


def text(item: Located, name: str, default: str = "") -> str:
    """The text under a key."""
    found = child(item, name)
    return default if found is None else str(found.value)


def numbers(item: Located | None, names: str) -> list[float] | None:
    """Numbers of a list, or of a mapping with one key for each letter of `names`."""
    if item is None:
        return None
    if isinstance(item.value, dict):
        entries = item.mapping()
        parts = [entries[name].value for name in names if name in entries]
    else:
        parts = item.items() if isinstance(item.value, list) else []
    if len(parts) != len(names):
        refuse(item, f"expected {len(names)} numbers: {', '.join(names)}")
    found = [number(part) for part in parts]
    for part, value in zip(parts, found, strict=True):
        if abs(value) > LARGEST_NUMBER:
            refuse(part, f"{value:g} is too large; at most {LARGEST_NUMBER:g}")
    return found


@contextmanager
def refused_at(item: Located) -> Generator[None]:
    """Report a value that a model of the world refuses at an item of the message.

    Raises:
        SpecError: The model refuses a value; at the item.
    """
    try:
        yield
    except ValidationError as error:
        refuse(item, first_mistake(error))


def quaternion(item: Located) -> list[float]:
    """A rotation in ROS order, normalised; four zeros, as in an empty message, are none."""
    quat = numbers(item, "xyzw") or [0.0, 0.0, 0.0, 1.0]
    norm = math.hypot(*quat)
    return [value / norm for value in quat] if norm > 1e-9 else [0.0, 0.0, 0.0, 1.0]


def message_pose(item: Located | None) -> SE3:
    """The pose of a message; identity where it is empty."""
    if item is None:
        return SE3.identity()
    turned = child(item, "orientation") or child(item, "rotation")
    xyz = numbers(child(item, "position") or child(item, "translation"), "xyz")
    quat_xyzw = [0.0, 0.0, 0.0, 1.0] if turned is None else quaternion(turned)
    return SE3.from_xyz_quat(xyz or [0.0, 0.0, 0.0], wxyz_from_xyzw(quat_xyzw))


def joint_positions(state: Located) -> dict[str, tuple[float, Located]]:
    """Joint positions of a RobotState by name, each with its place."""
    names = children(state, "joint_state", "name")
    positions = children(state, "joint_state", "position")
    if len(names) != len(positions):
        refuse(state, f"{len(names)} names of joints and {len(positions)} positions")
    return {
        str(name.value): (number(position), position)
        for name, position in zip(names, positions, strict=True)
    }
