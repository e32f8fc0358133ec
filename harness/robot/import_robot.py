"""A robot from files of its own: finds and reads them, and holds one against the other."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from harness.core.errors import RobotError
from harness.robot.compose import WORLD, Part
from harness.robot.find_file import find_file, find_folder
from harness.robot.imported_part import imported_part
from harness.robot.mass import refuse_weightless
from harness.robot.packages import PackagePath
from harness.robot.srdf import Srdf, parse_srdf
from harness.robot.srdf_check import checked_srdf, default_srdf
from harness.robot.urdf import Urdf, parse_urdf
from harness.robot.xacro_file import render
from harness.spec.scenario import RobotSpec
from harness.spec.xml_file import read_bounded

ROOT_CALLED_WORLD = "robot_world"
"""What a robot's own root link is called that had the name of ours."""


def read_robot(spec: RobotSpec, base_dir: Path) -> Part:
    """The robot of `urdf:` or `xacro:`, with what its SRDF says, or a plain one without.

    Args:
        spec: The scenario's `robot:`.
        base_dir: The scenario's folder, where relative names start.

    Raises:
        SpecError: A file says what cannot be meant; at its line and column.
        RobotError: A file is not found, or an option does not fit it.
    """
    key = "urdf" if spec.urdf is not None else "xacro"
    given = tuple(find_folder(each, base_dir) for each in spec.packages)
    path = find_file(getattr(spec, key), key, base_dir, given)
    packages = PackagePath.of_file(path, given)
    if key == "xacro":
        text = render(path, spec.args, packages).encode()
    elif spec.args:
        raise RobotError("robot.args: a `urdf` takes no arguments; a `xacro` does")
    else:
        text = read_bounded(path)
    urdf = _own_world(parse_urdf(text, path.parent, str(path), packages))
    refuse_weightless(urdf, str(path))
    srdf = default_srdf(urdf, spec.tcp_link)
    source = str(path)
    if spec.srdf is not None:
        srdf_path = find_file(spec.srdf, "srdf", base_dir, given)
        source = str(srdf_path)
        parsed = parse_srdf(read_bounded(srdf_path), source)
        if urdf.root == ROOT_CALLED_WORLD:
            parsed = _with_own_world(parsed)
        srdf = checked_srdf(parsed, urdf, source)
    return imported_part(spec, urdf, srdf, path, source)


def _own_world(urdf: Urdf) -> Urdf:
    """The tree with its root renamed where that is called as ours."""
    if WORLD not in {link.name for link in urdf.links}:
        return urdf

    def name(link: str) -> str:
        return ROOT_CALLED_WORLD if link == WORLD else link

    links = tuple(replace(link, name=name(link.name)) for link in urdf.links)
    joints = tuple(
        replace(joint, parent=name(joint.parent), child=name(joint.child)) for joint in urdf.joints
    )
    elements = {**urdf.elements, ("link", ROOT_CALLED_WORLD): urdf.elements["link", WORLD]}
    return replace(urdf, links=links, joints=joints, elements=elements)


def _with_own_world(srdf: Srdf) -> Srdf:
    """Chains that began at the root begin at its new name."""
    groups = tuple(
        replace(
            group,
            chains=tuple(
                (ROOT_CALLED_WORLD if base == WORLD else base, tip) for base, tip in group.chains
            ),
        )
        for group in srdf.groups
    )
    return replace(srdf, groups=groups)
