"""Poses of the robot's links, from recorded joint positions."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from harness.core.kinematics import LinkPoses
from harness.core.types import FloatArray
from harness.recording.run import Run
from harness.recording.step_record import StepRecord
from harness.robot.description import RobotDescription

SAMPLES_AT_ONCE = 10_000  # whose matrices of all links take 10 MB


def replayed_link_poses(
    robot: RobotDescription, joint_positions: FloatArray, links: Collection[str] | None = None
) -> dict[str, FloatArray]:
    """T_world_link at every sample, shape (N, 7) each.

    Args:
        joint_positions: Columns in description order, shape (N, n).
        links: The links to return; all when None.
    """
    found: dict[str, list[FloatArray]] = {}
    for first in range(0, max(len(joint_positions), 1), SAMPLES_AT_ONCE):
        part = joint_positions[first : first + SAMPLES_AT_ONCE]
        poses = LinkPoses(robot.joints, part, links)
        for name in poses.rotations if links is None else links:
            if name in poses.rotations:
                found.setdefault(name, []).append(poses.rows(name))
    return {name: np.concatenate(parts) for name, parts in found.items()}


def planned_tcp_poses(
    run: Run, step: StepRecord, joint_names: Sequence[str], positions: FloatArray
) -> FloatArray | None:
    """T_world_tcp where some joints move and the others stay as when the step began.

    Args:
        positions: Their positions, shape (N, joints).

    Returns:
        The poses, shape (N, 7); None where the place of the TCP was not recorded.
    """
    columns = run.robot.joint_index
    if not len(positions) or any(name not in columns for name in joint_names):
        return None
    start = min(step.start_index, len(run.signals.times) - 1)
    rows = np.tile(run.signals.joint_positions[start], (len(positions), 1))
    rows[:, [columns[name] for name in joint_names]] = positions
    robot = run.robot.of_arm.get(step.arm, run.robot)
    return replayed_link_poses(robot, rows, [robot.tcp_link]).get(robot.tcp_link)


def tcp_tracks(run: Run) -> dict[str, FloatArray]:
    """T_world_tcp of each arm as recorded, by its name, shape (N, 7); of one arm under ``.

    An arm whose TCP was not recorded is left out.
    """
    first, *others = run.robot.arms or (None,)
    name = "" if first is None else first.name
    frames = run.signals.frames
    known = {arm.name: frames[arm.tcp_link] for arm in others if arm and arm.tcp_link in frames}
    return {name: run.signals.tcp_pose, **known}
