"""A first scenario for a robot: a pick where it has a gripper and a place for it, else a motion."""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from string import Template

import numpy as np

from harness.core.types import FloatArray
from harness.planning.collision.pair_statistics import sample_robot_positions
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.robot.description import RobotDescription
from harness.robot_tools.robot_source import RobotSource, load_source
from harness.session.check import check_file

TEMPLATES = Path(__file__).parent / "templates"
SAMPLES = 500
"""Random configurations from which the reach is known."""

DISTANCES, HEIGHTS = (0.5, 0.6, 0.4, 0.7), (0.2, 0.1, 0.35, 0.5)
"""Where the box is tried: from the base and over the floor, in parts of the reach."""

CLEAR = 0.25
"""How far the box is from where the hand starts, in parts of the reach."""

THICK = 0.1
"""Half of what an arm is thick, in parts of its reach."""

HEADINGS = (0.0, 0.5 * math.pi, -0.5 * math.pi)
WIDEST_BOX, TALLEST_BOX = 0.05, 0.08  # [m]
MOTIONS = 10


@dataclass(frozen=True)
class FirstScenario:
    """A scenario that was checked.

    Attributes:
        text: The text of the file.
        trouble: What `harness check` still says of it; empty when nothing.
    """

    text: str
    trouble: str = ""


def first_scenario(source: RobotSource, file: Path) -> FirstScenario:
    """A scenario that `harness check` finds nothing wrong with, if one can be found.

    Args:
        source: The source of the robot.
        file: Where it will be: robots' files are named from its folder, and candidates are
            written next to it, and removed again.

    Raises:
        SpecError: A file of the robot is invalid.
        RobotError: The robot is not known, or its files cannot be used.
    """
    description = load_source(source)
    words = {
        "name": description.name,
        "title": _text(f"First steps of {description.name}"),
        "robot": _robot_words(source, file.parent),
    }
    candidate = file.with_name(f".{file.name}")
    trouble = text = ""
    try:
        for template, numbers in _candidates(description):
            text = _filled(template, {**words, **numbers})
            candidate.write_text(text, encoding="utf-8")
            found = check_file(candidate)
            if not found.problems and not found.predicted:
                return FirstScenario(text)
            trouble = (found.problems or found.predicted)[0].message
    finally:
        candidate.unlink(missing_ok=True)
    return FirstScenario(text, trouble)


def _filled(template: str, words: Mapping[str, str]) -> str:
    text = (TEMPLATES / f"{template}.scenario.yaml").read_text(encoding="utf-8")
    return Template(text).substitute(words)


def _robot_words(source: RobotSource, folder: Path) -> str:
    """The scenario's `robot:`."""

    def named(file: str) -> str:
        is_file = not file.startswith("package://") and Path(file).exists()
        return _text(Path(os.path.relpath(file, folder)).as_posix() if is_file else file)

    lines = ["robot:"]
    for key, value in source.words().items():
        match value:
            case dict():
                inner = ", ".join(f"{name}: {_text(str(item))}" for name, item in value.items())
                lines.append(f"  {key}: {{{inner}}}")
            case tuple():
                lines.append(f"  {key}: [{', '.join(named(each) for each in value)}]")
            case _:
                lines.append(f"  {key}: {named(value)}")
    return "\n".join(lines)


def _text(value: str) -> str:
    """A text as YAML, in quotes where it needs them."""
    return value if re.fullmatch(r"[A-Za-z./~][\w ./:+()-]*", value) else json.dumps(value)


def _candidates(description: RobotDescription) -> Iterator[tuple[str, dict[str, str]]]:
    """Templates and what fills them, the likeliest first."""
    positions = sample_robot_positions(description, SAMPLES, np.random.default_rng(0))
    kinematics = PinocchioKinematics(description)
    links = (description.base_link, description.tcp_link)
    poses = kinematics.link_poses(positions, links)[:, :, :3]
    reach = float(np.linalg.norm(poses[:, 1] - poses[:, 0], axis=1).max())
    base = _base_height(description, kinematics, reach)
    if description.gripper is not None and description.arm_group:
        opening = float(description.gripper.widths[:, 1].max())
        hand = kinematics.link_pose(description.start_positions(), description.tcp_link)
        for place in _places(reach):
            if np.linalg.norm(np.array(place) - hand.translation) > CLEAR * reach:
                yield "pick", _pick(place, base, reach, opening)
    for numbers in _motions(description, positions[:MOTIONS]):
        yield "move", {"base": f"{base:g}", **numbers}


def _base_height(
    description: RobotDescription, kinematics: PinocchioKinematics, reach: float
) -> float:
    """How high the base stands so that the arm does not begin in the floor [m]."""
    links = [joint.child for joint in description.movable_joints][2:]
    poses = [kinematics.link_pose(description.start_positions(), link) for link in links]
    lowest = min((float(pose.translation[2]) for pose in poses), default=reach) - THICK * reach
    return 0.0 if lowest > 0 else math.ceil(10 * (0.1 - lowest)) / 10


def _places(reach: float) -> Iterator[tuple[float, float, float]]:
    """Middles of the stand's top, seen from the base, the likeliest first."""
    for heading in HEADINGS:
        for share in HEIGHTS:
            for distance in DISTANCES:
                x, y = (distance * reach * turn for turn in (math.cos(heading), math.sin(heading)))
                yield round(x, 2), round(y, 2), round(share * reach, 2)


def _pick(
    place: tuple[float, float, float], base: float, reach: float, opening: float
) -> dict[str, str]:
    """What fills the template: a box on a stand, its size by the gripper's opening."""
    x, y, top = place[0], place[1], base + place[2]
    width = math.floor(1e3 * min(WIDEST_BOX, 0.6 * opening)) / 1e3
    height = min(TALLEST_BOX, 2.0 * width)
    travel = round(min(0.1, 0.1 * reach), 2)
    numbers = {
        "base": base,
        "x": x,
        "y": y,
        "stand": round(min(0.2, 0.25 * reach), 2),
        "stand_height": top,
        "stand_middle": top / 2,
        "box_middle": top + height / 2,
        "width": width,
        "height": height,
        "travel": travel,
        "above": travel / 2,
    }
    return {key: f"{value + 0.0:.4g}" for key, value in numbers.items()}


def _motions(description: RobotDescription, positions: FloatArray) -> Iterator[dict[str, str]]:
    """Goals of the arm between its start and random configurations."""
    start = description.start_positions()
    names = description.groups[description.arm_group].joint_names if description.arm_group else ()
    places = [description.joint_index[name] for name in names]
    for row in positions:
        goal = start + 0.4 * (row - start)
        yield {
            word: "{"
            + ", ".join(f"{n}: {values[i]:.3f}" for n, i in zip(names, places, strict=True))
            + "}"
            for word, values in (("goal", goal), ("start", start))
        }
