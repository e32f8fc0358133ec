"""Names the branches of inverse kinematics: the posture of an arm at joint positions."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.planning.ik.kinematics import CLOSED_FORMS
from harness.planning.model.robot_model import GroupSpace

_STRAIGHT = 1e-6  # [m] an elbow this near the line from shoulder to wrist is neither up nor down


class _Poses(Protocol):
    def link_pose(self, joint_positions: FloatArray, link: str) -> SE3: ...


def branch_name(kinematics: _Poses, space: GroupSpace, method: str, positions: FloatArray) -> str:
    """Name the posture of an arm: `forwards, elbow up, wrist_2_joint < 0`.

    Forwards is the side to which the arm is stretched at zero; up is along joint 1's axis. Both
    require a turntable (joint 1) followed by two links (joints 2 and 3), as for analytic solvers.

    Args:
        kinematics: The kinematics of the robot.
        space: The space of the planning group.
        method: The solver's name; only closed forms have branches, so others' names are empty.
        positions: The positions of the group's joints.
    """
    if method not in CLOSED_FORMS:
        return ""
    shoulder, elbow, wrist, turntable = _landmarks(kinematics, space, positions)
    up = turntable.rotation @ _axis(space)
    reach = wrist - shoulder
    ahead = reach - up * float(reach @ up)
    forwards = turntable.rotation @ _zero_heading(kinematics, space)
    words = ["forwards" if float(ahead @ forwards) >= 0 else "backwards"]
    normal = up - reach * float(up @ reach) / max(float(reach @ reach), 1e-12)
    rise = float((elbow - shoulder) @ normal)
    words.append(
        "elbow straight" if abs(rise) < _STRAIGHT else f"elbow {'up' if rise > 0 else 'down'}"
    )
    if method == "ur":
        turned = float(np.sin(positions[4]))
        words.append(f"{space.joint_names[4]} {'<' if turned < 0 else '>'} 0")
    return ", ".join(words)


def _landmarks(
    kinematics: _Poses, space: GroupSpace, positions: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, SE3]:
    """Origins of joints 2, 3 and 4, and T_world_link1."""
    links = _links(space)
    whole = space.whole(positions)
    poses = [kinematics.link_pose(whole, link) for link in links[:4]]
    return poses[1].translation, poses[2].translation, poses[3].translation, poses[0]


def _zero_heading(kinematics: _Poses, space: GroupSpace) -> FloatArray:
    """Direction from joint 2 to joint 4 at zero, across joint 1's axis, in link 1's frame."""
    shoulder, _, wrist, turntable = _landmarks(kinematics, space, np.zeros(space.dof))
    ahead = turntable.rotation.T @ (wrist - shoulder)
    axis = _axis(space)
    return ahead - axis * float(ahead @ axis)


def _axis(space: GroupSpace) -> FloatArray:
    joint = space.robot.description.joint_by_name[space.joint_names[0]]
    return np.asarray(joint.axis, dtype=float)


def _links(space: GroupSpace) -> list[str]:
    joints = space.robot.description.joint_by_name
    return [joints[name].child for name in space.joint_names]
