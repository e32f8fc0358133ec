"""The page on what of robots' files is read, ignored, refused: from the rows that tests hold."""

from __future__ import annotations

from tests.robot.format_rows import TABLES, Row

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
in them, beside the robot's package, and among installed Python packages. Nothing outside of these folders is read.

Below: what of each file is *read*, *ignored* or *refused* (an error at its line and column, exit
code 2). *Told* means that `harness check` and every run say so. Each row is a test
(`tests/robot/format_rows.py`). SDF worlds and MoveIt's `.scene` files have a
[page of their own](../worlds/FORMATS.md); other files of a MoveIt configuration
(`ompl_planning.yaml`, controllers, launch files) are not read: a scenario's `planning` says what
they would.
"""

TAIL = """## xacro

Rendered by the xacro library, without ROS, in a process of its own: expressions are Python, and may
read the given folders, start and write nothing, and use bounded time and memory. `$(find name)` and
`package://` lead to the same places, `$(arg ...)` to `args`; `$(env ...)` is refused. Mistakes are
told at the file and line they are written in, included files too
(`tests/robot/test_xacro.py`).

## MJCF

Read as MuJoCo compiles it: bodies, hinges, slides, geoms, sites as frames, joint equalities as
mimics, keyframes as states, contact exclusions as allowed pairs, force limits of joints and
actuators as efforts. Ignored, told: actuators otherwise (every joint is driven by the program's own
servo), sensors, tendons, geoms of the world, bodies that are free. Refused: plugins, bodies that
bend, attached models, slides without a range (`tests/robot/test_mjcf.py`).

## UR calibration

`kinematics` takes the file that ur_calibration writes: the six joints stand as it says, for
planner and physics alike (`tests/robot/test_calibration.py`). It fits arms with a UR's joints.
"""


def robot_formats_page() -> str:
    """The page as Markdown."""
    parts = [HEAD]
    for title, key, rows in TABLES.values():
        parts.append(f"## {title}\n\n{key}\n\n| | here | |\n| --- | --- | --- |")
        parts[-1] += "".join(f"\n{_line(row)}" for row in rows) + "\n"
    return "\n".join([*parts, TAIL])


def _line(row: Row) -> str:
    return f"| {row.word} | {row.here} | {row.meaning} |"
