"""The page on what of robots' files is read, ignored, refused: from the rows that tests hold."""

from __future__ import annotations

from tests.robot.format_rows import Row
from tests.robot.format_tables import TABLES

HEAD = """# Formats of robots

A scenario names the files of a robot as they are:

```yaml
robot:
  urdf: arm.urdf                  # or xacro: arm.xacro, args: {prefix: left_}; or mjcf: arm.xml
  srdf: arm.srdf
  packages: [../src]              # where package:// leads, and what may be read besides
  moveit: {joint_limits: joint_limits.yaml, kinematics: kinematics.yaml}
  kinematics: calibration.yaml    # of a UR, as ur_calibration writes it
```

`package://name/path` is looked up in the robot's own package (the folder with its `package.xml`),
the folders of `packages`, of the option `--package-path` and of HARNESS_PACKAGE_PATH and what lies
in them, beside the robot's package, and among installed Python packages. A robot whose file has no
`package.xml` around it may lie in a folder of that name, at most three levels up. Nothing outside
of these folders is read.

Below: what of each file is *read*, *ignored* or *refused* (an error at its line and column, exit
code 2). *Told* means that `harness check` and every run say so. Each row is a test
(`tests/robot/test_formats.py`). SDF worlds and MoveIt's `.scene` files have a
[page of their own](world_formats.md); other files of a MoveIt configuration
(`ompl_planning.yaml`, controllers, launch files) are not read: a scenario's `planning` says what
they would.
"""


def robot_formats_page() -> str:
    """The page as Markdown."""
    parts = [HEAD]
    for title, key, rows in TABLES.values():
        parts.append(f"## {title}\n\n{key}\n\n| | here | |\n| --- | --- | --- |")
        parts[-1] += "".join(f"\n{_line(row)}" for row in rows) + "\n"
    return "\n".join(parts)


def _line(row: Row) -> str:
    return f"| {row.word} | {row.here} | {row.meaning} |"
