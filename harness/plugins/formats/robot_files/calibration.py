"""Calibration files of UR arms: the measured poses of their joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from harness.core.spatial import SE3
from harness.language.files.source import Located
from harness.plugins.formats.yaml_data import number, read_data, refuse
from harness.robot.mechanism import Joint

JOINTS = {
    "shoulder": "shoulder_pan_joint",
    "upper_arm": "shoulder_lift_joint",
    "forearm": "elbow_joint",
    "wrist_1": "wrist_1_joint",
    "wrist_2": "wrist_2_joint",
    "wrist_3": "wrist_3_joint",
}
"""Joint of each section of the file, as in ur_description's kinematics_params."""

FARTHEST = 0.05  # Largest rotation of the flange by a calibration of the same robot and axes [rad]

FARTHEST_REACH = 0.02
"""Largest displacement of the flange by a calibration of the same robot and axes [m]."""


def calibrated(joints: Sequence[Joint], path: Path) -> tuple[Joint, ...]:
    """The joints with the poses of a calibration file.

    A single joint may be far from its nominal pose: shoulder, elbow and wrist 1 have nearly
    parallel axes, along which their offsets are interchangeable. The flange's pose with all joints
    at zero may not be far from the nominal one.

    Args:
        joints: The robot's joints, parents before children; names may have a prefix.
        path: A file of ur_calibration, with `kinematics:` at the top.

    Raises:
        SpecError: The file is invalid, or of another robot; at line and column.
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
    """Pose of the last joint's child in the first joint's parent, with all joints at zero."""
    pose = SE3.identity()
    for joint in joints:
        if joint.name in placed:
            pose = pose @ joint.pose
    return pose
