"""Names of the branches of inverse kinematics: which way an arm is stretched, and its elbow."""

from __future__ import annotations

import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.planning.model.robot_model import GroupSpace

_STRAIGHT = 1e-6  # [m] an elbow this near the line from shoulder to wrist is neither up nor down


def elbow_branch(space: GroupSpace, positions: FloatArray) -> str:
    """`forwards, elbow up`: a turntable (joint 1) is followed by two links (joints 2 and 3).

    Forwards is the side to which the arm is stretched at zero; up is along joint 1's axis.
    """
    joint = space.robot.description.joint_by_name[space.joint_names[0]]
    axis = np.asarray(joint.axis, dtype=float)
    shoulder, elbow, wrist, turntable = _landmarks(space, positions)
    up = turntable.rotation @ axis
    reach = wrist - shoulder
    ahead = reach - up * float(reach @ up)
    forwards = turntable.rotation @ _zero_heading(space, axis)
    side = "forwards" if float(ahead @ forwards) >= 0 else "backwards"
    normal = up - reach * float(up @ reach) / max(float(reach @ reach), 1e-12)
    rise = float((elbow - shoulder) @ normal)
    bend = "straight" if abs(rise) < _STRAIGHT else "up" if rise > 0 else "down"
    return f"{side}, elbow {bend}"


def _landmarks(
    space: GroupSpace, positions: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, SE3]:
    """Origins of joints 2, 3 and 4, and T_world_link1."""
    joints = space.robot.description.joint_by_name
    links = [joints[name].child for name in space.joint_names[:4]]
    poses = [space.robot.link_pose(space.whole(positions), link) for link in links]
    return poses[1].translation, poses[2].translation, poses[3].translation, poses[0]


def _zero_heading(space: GroupSpace, axis: FloatArray) -> FloatArray:
    """Direction from joint 2 to joint 4 at zero, across joint 1's axis, in link 1's frame."""
    shoulder, _, wrist, turntable = _landmarks(space, np.zeros(space.dof))
    ahead = turntable.rotation.T @ (wrist - shoulder)
    return ahead - axis * float(ahead @ axis)
