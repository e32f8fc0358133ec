"""The bodies of the 3D replay: what they look like and where they were, frame by frame."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.geometry import (
    Box,
    Capsule,
    Cylinder,
    Mesh,
    Plane,
    Shape,
    Sphere,
)
from harness.core.types import FloatArray, IntArray
from harness.recording.drawings import MeshRecord
from harness.recording.link_poses import replayed_link_poses
from harness.recording.run import Run
from harness.reporting.html.first_view import FARTHEST, WHOLE_RUN, Framing, first_view, rounded
from harness.reporting.html.packing import Packer, differences, zigzag

FASTEST_RATE, SLOWEST_RATE = 50.0, 10.0  # poses a second, with straight lines between them
MOST_FRAMES = 6000  # poses of a link in the page: two minutes at the fastest rate
STILL = 1e-5  # [m], and of a quaternion's parts: what moves less is drawn as fixed
FULL = 32700  # of 16 bits with a sign, less a reserve for rounding

MeshKey = tuple[Path, tuple[float, float, float]]


def frame_samples(times: FloatArray) -> tuple[float, IntArray]:
    """Time between frames [s], and the sample of each frame."""
    duration = float(times[-1])
    rate = min(FASTEST_RATE, max(SLOWEST_RATE, MOST_FRAMES / max(duration, 1e-9)))
    count = max(2, int(np.ceil(duration * rate)) + 1)
    step = max(duration / (count - 1), 1e-6)
    return step, np.searchsorted(times, np.arange(count) * step - 1e-9).clip(max=len(times) - 1)


def pack_scene(
    run: Run,
    meshes: Sequence[MeshRecord],
    packer: Packer,
    framing: Framing = WHOLE_RUN,
) -> dict[str, Any]:
    """Bodies, meshes, frames and what the first view holds.

    Args:
        framing: What a view holds besides the arm and what it touched.
    """
    step, samples = frame_samples(run.signals.times)
    poses = replayed_link_poses(run.robot, run.signals.joint_positions[samples])
    parts = _mesh_parts(meshes)
    bodies: list[dict[str, Any]] = []
    columns: list[FloatArray] = []

    def add(name: str, shapes: Sequence[Shape], rows: FloatArray, **more: Any) -> None:
        body = {"name": name, "shapes": [plain_shape(shape, parts) for shape in shapes], **more}
        moves = len(rows) > 1 and bool(np.ptp(rows, axis=0).max() > STILL)
        body["fixed"] = None if moves else rounded(rows[0])
        if moves:
            body["column"] = len(columns)
            columns.append(rows)
        bodies.append(body)

    always = [[0.0, float(run.signals.times[-1])]]
    links = {link.name: link for link in run.robot.links}
    for name in dict.fromkeys([*run.robot.link_visuals, run.robot.tcp_link]):
        if name in poses:
            looks, link = run.robot.link_visuals.get(name, ()), links[name]
            hidden = [plain_shape(shape, parts) for shape in link.collisions]
            mass = None if link.inertial is None else link.inertial.mass
            add(
                name,
                looks,
                poses[name],
                shown=always,
                ghost=False,
                isLink=True,
                mass=mass,
                line=0,
                collisions=[shape for shape in hidden if shape.get("parts") != []],
            )
    for obj in run.objects:
        recorded = run.signals.object_poses.get(obj.name)
        known = _filled(recorded[samples]) if recorded is not None else None
        rows = np.array([obj.pose]) if known is None and obj.pose else known
        if rows is None:
            continue
        shown = always if recorded is None else _shown(run.signals.times, recorded)
        ghost = not obj.in_simulation
        hidden = [plain_shape(shape, parts) for shape in obj.shapes if obj.visuals]
        add(
            obj.name,
            obj.looks,
            rows,
            shown=shown,
            ghost=ghost,
            isLink=False,
            mass=obj.mass if np.isfinite(obj.mass) and not obj.is_static else None,
            line=line_of(run.source, obj.name),
            collisions=hidden,
        )
    unit = _pack_poses(columns, len(samples), packer)
    commanded = replayed_link_poses(run.robot, _commanded(run)[samples])
    moving = [body["name"] for body in bodies if body["isLink"] and body["fixed"] is None]
    _pack_apart(
        [poses[name] for name in moving], [commanded[name] for name in moving], unit, packer
    )
    return {
        "bodies": bodies,
        "meshes": [pack_mesh(mesh, number, packer) for number, mesh in enumerate(meshes)],
        "frames": {"count": len(samples), "step": step, "unit": unit},
        "toolBody": run.robot.tcp_link,
        **first_view(run, poses, step, framing),
    }


def _mesh_parts(meshes: Sequence[MeshRecord]) -> dict[MeshKey, list[list[Any]]]:
    """For each mesh file: the numbers of its parts, with their colours."""
    parts: dict[MeshKey, list[list[Any]]] = {}
    for number, mesh in enumerate(meshes):
        colour = None if mesh.rgba is None else rounded(mesh.rgba, 3)
        parts.setdefault((mesh.path, mesh.scale), []).append([number, colour])
    return parts


def plain_shape(shape: Shape, meshes: Mapping[MeshKey, list[list[Any]]]) -> dict[str, Any]:
    """A shape as pages draw it; a mesh as the numbers of its parts, with their colours."""
    plain: dict[str, Any] = {
        "pose": rounded(shape.pose.as_vector()),
        "color": rounded(shape.rgba, 3),
    }
    match shape.geometry:
        case Box(size=size):
            return plain | {"kind": "box", "size": list(size)}
        case Cylinder(radius=radius, length=length):
            return plain | {"kind": "cylinder", "radius": radius, "length": length}
        case Capsule(radius=radius, length=length):
            return plain | {"kind": "capsule", "radius": radius, "length": length}
        case Sphere(radius=radius):
            return plain | {"kind": "sphere", "radius": radius}
        case Plane():
            return plain | {"kind": "plane"}
        case Mesh(path=path, scale=scale):
            return plain | {"kind": "mesh", "parts": meshes.get((path, scale), [])}


def _commanded(run: Run) -> FloatArray:
    """Commanded joint positions; measured ones where nothing commands."""
    commands = run.signals.joint_commands
    return np.where(np.isfinite(commands), commands, run.signals.joint_positions)


def _pack_apart(
    measured: Sequence[FloatArray], commanded: Sequence[FloatArray], unit: float, packer: Packer
) -> None:
    """Put in how far commanded poses are from measured ones, in the units of these."""
    apart: list[IntArray] = []
    for one, two in zip(measured, commanded, strict=True):
        sign = np.where(np.sum(one[:, 3:] * two[:, 3:], axis=1) < 0, -1.0, 1.0)[:, None]
        turn = sign * two[:, 3:] - one[:, 3:]
        apart += list(np.rint(np.hstack([(two - one)[:, :3] / unit, turn * FULL])).astype(int).T)
    packer.add("commanded", differences(np.array(apart or np.zeros((0, 1)))))


def _pack_poses(columns: Sequence[FloatArray], count: int, packer: Packer) -> float:
    """Put moving poses in, as 16-bit numbers; returns the unit of positions [m]."""
    stacked = np.stack(columns, axis=1) if columns else np.zeros((count, 0, 7))
    positions = np.clip(stacked[:, :, :3], -FARTHEST, FARTHEST)
    unit = max(float(np.abs(positions).max(initial=0.0)) / FULL, 1e-6)
    quats = stacked[:, :, 3:]
    turns = np.sum(quats[1:] * quats[:-1], axis=2)
    signs = np.cumprod(np.where(turns < 0, -1.0, 1.0), axis=0)
    quats = np.concatenate([quats[:1], quats[1:] * signs[:, :, None]])
    whole = np.concatenate([np.rint(positions / unit), np.rint(quats * FULL)], axis=2)
    packer.add("poses", differences(whole.reshape(count, -1).T))
    return unit


def _filled(rows: FloatArray) -> FloatArray | None:
    """Poses with those that are missing as the last one known, or the first."""
    known = np.isfinite(rows).all(axis=1)
    if not known.any():
        return None
    last = np.maximum.accumulate(np.where(known, np.arange(len(rows)), -1))
    return rows[np.where(last < 0, int(known.argmax()), last)]


def _shown(times: FloatArray, recorded: FloatArray) -> list[list[float]]:
    """Intervals of time in which a body was there [s]."""
    there = np.isfinite(recorded[:, 0]).astype(np.int8)
    edges = np.flatnonzero(np.diff(there, prepend=0, append=0))
    starts, ends = edges[::2], edges[1::2] - 1
    return [[float(times[a]), float(times[b])] for a, b in zip(starts, ends, strict=True)]


def line_of(source: str, name: str) -> int:
    """The line of a file that defines an object, as `name: can` or as a key; 0 if none does."""
    word = re.escape(name)
    defines = re.compile(rf"""\bname:\s*["']?{word}["']?\s*(?:[,}}#]|$)|^[\s-]*["']?{word}["']?:""")
    lines = source.splitlines()
    return next((number for number, line in enumerate(lines, 1) if defines.search(line)), 0)


SMALLEST = 1e-9  # [m], extent of a flat mesh, by which it is divided
STEPS = 65535  # of a mesh's extent, in 16 bits


def pack_mesh(mesh: MeshRecord, number: int, packer: Packer) -> dict[str, Any]:
    """Put a mesh into the page's data, vertices in the order in which faces use them."""
    used, first, faces = np.unique(mesh.faces.ravel(), return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(used), dtype=np.int64)
    rank[order] = np.arange(len(used))
    vertices = mesh.vertices[used[order]]
    low = vertices.min(axis=0) if len(vertices) else np.zeros(3)
    size = np.ptp(vertices, axis=0) if len(vertices) else np.zeros(3)
    stored = np.rint((vertices - low) / np.maximum(size, SMALLEST) * STEPS)
    indices = zigzag(rank[faces.ravel()])
    return {
        "vertices": packer.add(f"mesh.{number}.vertices", differences(stored.T)),
        "faces": packer.add(f"mesh.{number}.faces", indices),
        "wide": bool(indices.dtype == np.uint32),
        "low": low.tolist(),
        "size": size.tolist(),
    }
