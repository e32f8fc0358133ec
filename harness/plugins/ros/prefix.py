"""The prefix that joints and links have on the graph, and nowhere else."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import fields, is_dataclass, replace
from typing import Any, cast

from harness.robot.description import RobotDescription

_ATTRIBUTE = re.compile(r"""(["'])([^"'<>]+)\1""")


class Prefix:
    """Renames joints and links in messages: `joint1` is `left_joint1` for nodes.

    A root link such as `world`, and names of objects, groups and controllers stay as they are.
    """

    def __init__(self, text: str, description: RobotDescription) -> None:
        """Rename the joints and links of a robot.

        Args:
            text: What nodes put before their names; empty where they have the same.
        """
        roots = {j.parent for j in description.joints} - {j.child for j in description.joints}
        links = {*description.link_names} - roots if text else set[str]()
        joints = {joint.name for joint in description.joints} if text else set[str]()
        self._outward = {name: text + name for name in links | joints}
        without = {name: f"{name} (without {text})" for name in self._outward}  # which is unknown
        self._inward = without | {there: here for here, there in self._outward.items()}

    def outward(self, content: Any) -> Any:
        """A message as nodes read it."""
        return _renamed(content, self._outward) if self._outward else content

    def inward(self, content: Any) -> Any:
        """A message of a node as the program reads it."""
        return _renamed(content, self._inward) if self._inward else content


def _renamed(content: Any, names: dict[str, str]) -> Any:
    """A copy of a message in which names are replaced, also in a URDF or SRDF."""
    if isinstance(content, str):
        if content.lstrip().startswith("<"):
            return _ATTRIBUTE.sub(lambda found: _attribute(found, names), content)
        first, slash, rest = content.partition("/")  # an interface such as joint1/position
        return names[first] + slash + rest if first in names else content
    if isinstance(content, list | tuple):
        old = cast("Sequence[Any]", content)
        new = [_renamed(each, names) for each in old]
        return new if any(a is not b for a, b in zip(new, old, strict=True)) else old
    if is_dataclass(content) and not isinstance(content, type):
        parts = {part.name: getattr(content, part.name) for part in fields(content) if part.init}
        renamed = {key: _renamed(value, names) for key, value in parts.items()}
        changed = {key: value for key, value in renamed.items() if value is not parts[key]}
        return replace(content, **changed) if changed else content
    return content


def _attribute(found: re.Match[str], names: dict[str, str]) -> str:
    mark, name = found.groups()
    return f"{mark}{names.get(name, name)}{mark}"
