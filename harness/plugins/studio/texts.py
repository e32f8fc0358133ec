"""Steps and objects as a scenario has them, and as the fields of the page have them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.spatial import SE3, pitch_of
from harness.core.types import FloatArray
from harness.language.goals import GoalFields
from harness.language.step import STEPS
from harness.plugins.studio.document import flow
from harness.robot.description import RobotDescription

_TO_A_GOAL = {verb: step for verb, step in STEPS.items() if issubclass(step, GoalFields)}

MOTIONS = sorted(_TO_A_GOAL, key=lambda verb: (-len(_TO_A_GOAL[verb].one_of), verb))
"""The verbs of motions to a goal, those with the most kinds of goals first."""


def step_text(verb: str, keys: Any) -> str:
    """A step on one line: `move_to: {joints: {...}}`."""
    return f"{verb}: {flow(keys)}"


def pose_keys(description: RobotDescription, group: str, pose: SE3, frame: str) -> dict[str, Any]:
    """The goal keys of a TCP pose in a frame, which the arm's joints are enough for.

    Args:
        pose: The pose T_frame_tcp of the TCP.
    """
    place: dict[str, Any] = {} if frame == "world" else {"frame": frame}
    place["xyz"] = [round(float(value), 5) for value in pose.translation]
    if not description.task_space(group).holds_pose:
        return {"position": place, "pitch": degrees(pitch_of(pose.rotation))}
    place["rpy"] = rpy_degrees(pose.rotation)
    return {"pose": place}


def joint_keys(description: RobotDescription, group: str, positions: FloatArray) -> dict[str, Any]:
    """The goal keys of joint positions in description order; angles in degrees."""
    values = {
        name: float(positions[description.joint_index[name]])
        for name in description.groups[group].joint_names
    }
    slides = {joint.name for joint in description.joints if joint.kind == "prismatic"}
    return {
        "joints": {
            name: round(value, 5) if name in slides else degrees(value)
            for name, value in values.items()
        }
    }


def degrees(angle: float) -> str | int:
    """An angle [rad] as a scenario has it: `20 deg`; a zero alone."""
    value = round(float(np.degrees(angle)), 3)
    return f"{value:g} deg" if value else 0


def rpy_degrees(rotation: FloatArray) -> list[str | int]:
    """Roll, pitch and yaw of a rotation as a scenario has them; yaw is 0 where pitch is 90 deg."""
    level = float(np.hypot(rotation[0, 0], rotation[1, 0]))
    pitch = np.arctan2(-rotation[2, 0], level)
    if level < 1e-6:  # only the sum of roll and yaw is determined
        return [degrees(np.arctan2(-rotation[1, 2], rotation[1, 1])), degrees(pitch), 0]
    roll = np.arctan2(rotation[2, 1], rotation[2, 2])
    return [degrees(roll), degrees(pitch), degrees(np.arctan2(rotation[1, 0], rotation[0, 0]))]


def of_arm(description: RobotDescription, step: str) -> str:
    """A step of the selected arm, of a robot that has several."""
    return f"{step}\nrobot: {description.selected_arm}" if description.selected_arm else step


def gripper_steps(description: RobotDescription) -> dict[str, str]:
    """Steps that move the gripper, by the words of their buttons; `open` and `close` are there.

    A gripper without named states of that kind opens and closes to the ends of its width.
    """
    gripper = description.gripper
    if gripper is None:
        return {}
    steps = {state: f"gripper: {state}" for state in description.states_of(gripper.group)}
    if gripper.cups:
        ends = {"open": gripper.open_position, "close": gripper.closed_position}
        return {word: step_text("gripper", {"position": end}) for word, end in ends.items()} | steps
    widths = gripper.widths[:, 1]
    narrowest, widest = np.ceil(1e4 * widths.min()) / 1e4, np.floor(1e4 * widths.max()) / 1e4
    closed = next((steps.pop(word) for word in ("closed", "close") if word in steps), None)
    opened = steps.pop("open", None) or step_text("gripper", {"width": float(widest)})
    closed = closed or step_text("gripper", {"width": float(narrowest)})
    return {"open": opened, "close": closed, **steps}


AXES: dict[str, tuple[int, ...]] = {"box": (0, 1, 2), "cylinder": (0, 2), "sphere": (2,)}
"""The axes of an object along which its sizes are measured, in the order of the page's field."""

SMALLEST = 0.005  # the smallest size that a handle gives an object [m]


def shape_keys(kind: str, size: Sequence[float]) -> dict[str, Any]:
    """The keys of a shape.

    Args:
        kind: `box` (size x, y, z), `cylinder` (diameter, height) or `sphere` (diameter).
        size: The full size [m].
    """
    if kind == "cylinder":
        return {"radius": size[0] / 2, "length": size[1]}
    return {"radius": size[0] / 2} if kind == "sphere" else {"size": list(size)}


def object_spec(name: str, kind: str, size: list[float], xyz: list[float]) -> dict[str, Any]:
    """A new object as a scenario has it; a mass of water's density, at most 0.3 kg.

    Args:
        kind: A shape of `shape_keys`.
        size: The full size [m].
        xyz: The position of its centre in the world [m].
    """
    share = {"cylinder": np.pi / 4 * size[0], "sphere": np.pi / 6 * size[0] ** 2}.get(kind, 1.0)
    mass = float(np.clip(round(1000.0 * share * float(np.prod(size)), 3), 0.01, 0.3))
    return {"name": name, kind: shape_keys(kind, size), "pose": {"xyz": xyz}, "mass": mass}


@dataclass(frozen=True)
class ObjectForm:
    """An object of a scenario as the page's fields have it.

    Attributes:
        name: The name of the object.
        kind: A shape of `shape_keys`; empty where the fields cannot show the object.
        size: The full size, in the order of `shape_keys` [m].
        xyz: The position of its centre [m].
    """

    name: str
    kind: str
    size: list[Any]
    xyz: list[Any]

    @classmethod
    def of(cls, spec: Mapping[str, Any]) -> ObjectForm:
        """The fields of an object as the scenario has it."""
        size: list[Any] = []
        match spec:
            case {"box": {"size": [*size]}}:
                kind = "box"
            case {"cylinder": {"radius": float() | int() as radius, "length": length}}:
                kind, size = "cylinder", [2 * radius, length]
            case {"sphere": {"radius": float() | int() as radius}}:
                kind, size = "sphere", [2 * radius]
            case _:
                kind = ""
        place = spec.get("pose")
        xyz = list(place.get("xyz") or ()) if isinstance(place, Mapping) else []
        are_numbers = all(isinstance(value, (int, float)) for value in [*size, *xyz])
        is_shown = are_numbers and len(xyz) == 3
        return cls(str(spec.get("name", "")), kind if is_shown else "", size, xyz)

    @property
    def axes(self) -> list[int]:
        """The axes of the object along which its sizes are measured."""
        return list(AXES[self.kind])

    def half(self) -> list[float | None]:
        """Half its sizes along its axes [m]; None where it has no size of its own."""
        half: list[float | None] = [None, None, None]
        for axis, size in zip(self.axes, self.size, strict=True):
            half[axis] = 0.5 * size
        return half

    def resized(self, spec: Mapping[str, Any], pose: SE3, half: Sequence[float]) -> dict[str, Any]:
        """The object after faces were dragged; those opposite stay where they are.

        Args:
            pose: The pose T_world_object of the object before.
            half: Half its new sizes along its axes [m], shape (3,).
        """
        before = np.array(self.size, dtype=float)
        size = np.maximum(2.0 * np.array(half, dtype=float)[self.axes], SMALLEST)
        shift = np.zeros(3)
        shift[self.axes] = 0.5 * (size - before)
        moved = SE3(pose.rotation, pose.apply(shift))
        keys = shape_keys(self.kind, [round(float(value), 4) for value in size])
        return {**spec, self.kind: keys, "pose": pose_keys_of(moved)}


def pose_keys_of(pose: SE3) -> dict[str, Any]:
    """The pose of an object in the world."""
    keys: dict[str, Any] = {"xyz": [round(float(value), 4) for value in pose.translation]}
    turn = rpy_degrees(pose.rotation)
    if any(turn):
        keys["rpy"] = turn
    return keys
