"""A UR's calibration file: where its joints really are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from harness.core.spatial import SE3
from harness.robot.description import Joint
from harness.robot.yaml_data import number, read_data, refuse
from harness.spec.source import Located

JOINTS = {
    "shoulder": "shoulder_pan_joint",
    "upper_arm": "shoulder_lift_joint",
    "forearm": "elbow_joint",
    "wrist_1": "wrist_1_joint",
    "wrist_2": "wrist_2_joint",
    "wrist_3": "wrist_3_joint",
}
"""Section of the file -> joint that it places; as ur_description's kinematics_params."""

FARTHEST = 0.05
"""A calibration that turns a joint by more is another robot's, or in other axes [rad]."""

FARTHEST_REACH = 0.02
"""A calibration that lets the chain of joints reach farther or less far by more, likewise [m]."""


def calibrated(joints: Sequence[Joint], path: Path) -> tuple[Joint, ...]:
    """The joints placed as a calibration file says.

    A single joint may be far from its nominal place, as those of shoulder, elbow and wrist 1,
    whose axes are nearly parallel, are exchangeable along them; what they come to together, with
    all joints at zero, may not.

    Args:
        joints: Of the robot, parents before children; names may have a prefix.
        path: A file as ur_calibration writes it, with `kinematics:` at the top.

    Raises:
        SpecError: The file is none, or of another robot; at line and column.
    """
    root = read_data(path, ("kinematics",), "UR calibration")
    entry = root.mapping().get("kinematics")
    if entry is None:
        refuse(root, "a UR calibration has `kinematics` at the top, as ur_calibration writes it")
    sections = entry.value.mapping()
    placed: dict[str, SE3] = {}
    for section, name in JOINTS.items():
        if section not in sections:
            refuse(entry.value, f"the calibration has no `{section}`")
        joint = next((each.name for each in joints if each.name.endswith(name)), None)
        if joint is None:
            refuse(entry.value, f"the robot has no {name}: the calibration is of a UR arm")
        placed[joint] = _pose(sections[section].value)
    moved = tuple(
        replace(joint, pose=placed[joint.name]) if joint.name in placed else joint
        for joint in joints
    )
    shift, angle = _flange(joints, placed).distance_to(_flange(moved, placed))
    if shift > FARTHEST_REACH or angle > FARTHEST:
        refuse(
            entry.value,
            f"the calibration moves the flange by {1000 * shift:.0f} mm and {angle:.3f} rad with "
            "all joints at zero: it is of another type, or in other axes than the robot's file",
        )
    return moved


def _pose(section: Located) -> SE3:
    values = section.mapping()
    for key in ("x", "y", "z", "roll", "pitch", "yaw"):
        if key not in values:
            refuse(section, f"a calibrated joint has `{key}`")
    xyz = [number(values[key].value) for key in ("x", "y", "z")]
    rpy = [number(values[key].value) for key in ("roll", "pitch", "yaw")]
    return SE3.from_xyz_rpy(xyz, rpy)


def _flange(joints: Sequence[Joint], placed: dict[str, SE3]) -> SE3:
    """Pose of the last of some joints in the first one's parent, all at zero."""
    pose = SE3.identity()
    for joint in joints:
        if joint.name in placed:
            pose = pose @ joint.pose
    return pose
