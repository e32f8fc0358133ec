"""Poses of all bodies at a recorded sample."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.core.geometry import Plane
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.recording.run import Run
from harness.recording.step_record import StepRecord
from harness.recording.step_results import SceneChange
from harness.robot.description import RobotDescription
from harness.robot.forward_kinematics import robot_poses


def scene_poses(
    description: RobotDescription,
    world_objects: Sequence[WorldObject],
    run: Run,
    sample: int,
    step: StepRecord | None = None,
) -> dict[str, SE3]:
    """T_world_body of every link and of every object in the scene.

    Simulated objects have their pose in the physics, others their pose in the planning scene.

    Args:
        step: Selects one of several steps that share the sample. Changes by steps without duration
            at the moment a motion ends are not part of the motion's end.
    """
    poses = robot_poses(description, run.signals.joint_positions[sample])
    present = _present_after(run, step)
    seen = sample if step is None or step.end_time > step.start_time else sample + 1
    for obj in world_objects:
        recorded = run.signals.object_poses.get(obj.name)
        if recorded is None or (present is not None and obj.name not in present):
            continue
        # changes by a step without duration are in the next sample, if there is one
        rows = recorded[[min(seen, len(recorded) - 1), sample]]
        finite = np.flatnonzero(np.isfinite(rows).all(axis=1))
        if len(finite):
            poses[obj.name] = SE3.from_vector(rows[finite[0]])
    return poses


def floor_height(description: RobotDescription, world_objects: Sequence[WorldObject]) -> float:
    """Height of the floor in pictures [m]: the first plane's, else the base's, at most 0."""
    for obj in world_objects:
        for shape in obj.shapes:
            if isinstance(shape.geometry, Plane):
                return float((obj.pose @ shape.pose).translation[2])
    base = robot_poses(description, description.start_positions())[description.base_link]
    return min(0.0, float(base.translation[2]))


def _present_after(run: Run, step: StepRecord | None) -> set[str] | None:
    """Objects in the scene after a step; None without a step.

    Steps may end at the same time, so this follows the order of the steps and not their times.
    """
    if step is None:
        return None
    places = [each.path for each in run.steps]
    last = places.index(step.path)
    changes = [
        (place, kind, name)
        for place, each in enumerate(run.steps)
        if (change := each.result.find(SceneChange)) is not None
        for kind, names in (("added", change.added), ("removed", change.removed))
        for name in names or ()
    ]
    first = {name: kind for _, kind, name in reversed(changes)}
    present = {name for name in run.signals.object_poses if first.get(name) != "added"}
    for place, kind, name in changes:
        if place <= last:
            (present.add if kind == "added" else present.discard)(name)
    return present
