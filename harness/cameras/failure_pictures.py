"""A picture of the state that a failed step's explanation speaks of, its goal marked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from harness.cameras.picture_model import PictureModel, build_picture_model
from harness.cameras.recorded_scene import floor_height, poses_at
from harness.cameras.renderer import make_renderer
from harness.cameras.robot_poses import link_poses
from harness.cameras.stills import HEIGHT, INK, WIDTH
from harness.cameras.viewpoint import fit_viewpoint
from harness.core.geometry import Capsule, Rgba, Shape, Sphere, bounding_radius
from harness.core.spatial import SE3, rotation_from_rpy
from harness.core.world import WorldObject
from harness.recording.run import Run, StepRecord
from harness.robot.description import RobotDescription

GOAL, WAY = "goal of the failed step", "from the nearest pose to the goal"
"""Bodies that stand for what is missed; a person's object will hardly have these names."""

AXIS_LENGTH, AXIS_RADIUS = 0.12, 0.006  # [m] of the goal's frame
RED, GREEN, BLUE = (0.85, 0.1, 0.1, 1.0), (0.1, 0.6, 0.1, 1.0), (0.1, 0.2, 0.85, 1.0)
ORANGE: Rgba = (0.95, 0.45, 0.05, 1.0)

ARM_SIZE = 0.12  # [m] a link's share of the view


def draw_failure(
    description: RobotDescription,
    world_objects: Sequence[WorldObject],
    run: Run,
    step: StepRecord,
    file: Path,
    *,
    backend: str = "auto",
) -> None:
    """Write a JPEG of the state in a step's `explanation["nearest"]`, the goal marked in it.

    The goal's frame is red, green, blue (x, y, z), an orange line leads to it from where the link
    comes; objects stand as they did when the step failed, held ones where they would be.

    Args:
        description: The robot.
        world_objects: Everything that took part.
        run: What happened.
        step: A failed one, explained.
        file: To write; its folder exists.
        backend: `auto`, `egl`, `osmesa` or `rays`.
    """
    nearest: Mapping[str, Any] = step.explanation["nearest"]
    joints = nearest["joint_positions"]
    state = np.array([joints[name] for name in description.joint_names])
    sample = min(max(step.end_index - 1, 0), len(run.signals.times) - 1)
    poses = poses_at(description, world_objects, run, sample, step)
    poses |= link_poses(description, state)
    for held in run.attachments:
        if held.start_time <= step.end_time < held.end_time and held.object in poses:
            poses[held.object] = poses[held.link] @ SE3.from_vector(held.pose_in_link)
    marks = _marks(nearest)
    picture = build_picture_model(
        description,
        [*world_objects, *marks],
        floor_height=floor_height(description, world_objects),
        width=WIDTH,
        height=HEIGHT,
    )
    _tint(picture, nearest)
    picture.pose(poses | {mark.name: mark.pose for mark in marks})
    renderer = make_renderer(picture, WIDTH, HEIGHT, backend)
    try:
        points, radii = _in_view(description, poses, marks)
        pixels = renderer.render(fit_viewpoint(points, radii, WIDTH, HEIGHT).view)
    finally:
        renderer.close()
    _write(file, pixels, f"{step.error_code}: {nearest['shows']}{_missed_by(nearest)}")


def _tint(picture: PictureModel, nearest: Mapping[str, Any]) -> None:
    """Redden the two bodies that are deepest in each other."""
    for touch in nearest.get("touches", ())[:1]:
        for name in touch["pair"]:
            if name in picture.geoms:
                colours = picture.rgba[picture.geoms[name]]
                colours[:, :3] = 0.35 * colours[:, :3] + 0.65 * np.array(RED[:3])


def _marks(nearest: Mapping[str, Any]) -> list[WorldObject]:
    """The goal, and the way to it from where the link comes."""
    target = nearest.get("target")
    if target is None:
        return []
    point = np.array(target[:3], dtype=float)
    if len(target) == 7:
        marks = [_mark(GOAL, SE3.from_vector(target), *_frame())]
    else:
        marks = [_mark(GOAL, SE3.from_xyz_rpy(point), Shape(Sphere(0.02), rgba=ORANGE))]
    here = np.array(nearest["pose"][:3], dtype=float)
    away = float(np.linalg.norm(point - here))
    if away > 0.005:
        along = Shape(Capsule(0.003, away), rgba=ORANGE)
        marks.append(_mark(WAY, SE3(_along(point - here), 0.5 * (point + here)), along))
    return marks


def _frame() -> list[Shape]:
    half = 0.5 * AXIS_LENGTH
    turns = ((0, np.pi / 2, 0), (-np.pi / 2, 0, 0), (0, 0, 0))
    return [
        Shape(
            Capsule(AXIS_RADIUS, AXIS_LENGTH),
            SE3(rotation_from_rpy(turn), rotation_from_rpy(turn) @ np.array([0.0, 0.0, half])),
            rgba,
        )
        for turn, rgba in zip(turns, (RED, GREEN, BLUE), strict=True)
    ]


def _along(direction: np.ndarray) -> np.ndarray:
    """A rotation whose z axis points along a direction."""
    z = direction / np.linalg.norm(direction)
    other = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(other, z) / np.linalg.norm(np.cross(other, z))
    return np.stack([x, np.cross(z, x), z], axis=1)


def _mark(name: str, pose: SE3, *shapes: Shape) -> WorldObject:
    return WorldObject(name, shapes, pose, True, 0.0, np.zeros(3), np.zeros((3, 3)))


def _in_view(
    description: RobotDescription, poses: Mapping[str, SE3], marks: Sequence[WorldObject]
) -> tuple[np.ndarray, np.ndarray]:
    """Centres and radii of what must be seen: the arm and the marks."""
    points = [poses[link.name].translation for link in description.links if link.name != "world"]
    radii = [ARM_SIZE] * len(points)
    for mark in marks:
        points.append(mark.pose.translation)
        radii.append(max(bounding_radius(shape) for shape in mark.shapes))
    return np.array(points), np.array(radii)


def _missed_by(nearest: Mapping[str, Any]) -> str:
    shift = float(nearest.get("position_error", 0.0))
    turn = float(np.degrees(nearest.get("orientation_error", 0.0)))
    parts = [f"{1000 * shift:.1f} mm"] if shift > 1e-5 else []
    parts += [f"{turn:.1f} deg"] if turn > 0.05 else []
    if parts:
        return f", {' and '.join(parts)} away"
    for touch in nearest.get("touches", ())[:1]:
        how = "deep" if touch["distance"] < 0 else "apart"
        return f", {' and '.join(touch['pair'])} {1000 * abs(touch['distance']):.1f} mm {how}"
    return ""


def _write(file: Path, pixels: np.ndarray, caption: str) -> None:
    picture = np.ascontiguousarray(pixels[:, :, ::-1])
    picture[-26:] = (0.25 * picture[-26:] + 0.75 * 255).astype(np.uint8)
    font, line = cv2.FONT_HERSHEY_SIMPLEX, cv2.LINE_AA
    cv2.putText(picture, caption[:110], (10, HEIGHT - 9), font, 0.45, INK["failed"], 1, line)
    cv2.imwrite(str(file), picture, [cv2.IMWRITE_JPEG_QUALITY, 92])
