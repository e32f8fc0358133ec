"""Objects of the scenario as text, and as the fields of the page have them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray

AXES: dict[str, tuple[int, ...]] = {"box": (0, 1, 2), "cylinder": (0, 2), "sphere": (2,)}
"""The axes of an object along which its sizes are measured, in the order of the page's field."""

SMALLEST = 0.005
"""The smallest size that a handle gives an object [m]."""


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
        name: The name of the object.
        kind: A shape of `shape_keys`.
        size: The full size [m].
        xyz: The position of its centre in the world [m].
    """
    share = {"cylinder": np.pi / 4 * size[0], "sphere": np.pi / 6 * size[0] ** 2}.get(kind, 1.0)
    mass = float(np.clip(round(1000.0 * share * float(np.prod(size)), 3), 0.01, 0.3))
    return {"name": name, kind: shape_keys(kind, size), "pose": {"xyz": xyz}, "mass": mass}


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


def pose_keys_of(pose: SE3) -> dict[str, Any]:
    """The pose of an object in the world."""
    vector = pose.as_vector()
    keys = {"xyz": [round(float(value), 4) for value in vector[:3]]}
    if abs(vector[3]) < 1 - 1e-6:
        keys["quat_wxyz"] = [round(float(value), 5) for value in vector[3:]]
    return keys


def corner_of(form: Mapping[str, Any]) -> FloatArray:
    """The corner of an object at which its size is dragged, in its frame, shape (3,)."""
    corner = np.zeros(3)
    axes = list(AXES[form["kind"]])
    corner[axes] = 0.5 * np.array(form["size"])
    return corner


def resized(
    spec: Mapping[str, Any], form: Mapping[str, Any], pose: SE3, corner: FloatArray
) -> dict[str, Any]:
    """An object whose corner was dragged; the opposite corner stays where it is.

    Args:
        spec: The object as the scenario has it.
        form: The fields of the object on the page.
        pose: The pose T_world_object of the object.
        corner: The new place of the corner in the world, shape (3,).
    """
    kind, axes = form["kind"], list(AXES[form["kind"]])
    before = np.array(form["size"], dtype=float)
    size = np.maximum(0.5 * before + pose.inverse().apply(corner)[axes], SMALLEST)
    shift = np.zeros(3)
    shift[axes] = 0.5 * (size - before)
    moved = SE3(pose.rotation, pose.apply(shift))
    keys = shape_keys(kind, [round(float(value), 4) for value in size])
    return {**spec, kind: keys, "pose": pose_keys_of(moved)}
