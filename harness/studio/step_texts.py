"""Steps as text: what the page's buttons do, written as a scenario has it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.robot.description import RobotDescription
from harness.studio.document import flow
from harness.studio.reach import WHOLE_POSE_JOINTS, pitch_of

MOTIONS = ("move_to", "ptp", "lin", "circ")
FREE_ORIENTATION = "free"


def step_text(verb: str, keys: Any) -> str:
    """A step on one line: `move_to: {joints: {...}}`."""
    return f"{verb}: {flow(keys)}"


def pose_keys(description: RobotDescription, group: str, pose: SE3, frame: str) -> dict[str, Any]:
    """The goal keys of a TCP pose in a frame, which the arm's joints are enough for.

    Args:
        description: The description of the robot.
        group: The name of the planning group.
        pose: The pose T_frame_tcp of the TCP.
        frame: The name of the frame.
    """
    place: dict[str, Any] = {} if frame == "world" else {"frame": frame}
    place["xyz"] = [round(float(value), 5) for value in pose.translation]
    if len(description.groups[group].joint_names) < WHOLE_POSE_JOINTS:
        return {"position": place, "pitch": round(pitch_of(pose), 5)}
    w, x, y, z = (float(value) for value in pose.as_vector()[3:])
    place["quat_xyzw"] = [round(value, 6) for value in (x, y, z, w)]
    return {"pose": place}


def joint_keys(description: RobotDescription, group: str, positions: FloatArray) -> dict[str, Any]:
    """The goal keys of joint positions in description order."""
    index = description.joint_index
    names = description.groups[group].joint_names
    return {"joints": {name: round(float(positions[index[name]]), 5) for name in names}}


def object_spec(name: str, kind: str, size: list[float], xyz: list[float]) -> dict[str, Any]:
    """A new object as a scenario has it; a mass of water's density, at most 0.3 kg.

    Args:
        name: The name of the object.
        kind: `box` (size x, y, z), `cylinder` (diameter, height) or `sphere` (diameter).
        size: The full size [m].
        xyz: The position of its centre in the world [m].
    """
    shape: Mapping[str, Any]
    match kind:
        case "cylinder":
            shape = {"radius": size[0] / 2, "length": size[1]}
            volume = np.pi * (size[0] / 2) ** 2 * size[1]
        case "sphere":
            shape = {"radius": size[0] / 2}
            volume = np.pi * size[0] ** 3 / 6
        case _:
            shape, volume = {"size": size}, float(np.prod(size))
    mass = float(np.clip(round(1000.0 * volume, 3), 0.01, 0.3))
    return {"name": name, kind: dict(shape), "pose": {"xyz": xyz}, "mass": mass}


def object_form(spec: Mapping[str, Any]) -> dict[str, Any]:
    """An object of a scenario as the page's fields have it; without a kind where they cannot."""
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
    return {
        "name": str(spec.get("name", "")),
        "kind": kind if are_numbers and len(xyz) == 3 else "",
        "size": size,
        "xyz": xyz,
    }
