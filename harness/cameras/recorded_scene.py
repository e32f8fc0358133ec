"""Where everything stood at a recorded sample."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.cameras.robot_poses import link_poses
from harness.core.geometry import Plane
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.recording.run import Run, StepRecord
from harness.robot.description import RobotDescription


def poses_at(
    description: RobotDescription,
    world_objects: Sequence[WorldObject],
    run: Run,
    sample: int,
    step: StepRecord | None = None,
) -> dict[str, SE3]:
    """T_world_body of every link and of every object that was there.

    Simulated objects stand where the physics had them, others where the planner believed
    them.

    Args:
        description: The robot.
        world_objects: Everything that took part.
        run: What happened.
        sample: Index into the signals.
        step: Which of several steps that share the sample is meant; what steps without duration
            change in the moment a motion ends has not happened at its end.
    """
    poses = link_poses(description, run.signals.joint_positions[sample])
    there = _present_after(run, step)
    seen = sample if step is None or step.end_time > step.start_time else sample + 1
    for obj in world_objects:
        recorded = run.signals.object_poses.get(obj.name)
        if recorded is None or (there is not None and obj.name not in there):
            continue
        # what a step without duration changed shows in the next sample, if there is one
        rows = recorded[[min(seen, len(recorded) - 1), sample]]
        finite = np.flatnonzero(np.isfinite(rows).all(axis=1))
        if len(finite):
            poses[obj.name] = SE3.from_vector(rows[finite[0]])
    return poses


def floor_height(description: RobotDescription, world_objects: Sequence[WorldObject]) -> float:
    """Z of the floor that pictures show [m]: the first plane's, else the base's, at most 0."""
    for obj in world_objects:
        for shape in obj.shapes:
            if isinstance(shape.geometry, Plane):
                return float((obj.pose @ shape.pose).translation[2])
    base = link_poses(description, description.start_positions())[description.base_link]
    return min(0.0, float(base.translation[2]))


def _present_after(run: Run, step: StepRecord | None) -> set[str] | None:
    """Objects in the scene once a step is over; None when no step is meant.

    Several steps may share a moment, so this follows what each did rather than when it did.
    """
    if step is None:
        return None
    places = [each.path for each in run.steps]
    last = places.index(step.path)
    changes = [
        (place, kind, name)
        for place, each in enumerate(run.steps)
        for kind in ("added", "removed")
        for name in each.result.get(kind, ())
    ]
    first = {name: kind for _, kind, name in reversed(changes)}
    there = {name for name in run.signals.object_poses if first.get(name) != "added"}
    for place, kind, name in changes:
        if place <= last:
            (there.add if kind == "added" else there.discard)(name)
    return there
