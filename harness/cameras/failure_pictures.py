"""A picture of the state that a failed step's explanation speaks of, its goal marked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from harness.cameras.caption import write_captioned
from harness.cameras.marks import GOAL, ORANGE, RED, frame_mark, mark, way_mark
from harness.cameras.picture_model import PictureModel, build_picture_model
from harness.cameras.recorded_scene import floor_height, poses_at
from harness.cameras.renderer import make_renderer
from harness.cameras.robot_poses import link_poses
from harness.cameras.stills import HEIGHT, WIDTH
from harness.cameras.viewpoint import fit_viewpoint
from harness.core.geometry import Shape, Sphere, bounding_radius
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.recording.run import Run, StepRecord
from harness.robot.description import RobotDescription

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
    write_captioned(file, pixels, f"{step.error_code}: {nearest['shows']}{_missed_by(nearest)}")


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
        marks = [frame_mark(SE3.from_vector(target))]
    else:
        marks = [mark(GOAL, SE3.from_xyz_rpy(point), Shape(Sphere(0.02), rgba=ORANGE))]
    way = way_mark(np.array(nearest["pose"][:3], dtype=float), point)
    return marks if way is None else [*marks, way]


def _in_view(
    description: RobotDescription, poses: Mapping[str, SE3], marks: Sequence[WorldObject]
) -> tuple[np.ndarray, np.ndarray]:
    """Centres and radii of what must be seen: the arm and the marks."""
    points = [poses[link.name].translation for link in description.links if link.name != "world"]
    radii = [ARM_SIZE] * len(points)
    for each in marks:
        points.append(each.pose.translation)
        radii.append(max(bounding_radius(shape) for shape in each.shapes))
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
