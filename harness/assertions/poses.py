"""Poses of links, objects and frames at each sample."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.assertions.temporal import TIME_RESOLUTION, episodes, trailing_max
from harness.assertions.window import NotObservable, object_record
from harness.core.geometry import bounding_radius
from harness.core.pose_arrays import IDENTITY, rotate
from harness.core.spatial import SE3
from harness.core.types import BoolArray, FloatArray, IntArray
from harness.language.step import step_class
from harness.recording.run import Run
from harness.recording.step_results import SceneChange

UP = np.array([0.0, 0.0, 1.0])
STILL = 0.05
"""What moves at no time during so long is still; a turning point of a swing is not [s]."""
JUMP = 0.005
"""An object that a scene step moves further than this between two samples was put there [m]."""


def link_poses(run: Run, link: str) -> FloatArray:
    """T_world_link, shape (N, 7).

    Raises:
        NotObservable: The link moves and was not recorded.
    """
    robot, count = run.robot, len(run.signals.times)
    if link == "world":
        return np.broadcast_to(IDENTITY, (count, 7))
    if link == robot.tcp_link:
        return run.signals.tcp_pose
    if link in run.signals.frames:
        return run.signals.frames[link]
    if link in robot.static_link_poses:
        return np.broadcast_to(np.array(robot.static_link_poses[link]), (count, 7))
    raise NotObservable(f"the pose of link '{link}' was not recorded")


def object_poses(run: Run, name: str) -> FloatArray:
    """T_world_object, NaN while it is absent, shape (N, 7).

    Raises:
        NotObservable: The run does not know the object, or not where it stood.
    """
    if name in run.signals.object_poses:
        return run.signals.object_poses[name]
    record = object_record(run, name)
    if not record.pose:
        raise NotObservable(f"where '{name}' stood was not recorded")
    return np.where(present(run, name)[:, None], np.array(record.pose), np.nan)


def physical_poses(run: Run, name: str) -> FloatArray:
    """Poses as of `object_poses`, of an object that is in the physics; never the planner's belief.

    Raises:
        NotObservable: The planner alone knows it, or the run does not.
    """
    if any(record.name == name and not record.in_simulation for record in run.objects):
        raise NotObservable(f"{name} is not in the physics: where it is, is the planner's belief")
    return object_poses(run, name)


def frame_poses(run: Run, frame: str) -> FloatArray:
    """T_world_frame of `world`, a link or an object, shape (N, 7)."""
    if frame == "world" or frame in run.robot.link_names:
        return link_poses(run, frame)
    return object_poses(run, frame)


def present(run: Run, name: str) -> BoolArray:
    """Samples at which an object is in the scene, shape (N,).

    The record of its coming and going says so, not whether its pose is known: an object that is
    there and whose pose is missing is not absent. A step that adds an object ends one sample before
    the physics has its first pose.
    """
    times, poses = run.signals.times, run.signals.object_poses.get(name)
    mask = np.zeros(len(times), dtype=bool)
    for begin, end in object_record(run, name).present:
        there = (times >= begin - TIME_RESOLUTION) & (times <= end + TIME_RESOLUTION)
        first = int(np.argmax(there))
        is_added = there[first] and first > 0 and not mask[first - 1]
        if is_added and poses is not None and np.isnan(poses[first, 0]):
            there[first] = False
        mask |= there
    return mask


def frame_present(run: Run, frame: str) -> BoolArray:
    """Samples at which a frame is in the scene: `world` and links always, shape (N,)."""
    if any(record.name == frame for record in run.objects):
        return present(run, frame)
    return np.ones(len(run.signals.times), dtype=bool)


def start_samples(run: Run, name: str) -> IntArray:
    """When the object last appeared or was put somewhere at each sample, -1 before, shape (N,).

    A start is the first sample at which it is present, and the first one after a step moved it,
    however little, or made it jump; without the latter, teleporting would be lifting.
    """
    poses = object_poses(run, name)
    here = present(run, name)
    starts = here & ~np.concatenate([[False], here[:-1]])
    jumps = np.zeros(len(poses))
    jumps[1:] = np.linalg.norm(np.diff(poses[:, :3], axis=0), axis=1)
    for step in run.steps:
        if step_class(step.verb).moves_objects and step.status != "not reached":
            moved = slice(step.start_index, step.end_index + 1)
            change = step.result.find(SceneChange)
            is_moved = change is not None and name in (change.moved or ())
            starts[moved] |= jumps[moved] > (0.0 if is_moved else JUMP)
    return np.maximum.accumulate(np.where(starts, np.arange(len(poses)), -1))


def start_poses(run: Run, name: str) -> FloatArray:
    """The pose of an object at its last start, NaN before the first one, shape (N, 7)."""
    poses, latest = object_poses(run, name), start_samples(run, name)
    return np.where((latest >= 0)[:, None], poses[np.maximum(latest, 0)], np.nan)


def speeds(
    run: Run, poses: FloatArray, here: BoolArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Linear [m/s] and angular [rad/s] speed since the sample before, shape (N,) each.

    The first sample, and that at which an object appears, is at rest by definition. Where this pose
    or the one before is not known the speed is NaN.

    Args:
        run: The run, whose times count.
        poses: T_world_body at each sample, NaN where it is absent or not known, shape (N, 7).
        here: Samples at which it is in the scene; by default those with a pose.
    """
    linear, angular = np.zeros(len(poses)), np.zeros(len(poses))
    missing = np.isnan(poses).any(axis=1)
    if len(poses) > 1:
        step = np.diff(run.signals.times)
        linear[1:] = np.linalg.norm(np.diff(poses[:, :3], axis=0), axis=1) / step
        # chord between quaternions: exact for small turns, and free of the sign
        a, b = poses[:-1, 3:], poses[1:, 3:]
        chord = np.minimum(np.linalg.norm(b - a, axis=1), np.linalg.norm(b + a, axis=1))
        angular[1:] = 4 * np.arcsin(np.minimum(chord / 2, 1.0)) / step
    appeared = np.isnan(linear) & ~missing
    if here is not None:
        appeared &= ~np.append(False, here[:-1])
    linear[appeared] = angular[appeared] = 0.0
    linear[missing] = angular[missing] = np.nan
    return linear, angular


def body_speeds(
    run: Run, name: str, poses: FloatArray, here: BoolArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Linear speed of an object's fastest point [m/s] and its angular speed [rad/s], (N,) each.

    A point of a shape moves at most as fast as the shape's middle, and its distance from there
    times the angular speed. Of a mesh the origin counts.
    """
    linear, angular = speeds(run, poses, here)
    for shape in object_record(run, name).shapes:
        radius = bounding_radius(replace(shape, pose=SE3.identity()))
        if np.isfinite(radius):
            middle = poses.copy()
            middle[:, :3] += rotate(poses[:, 3:], shape.pose.translation)
            linear = np.maximum(linear, speeds(run, middle, here)[0] + angular * radius)
    return linear, angular


def calm(run: Run, speed: FloatArray, here: BoolArray | None = None) -> FloatArray:
    """The largest speed of the last `STILL` seconds at each sample; NaN where it is not known.

    It looks beyond the start of a step, whose window may begin at a turning point.

    Args:
        run: The run, whose times count.
        speed: The speed at each sample, NaN where it is absent or not known, shape (N,).
        here: Samples at which it is in the scene, so that NaN means not known.
    """
    times, unknown = run.signals.times, np.isnan(speed)
    if here is not None:
        unknown = unknown | (trailing_max((unknown & here).astype(np.float64), times, STILL) > 0)
    return np.where(unknown, np.nan, trailing_max(np.nan_to_num(speed, nan=0.0), times, STILL))


def observed_for(run: Run, here: BoolArray, span: float) -> BoolArray:
    """Samples at which something has been there for a span of time [s], shape (N,)."""
    times = run.signals.times
    since = np.full(len(times), np.inf)
    for start, stop in episodes(here):
        since[start:stop] = times[start]
    return times - since >= span - TIME_RESOLUTION
