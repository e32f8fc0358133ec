"""Poses of the robot's links, from recorded joint positions."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from harness.core.kinematics import LinkJoint, LinkPoses
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.recording.robot_record import LinkPlacement, RobotRecord
from harness.recording.run import Run
from harness.recording.step_record import StepRecord


def replayed_link_poses(
    robot: RobotRecord, joint_positions: FloatArray, links: Collection[str] | None = None
) -> dict[str, FloatArray]:
    """T_world_link at every sample, shape (N, 7) each.

    Args:
        joint_positions: Columns in the order of `robot.joints`, shape (N, n).
        links: The links to return; all when None.
    """
    columns = {joint.name: column for column, joint in enumerate(robot.joints)}
    moving = [columns[placement.joint] for placement in robot.placements if placement.joint]
    joints = [_joint(placement) for placement in robot.placements]
    poses = LinkPoses(joints, joint_positions[:, moving], links)
    names = poses.rotations if links is None else links
    return {name: poses.rows(name) for name in names if name in poses.rotations}


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
    return replayed_link_poses(run.robot, rows, [run.robot.tcp_link]).get(run.robot.tcp_link)


def placement_poses(placement: LinkPlacement, positions: FloatArray) -> FloatArray:
    """T_parent_link at positions [rad or m] of the joint that moves it, (N,) -> (N, 7)."""
    return LinkPoses([_joint(placement)], positions[:, None]).rows(placement.link)


def _joint(placement: LinkPlacement) -> LinkJoint:
    kind = "prismatic" if placement.slides else "revolute" if placement.joint else "fixed"
    return LinkJoint(
        placement.joint,
        kind,
        placement.parent,
        placement.link,
        SE3.from_vector(placement.pose),
        np.array(placement.axis),
    )
