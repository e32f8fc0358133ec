"""Poses of links, objects and frames at each sample."""

from __future__ import annotations

import numpy as np

from harness.core.pose_arrays import IDENTITY
from harness.core.types import BoolArray, FloatArray, IntArray
from harness.judging.temporal import TIME_RESOLUTION, episodes
from harness.judging.window import NotObservable, object_record, put_samples
from harness.language.step import step_class
from harness.recording.run import Run
from harness.recording.step_results import SceneChange

UP = np.array([0.0, 0.0, 1.0])
JUMP = 0.005  # [m]; a scene step that moves an object further between samples put it there


def link_poses(run: Run, link: str) -> FloatArray:
    """T_world_link, shape (N, 7).

    Raises:
        NotObservable: The link moves and was not recorded.
    """
    robot, count = run.robot, len(run.signals.times)
    if link == "world":
        return np.broadcast_to(IDENTITY, (count, 7))
    if link == robot.recorded_tcp:
        return run.signals.tcp_pose
    if link in run.signals.frames:
        return run.signals.frames[link]
    if link in robot.static_link_poses:
        return np.broadcast_to(robot.static_link_poses[link], (count, 7))
    raise NotObservable(f"the pose of link '{link}' was not recorded")


def tcp_poses(run: Run) -> FloatArray:
    """T_world_tcp of the selected arm, shape (N, 7)."""
    return link_poses(run, run.robot.tcp_link)


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


def arrivals(run: Run, name: str) -> IntArray:
    """Samples at which an object appears or is put somewhere else, ascending."""
    changes = np.diff(present(run, name).astype(np.int8), prepend=0)
    return np.union1d(np.flatnonzero(changes > 0), put_samples(run, name))


def start_samples(run: Run, name: str) -> IntArray:
    """When the object last appeared or was put somewhere at each sample, -1 before, shape (N,).

    A start is the first sample at which it is present, and the first one after a step moved it,
    however little, or made it jump; without the latter, teleporting would be lifting.
    """
    poses = object_poses(run, name)
    starts = np.zeros(len(poses), dtype=bool)
    starts[arrivals(run, name)] = True
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


def observed_for(run: Run, here: BoolArray, span: float) -> BoolArray:
    """Samples at which something has been there for a span of time [s], shape (N,)."""
    times = run.signals.times
    since = np.full(len(times), np.inf)
    for start, stop in episodes(here):
        since[start:stop] = times[start]
    return times - since >= span - TIME_RESOLUTION
