"""The page on robot file formats, made from the rows that tests hold."""

from __future__ import annotations

from collections.abc import Iterable

from harness.plugins.formats.unit_tags import UNITS
from harness.plugins.formats.xacro.functions import BUILTINS, MATH, METHODS, PYTHON
from tests.robot.format_rows import Row
from tests.robot.format_tables import TABLES

HEAD = """\
# Robot file formats

A scenario names the files of a robot as they are:

```yaml
robot:
  urdf: arm.urdf                  # or xacro, with args: {prefix: left_}; or mjcf; or sdf
  srdf: arm.srdf
  packages: [../src]              # folders for package://, which may be read too
  moveit: {joint_limits: joint_limits.yaml, kinematics: kinematics.yaml}
  kinematics: calibration.yaml    # of a UR, as ur_calibration writes it
```

`package://name/path` is looked up in the robot's own package (the folder with its `package.xml`);
in the folders of `packages`, of the option `--package-path` and of HARNESS_PACKAGE_PATH, and in
their subfolders; next to the robot's package; and among installed Python packages. A robot
without a `package.xml` may be in a folder with the package's name, at most three levels up. A
robot that is named as `package://name/path` itself reads in all of that package. No file outside
these folders is read. A robot in SDF finds models and meshes as an SDF world does too: in its own
folder and the folder `models` in it, in `packages`, and in those of GZ_SIM_RESOURCE_PATH.

The tables list what is *read*, *ignored* or *refused* (an error at its line and column, exit code
2) of each file. Where *reported* is added, `harness check` and every run print a note. Each row
is a test (`tests/robot/test_formats.py`). SDF worlds and MoveIt's `.scene` files have a [page of
their own](world_formats.md). Other files of a MoveIt configuration (`ompl_planning.yaml`,
controllers, launch files) are not read; their settings belong into the scenario's `planning`.
"""


EXPRESSIONS = """
### Expressions of xacro files

An expression of a xacro file is read as Python's syntax, and evaluated by an interpreter that has
nothing but numbers, text, lists, tuples and dictionaries. It may contain:

- arithmetic, comparisons, `and`, `or`, `not`, `in`, `is`, `a if b else c`, and bit operations;
- lists, tuples, dictionaries, indices, slices, and comprehensions that make a list;
- `%` and `.format(...)` with text, with widths of at most 999;
- `key` of a YAML mapping as `mapping.key`, and properties of a namespace (`ns`) as `ns.name`;
- functions without a namespace: {builtins};
- functions of `python.`: {python};
- of `math.`, or without it: {math};
- of `xacro.`: `abs_filename`, `arg`, `dotify`, `fatal`, `load_yaml`, `tokenize`, and `error`,
  `message`, `print_location`, `warning`, which print nothing;
- methods of text: {text}; of dictionaries: {dictionary}; of lists: {list}.

Files of `load_yaml` are YAML 1.1 with the tags {units}, whose text may be an expression. Lambdas,
sets, f-strings, other attributes, and the names `complex`, `frozenset`, `hash`, `isinstance`,
`issubclass`, `set`, `slice`, `type` and `vars` of `python.` are refused. Comments are dropped.
"""


def expressions_section() -> str:
    """What expressions of xacro files may contain, from the tables that evaluate them."""
    return EXPRESSIONS.format(
        builtins=_listed(BUILTINS),
        python=_listed(PYTHON.keys() - BUILTINS.keys()) + ", and those above",
        math=_listed(MATH),
        text=_listed(METHODS[str]),
        dictionary=_listed(METHODS[dict]),
        list=_listed(METHODS[list]),
        units=_listed(UNITS),
    )


def _listed(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in sorted(names))


def robot_formats_page() -> str:
    """The page as Markdown."""
    parts = [HEAD]
    for title, key, rows in TABLES.values():
        parts.append(f"## {title}\n\n{key}\n\n| | here | |\n| --- | --- | --- |")
        parts[-1] += "".join(f"\n{_line(row)}" for row in rows) + "\n"
        if title == "xacro":
            parts.append(expressions_section())
    return "\n".join(parts)


def _line(row: Row) -> str:
    return f"| {row.word} | {row.here} | {row.meaning} |"
