"""The tables of docs/reference/robot_formats.md, with the files that their rows change."""

from __future__ import annotations

from typing import Any

import trimesh

from tests.robot.arm_files import SRDF, URDF
from tests.robot.format_rows import (
    END,
    HAND,
    KINEMATICS,
    KINEMATICS_ROWS,
    LIMITS,
    LIMITS_ROWS,
    SRDF_ROWS,
    URDF_ROWS,
    Row,
)
from tests.robot.mjcf_arm import MJCF, TIP
from tests.robot.more_format_rows import CALIBRATION_ROWS, MJCF_ROWS, PARTS, XACRO, XACRO_ROWS
from tests.robot.sdf_format_rows import SDF, SDF_ROWS
from tests.robot.ur_calibration import calibration_text
from tests.world.sdf_files import ASCII_STL, COLLADA, TETRAHEDRON

SOLID = trimesh.creation.box((0.1, 0.1, 0.1))
FILES = {
    "arm.urdf": URDF.replace(END, HAND + END),
    "arm.srdf": SRDF,
    "limits.yaml": LIMITS,
    "kinematics.yaml": KINEMATICS,
    "arm.xacro": XACRO,
    "arm.xml": MJCF,
    "arm.sdf": SDF,
    "calibration.yaml": calibration_text(),
}
NEXT_TO_THEM = {
    "part.stl": ASCII_STL,
    "part.obj": TETRAHEDRON,
    "part.dae": COLLADA,
    **{f"part.{kind}": str(SOLID.export(file_type=kind), "latin-1") for kind in ("ply", "glb")},
    "part.3ds": "3ds",
    "assets/t.obj": TIP,
    **PARTS,
    **{f"parts/{name}": text for name, text in PARTS.items()},
}
"""Files that a row may name."""

MOVEIT = {"joint_limits": "limits.yaml", "kinematics": "kinematics.yaml"}
OTHER_WORDS: dict[str, dict[str, Any]] = {
    "arm.xacro": {"xacro": "arm.xacro", "srdf": "arm.srdf", "packages": ["."]},
    "arm.xml": {"mjcf": "arm.xml", "tcp_link": "tcp"},
    "arm.sdf": {"sdf": "arm.sdf"},
    "calibration.yaml": {"model": "ur5e", "kinematics": "calibration.yaml"},
}


def words(file: str) -> dict[str, Any]:
    """The scenario's `robot:` that reads a file."""
    return OTHER_WORDS.get(file, {"urdf": "arm.urdf", "srdf": "arm.srdf", "moveit": MOVEIT})


TABLES: dict[str, tuple[str, str, tuple[Row, ...]]] = {
    "arm.urdf": ("URDF", "`robot: {urdf: ...}`, or `xacro:` with `args:`", URDF_ROWS),
    "arm.xacro": (
        "xacro",
        "`robot: {xacro: ..., args: {...}}`; rendered without ROS, as the `xacro` package renders"
        " it.\nMistakes are reported at the file and line they are written in, included files too.",
        XACRO_ROWS,
    ),
    "arm.srdf": (
        "SRDF",
        "`robot: {srdf: ...}` with a URDF, xacro, MJCF or SDF file; one in xacro takes `args:` too",
        SRDF_ROWS,
    ),
    "arm.xml": ("MJCF", "`robot: {mjcf: ...}`", MJCF_ROWS),
    "arm.sdf": (
        "SDF",
        "`robot: {sdf: ...}`, SDFormat 1.4 to 1.11: a model, or a world with one model of a robot;"
        "\n`srdf` and the other keys go with it as with a URDF",
        SDF_ROWS,
    ),
    "limits.yaml": (
        "MoveIt: joint_limits.yaml",
        "`robot: {moveit: {joint_limits: ...}}`",
        LIMITS_ROWS,
    ),
    "kinematics.yaml": (
        "MoveIt: kinematics.yaml",
        "`robot: {moveit: {kinematics: ...}}`",
        KINEMATICS_ROWS,
    ),
    "calibration.yaml": (
        "UR calibration",
        "`robot: {kinematics: ...}`: what ur_calibration writes, for arms with a UR's joints",
        CALIBRATION_ROWS,
    ),
}
"""By file: the heading, what names it, its rows."""
