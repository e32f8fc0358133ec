"""A picture of the state in a failed step's explanation, with its goal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from harness.cameras.marks import GOAL, ORANGE, RED, frame_mark, line_mark, mark
from harness.core.geometry import Shape, Sphere, bounding_radius
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.plugins.cameras.camera_scene import floor_height, scene_poses
from harness.plugins.cameras.caption import captioned_jpeg
from harness.plugins.cameras.picture_model import PictureModel, build_picture_model
from harness.plugins.cameras.renderer import render_overview
from harness.plugins.cameras.stills import HEIGHT, LINK_RADIUS, WIDTH
from harness.recording.explanation import NearestState, recorded_explanation
from harness.recording.run import Run
from harness.recording.step_record import StepRecord
from harness.robot.description import RobotDescription


def draw_failure(
    description: RobotDescription,
    world_objects: Sequence[WorldObject],
    run: Run,
    step: StepRecord,
) -> bytes:
    """A JPEG file of the state that explains a failed step, with the goal.

    The axes x, y, z of the goal's frame are red, green, blue; an orange line connects the link with
    it. Objects are where they were when the step failed, attached ones move with their link.

    Args:
        step: A failed step that has an explanation.
    """
    nearest = recorded_explanation(step.explanation).nearest
    if nearest is None:
        raise ValueError(f"step {step.id} has no state to draw")
    state = np.array([nearest.joint_positions[name] for name in description.joint_names])
    sample = min(max(step.end_index - 1, 0), len(run.signals.times) - 1)
    poses = scene_poses(description, world_objects, run, sample, step)
    poses |= description.link_poses(state)
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
    points, radii = _in_view(description, poses, marks)
    pixels = render_overview(picture, points, radii, WIDTH, HEIGHT)
    return captioned_jpeg(pixels, f"{step.error_code}: {nearest.shows}{_missed_by(nearest)}")


def _tint(picture: PictureModel, nearest: NearestState) -> None:
    """Tint the two bodies of the deepest contact red."""
    for touch in (nearest.touches or ())[:1]:
        for name in touch.pair:
            if name in picture.geoms:
                colours = picture.rgba[picture.geoms[name]]
                colours[:, :3] = 0.35 * colours[:, :3] + 0.65 * np.array(RED[:3])


def _marks(nearest: NearestState) -> list[WorldObject]:
    """The goal, and a line to it from the link's nearest pose."""
    target = nearest.target
    if target is None or nearest.pose is None:
        return []
    point = np.array(target[:3], dtype=float)
    if len(target) == 7:
        marks = [frame_mark(SE3.from_vector(target))]
    else:
        marks = [mark(GOAL, SE3.from_xyz_rpy(point), Shape(Sphere(0.02), rgba=ORANGE))]
    line = line_mark(np.array(nearest.pose[:3]), point)
    return marks if line is None else [*marks, line]


def _in_view(
    description: RobotDescription, poses: Mapping[str, SE3], marks: Sequence[WorldObject]
) -> tuple[np.ndarray, np.ndarray]:
    """Centres and radii of the bodies that the view contains: the arm and the marks."""
    points = [poses[link.name].translation for link in description.links if link.name != "world"]
    radii = [LINK_RADIUS] * len(points)
    for each in marks:
        points.append(each.pose.translation)
        radii.append(max(bounding_radius(shape) for shape in each.shapes))
    return np.array(points), np.array(radii)


def _missed_by(nearest: NearestState) -> str:
    shift = nearest.position_error or 0.0
    turn = float(np.degrees(nearest.orientation_error or 0.0))
    parts = [f"{1000 * shift:.1f} mm"] if shift > 1e-5 else []
    parts += [f"{turn:.1f} deg"] if turn > 0.05 else []
    if parts:
        return f", {' and '.join(parts)} away"
    for touch in (nearest.touches or ())[:1]:
        how = "deep" if touch.distance < 0 else "apart"
        return f", {' and '.join(touch.pair)} {1000 * abs(touch.distance):.1f} mm {how}"
    return ""
