"""Poses of the robot's links, from recorded joint positions."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from harness.core.pose_arrays import IDENTITY, compose
from harness.core.types import FloatArray
from harness.recording.robot_record import LinkPlacement, RobotRecord
from harness.recording.run import Run
from harness.recording.step_record import StepRecord


def replayed_link_poses(
    robot: RobotRecord, joint_positions: FloatArray, links: Collection[str] | None = None
) -> dict[str, FloatArray]:
    """T_world_link at every sample, shape (N, 7) each; (1, 7) of links that cannot move.

    Args:
        joint_positions: Columns in the order of `robot.joints`, shape (N, n).
        links: The links to return; all when None.
    """
    needed = None if links is None else _with_carriers(robot, links)
    columns = {joint.name: column for column, joint in enumerate(robot.joints)}
    poses: dict[str, FloatArray] = {}
    for placement in robot.placements:
        parent = poses.setdefault(placement.parent, IDENTITY[None])
        if needed is not None and placement.link not in needed:
            continue
        moved = joint_positions[:, columns[placement.joint]] if placement.joint else None
        poses[placement.link] = compose(parent, placement_poses(placement, moved))
    return poses if links is None else {name: poses[name] for name in links if name in poses}


def planned_tcp_poses(
    run: Run, step: StepRecord, joint_names: Sequence[str], positions: FloatArray
) -> FloatArray | None:
    """T_world_tcp where some joints move and the others stay as when the step began.

    Args:
        run: The run, whose robot and joint positions count.
        step: The step that plans the motion.
        joint_names: The joints that move.
        positions: Their positions, shape (N, joints).

    Returns:
        The poses, shape (N, 7); None where the placement of the TCP was not recorded.
    """
    columns = {joint.name: column for column, joint in enumerate(run.robot.joints)}
    if not len(positions) or any(name not in columns for name in joint_names):
        return None
    start = min(step.start_index, len(run.signals.times) - 1)
    rows = np.tile(run.signals.joint_positions[start], (len(positions), 1))
    rows[:, [columns[name] for name in joint_names]] = positions
    poses = replayed_link_poses(run.robot, rows, [run.robot.tcp_link]).get(run.robot.tcp_link)
    return None if poses is None else np.broadcast_to(poses, (len(rows), 7))


def _with_carriers(robot: RobotRecord, links: Collection[str]) -> set[str]:
    """The links, and all that they hang on: the others cost memory for nothing."""
    needed = set(links)
    for placement in reversed(robot.placements):
        if placement.link in needed:
            needed.add(placement.parent)
    return needed


def placement_poses(placement: LinkPlacement, positions: FloatArray | None) -> FloatArray:
    """T_parent_link at positions of its joint, shape (N, 7); (1, 7) when it is fixed.

    Args:
        placement: How the link hangs.
        positions: The positions of its joint [rad or m], shape (N,); None when it has none.
    """
    pose = np.array([placement.pose])
    return pose if positions is None else compose(pose, _motion(placement, positions))


def _motion(placement: LinkPlacement, positions: FloatArray) -> FloatArray:
    motion = np.tile(IDENTITY, (len(positions), 1))
    if placement.slides:
        motion[:, :3] = positions[:, None] * np.array(placement.axis)
    else:
        motion[:, 3] = np.cos(0.5 * positions)
        motion[:, 4:] = np.sin(0.5 * positions)[:, None] * np.array(placement.axis)
    return motion
