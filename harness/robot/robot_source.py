"""Which robot a person means: a bundled name, a robot's file or folder, or a scenario's robot."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from harness.core.errors import RobotError
from harness.core.resources import existing_or_bundled
from harness.core.suggestion import did_you_mean
from harness.core.types import FloatArray
from harness.language.files.xml_file import XmlElement, read_xml
from harness.language.reading.load import load_scenario
from harness.language.scenario import RobotSpec
from harness.robot.description import RobotDescription
from harness.robot.find_file import find_file
from harness.robot.load import load_robot, load_scenario_robot
from harness.robot.xacro_file import is_xacro

ROBOT_YAML = "robot.yaml"
KINDS = {f".{kind}": kind for kind in ("urdf", "xacro", "mjcf", "sdf")}
KINDS |= {".srdf": "urdf", ".xml": "mjcf", ".world": "sdf"}
OPTIONS = {
    "srdf": "--srdf",
    "packages": "--package-path",
    "gripper": "--gripper",
    "args": "--args",
    "group": "--group",
    "tcp_link": "--tcp-link",
}
"""Fields that a scenario's own robot leaves no room for, by what the command line calls them."""


@dataclass(frozen=True)
class RobotSource:
    """A robot as the command line names it.

    Attributes:
        word: A name, a file, a robot's folder or the robot.yaml in it, or `package://name/path`.
        srdf: The SRDF next to a robot's file; empty for none.
        packages: Folders where package:// is looked up.
        gripper: A bundled gripper to be mounted; empty for none.
        tcp_link: Instead of the arm group's tip; empty for that.
        group: The arm's; empty for the one of most joints.
    """

    word: str
    srdf: str = ""
    packages: Sequence[str] = ()
    gripper: str = ""
    args: Mapping[str, str] = field(default_factory=dict[str, str])
    tcp_link: str = ""
    group: str = ""

    @cached_property
    def kind(self) -> str:
        """A format, `scenario` or `model`; of XML what it says, however it is named.

        Raises:
            SpecError: The file is no XML that can be read.
        """
        path = Path(self.word)
        if path.name == ROBOT_YAML:
            return "model"
        if path.suffix.lower() in (".yaml", ".yml"):
            return "scenario"
        kind = KINDS.get(path.suffix.lower(), "model")
        root = self._root() if kind in ("urdf", "mjcf") else None
        if root is not None and root.tag == "robot":
            return "xacro" if is_xacro(root) else "urdf"
        return kind if root is None else {"mujoco": "mjcf", "sdf": "sdf"}.get(root.tag, kind)

    @property
    def has_no_srdf(self) -> bool:
        """Whether it is a robot's file with no SRDF next to it."""
        return self.kind in KINDS.values() and not self.srdf

    @property
    def own_name(self) -> str:
        """The robot's name in a file that can be read, unless xacro computes it; else empty."""
        if self.kind not in KINDS.values() or (root := self._root()) is None:
            return ""
        name = root.get("model" if root.tag == "mujoco" else "name")
        return "" if "$" in name else name

    def words(self) -> dict[str, Any]:
        """What a scenario's `robot:` would say, not of a scenario."""
        path = Path(self.word)
        word = str(path.parent) if path.name == ROBOT_YAML else self.word
        words: dict[str, Any] = {self.kind: word}
        if self.args:
            words["args"] = dict(self.args)
        if self.packages:
            words["packages"] = tuple(self.packages)
        for key in ("srdf", "gripper", "group", "tcp_link"):
            if getattr(self, key):
                words[key] = getattr(self, key)
        return words

    def _root(self) -> XmlElement | None:
        """The root element of a robot's file; None where there is no file."""
        try:
            path = find_file(self.word, "urdf", Path(), [Path(each) for each in self.packages])
        except RobotError:
            return None
        return read_xml(path)


def load_source(source: RobotSource) -> RobotDescription:
    """The robot, composed.

    Raises:
        SpecError: A file is invalid.
        RobotError: The robot is not known, or its files cannot be used.
    """
    if source.kind == "scenario":
        path = existing_or_bundled(Path(source.word))
        for option in OPTIONS:
            if getattr(source, option):
                raise RobotError(f"'{path}' says its robot itself: {OPTIONS[option]} is for others")
        scenario = load_scenario(path).scenario
        return load_scenario_robot(scenario, path.parent)
    return load_robot(RobotSpec.of_options(source.words()))


def positions_of(description: RobotDescription, state: str) -> FloatArray:
    """Joint positions of a named state, in description order; where it starts for none.

    Raises:
        RobotError: It has no such state.
    """
    found = [each for each in description.named_states if each.name == state]
    if state and not found:
        names = [each.name for each in description.named_states]
        raise RobotError(f"there is no state '{state}'; {did_you_mean(state, names, 'states')}")
    return description.start_positions(dict(ChainMap(*(dict(each.positions) for each in found))))
