"""Changes of a recorded run, and of what is expected of it, that no verdict may notice."""

from __future__ import annotations

import math
from dataclasses import fields, is_dataclass, replace

import numpy as np
from pydantic import BaseModel

from harness.core.geometry import Box, Shape
from harness.core.pose_arrays import compose
from harness.core.spatial import SE3
from harness.judging.expectations.placed import Placed
from harness.language.annotations import units_of
from harness.language.poses import Pose, Position
from harness.recording.run import ObjectRecord
from tests.judging.synthetic_run import at

PREFIX = "renamed_"
SCALED = {"m": ("mm", 1e3), "rad": ("deg", 180 / math.pi), "s": ("ms", 1e3), "1": ("%", 100.0),
          "m/s": ("mm/s", 1e3), "rad/s": ("deg/s", 180 / math.pi), "N": ("kN", 1e-3)}  # fmt: skip
"""Another unit for each SI unit, and its number for one of that."""
KEPT_FRAME = "world"


def moved(run, spec, rng, *, turns):
    """The whole world shifted by up to 2 m, and turned about the vertical, and the expectation."""
    angle = rng.uniform(-np.pi, np.pi) if turns else 0.0
    shift = rng.uniform(-2, 2, 3) if turns != "alone" else np.zeros(3)
    whole = SE3.from_xyz_rpy(tuple(shift), (0, 0, angle))
    vector, rotation = np.array(whole.as_vector()), whole.rotation

    def poses(rows):
        return compose(np.broadcast_to(vector, rows.shape), rows)

    def presses(rows):
        return np.hstack([rows[:, :3] @ rotation.T + whole.translation, rows[:, 3:] @ rotation.T])

    signals = run.signals
    signals = replace(
        signals,
        tcp_pose=poses(signals.tcp_pose),
        frames={name: poses(rows) for name, rows in signals.frames.items()},
        object_poses={name: poses(rows) for name, rows in signals.object_poses.items()},
        presses={pair: presses(rows) for pair, rows in signals.presses.items()},
    )
    objects = tuple(
        replace(each, pose=tuple(poses(np.array([each.pose]))[0])) if each.pose else each
        for each in run.objects
    )
    base, *others = run.robot.joints
    pose = SE3.from_vector(poses(base.pose.as_vector()[None])[0])
    robot = replace(run.robot, joints=(replace(base, pose=pose), *others))
    return replace(run, signals=signals, objects=objects, robot=robot), _in_world(spec, whole)


def _in_world(spec, whole, is_free=False):
    """The expectation with its poses in the world moved as the world is.

    Args:
        spec: The expectation, or a part of it.
        whole: How the world is moved.
        is_free: Whether a pose without a rotation allows turns about the vertical.
    """
    if isinstance(spec, Pose):
        if spec.frame != KEPT_FRAME:
            return spec
        pose = whole @ spec.se3()
        if is_free and not spec.has_rotation:
            return Pose(xyz=tuple(pose.translation))
        return Pose(xyz=tuple(pose.translation), quat_wxyz=tuple(pose.quat_wxyz))
    if isinstance(spec, Position):
        x, y, z = whole.apply(np.array(spec.xyz)) if spec.frame == KEPT_FRAME else spec.xyz
        return Position(xyz=(float(x), float(y), float(z)), frame=spec.frame)
    is_free = is_free or isinstance(spec, Placed)
    return _each(spec, lambda value, _: _in_world(value, whole, is_free))


def _each(value, change):
    """A model, or a container of models, with each part changed."""
    if isinstance(value, BaseModel):
        update = {
            name: change(getattr(value, name), type(value).model_fields[name])
            for name in value.model_fields_set
        }
        return value.model_copy(update=update)
    if isinstance(value, tuple):
        return tuple(change(each, None) for each in value)
    return value


def renamed(run, spec):
    """Every link, joint, object, group and state with another name, in run and expectation."""
    robot = run.robot
    names = {record.name for record in run.objects} | set(robot.link_names) - {KEPT_FRAME}
    names |= {joint.name for joint in robot.joints} | set(robot.groups)
    names |= {state.name for state in robot.named_states}
    names |= set(run.robot.gripper.sides) if run.robot.gripper else set()
    names -= {"gripper", ""}  # a word of expectations, and a group that a predicate looks up
    return _with_names(run, names), _with_names(spec, names)


def _with_names(value, names):
    match value:
        case str():
            return PREFIX + value if value in names else value
        case dict():
            return {_with_names(k, names): _with_names(v, names) for k, v in value.items()}
        case tuple() | list():
            return type(value)(_with_names(each, names) for each in value)
        case BaseModel():
            return _each(value, lambda each, _: _with_names(each, names))
        case np.ndarray():
            return value
        case _ if is_dataclass(value):
            kept = ("verb", "status", "kind", "comparison", "error_code")
            update = {
                each.name: _with_names(getattr(value, each.name), names)
                for each in fields(value)
                if each.name not in kept
            }
            return replace(value, **update)
        case _:
            return value


def in_other_units(run, spec):
    """The expectation with its numbers written in another unit, as a file may have them."""
    return run, _rewritten(spec)


def _rewritten(spec):
    given = {}
    for name in spec.model_fields_set:
        value, field = getattr(spec, name), type(spec).model_fields[name]
        units = units_of(field.annotation, field.metadata)
        if isinstance(value, BaseModel):
            value = _rewritten(value)
        elif isinstance(value, float) and len(units) == 1 and units[0] in SCALED:
            unit, factor = SCALED[units[0]]
            value = f"{value * factor!r} {unit}"
        given[field.alias or name] = value
    return type(spec)(**given)


def with_far_object(run, spec):
    """One more object, 100 m away, that nothing touches."""
    count = len(run.signals.times)
    shapes = (Shape(Box((0.1, 0.1, 0.1))),)
    far = ObjectRecord("far_away", False, True, True, shapes, ((0.0, 1e9),), (), 1.0)
    signals = run.signals
    distances = dict(signals.clearances)
    if distances:
        distances["robot", "far_away"] = np.full(count, signals.clearance_cutoff)
    planned = dict(signals.planned_clearances)
    if planned:
        planned["robot", "far_away"] = np.full(count, signals.clearance_cutoff)
    poses = {**signals.object_poses, "far_away": at(count, (100.0, 100.0, 1.0))}
    signals = replace(signals, object_poses=poses, clearances=distances, planned_clearances=planned)
    return replace(run, signals=signals, objects=(*run.objects, far)), spec


def doubled(run, spec):
    """Twice as many samples: poses and joints in between, contacts and distances as before."""
    signals = run.signals
    count = len(signals.times)

    def between(rows):
        whole = np.repeat(np.asarray(rows, dtype=float), 2, axis=0)[:-1]
        whole[1::2] = (whole[:-1:2] + whole[2::2]) / 2
        return whole

    def held(rows):
        return np.repeat(rows, 2, axis=0)[:-1]

    update = {}
    for entry in fields(signals):
        value = getattr(signals, entry.name)
        is_held = entry.name in ("contact_forces", "presses", "support_forces", "clearance_links")
        fill = held if is_held else between
        if isinstance(value, np.ndarray):
            update[entry.name] = fill(value)
        elif isinstance(value, dict):
            update[entry.name] = {key: fill(rows) for key, rows in value.items()}
    steps = tuple(
        replace(
            step,
            start_index=min(2 * step.start_index, 2 * count - 1),
            end_index=max(2 * step.end_index - 1, 2 * step.start_index),
        )
        for step in run.steps
    )
    return replace(run, signals=replace(signals, **update), steps=steps), spec
