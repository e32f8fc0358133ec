"""Where everything stood at a recorded sample."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.cameras.robot_poses import link_poses
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.recording.run import ObjectRecord, Run, StepRecord
from harness.robot.description import RobotDescription


def poses_at(
    description: RobotDescription,
    world_objects: Sequence[WorldObject],
    run: Run,
    sample: int,
    step: StepRecord | None = None,
) -> dict[str, SE3]:
    """T_world_body of every link and of every object that was there.

    Simulated objects stand where the physics had them, planning-only ones where they were added, or
    on the link they were attached to.

    Args:
        description: The robot.
        world_objects: Everything that took part.
        run: What happened.
        sample: Index into the signals.
        step: Which of several steps that share the sample is meant; what steps without duration
            change in the moment a motion ends has not happened at its end.
    """
    moment = float(run.signals.times[sample]) if step is None else step.end_time
    is_motion = step is not None and step.end_time > step.start_time
    poses = link_poses(description, run.signals.joint_positions[sample])
    final = float(run.signals.times[-1])
    attached = {
        record.object: poses[record.link] @ SE3.from_vector(record.pose_in_link)
        for record in run.attachments
        if _holds(record.start_time, record.end_time, moment, final)
        or (is_motion and record.end_time == moment)
    }
    records = {record.name: record for record in run.objects}
    for obj in world_objects:
        recorded = run.signals.object_poses.get(obj.name)
        record = records.get(obj.name)
        if recorded is not None:
            if np.isfinite(recorded[sample]).all():
                poses[obj.name] = SE3.from_vector(recorded[sample])
        elif obj.name in attached:
            poses[obj.name] = attached[obj.name]
        elif record is not None and _is_present(record, moment, final, is_motion=is_motion):
            poses[obj.name] = SE3.from_vector(record.pose) if record.pose else obj.pose
    return poses


def _is_present(record: ObjectRecord, moment: float, final: float, *, is_motion: bool) -> bool:
    if is_motion:
        return any(start < moment <= end for start, end in record.present)
    return any(_holds(start, end, moment, final) for start, end in record.present)


def _holds(start: float, end: float, moment: float, final: float) -> bool:
    """Whether an interval holds after what happened at a moment; ends of the run count as open."""
    return start <= moment and (moment < end or end >= final)
