"""A robot from files of its own: finds and reads them, and holds one against the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from harness.core.errors import RobotError
from harness.robot.compose import WORLD, Part
from harness.robot.default_group import DEFAULT_GROUP, default_srdf
from harness.robot.description import NamedState
from harness.robot.find_file import find_file, find_folder
from harness.robot.imported_part import imported_part
from harness.robot.mass import refuse_weightless
from harness.robot.mjcf import read_mjcf
from harness.robot.packages import PackagePath
from harness.robot.srdf import Srdf, parse_srdf
from harness.robot.srdf_check import checked_srdf
from harness.robot.urdf import Urdf, parse_urdf
from harness.robot.xacro_file import render
from harness.spec.scenario import RobotSpec
from harness.spec.xml_file import read_bounded

ROOT_CALLED_WORLD = "robot_world"
"""What a robot's own root link is called that had the name of ours."""


def read_robot(spec: RobotSpec, base_dir: Path) -> Part:
    """The robot of `urdf:`, `xacro:` or `mjcf:`, with what its SRDF says, or a plain one without.

    Args:
        spec: The scenario's `robot:`.
        base_dir: The scenario's folder, where relative names start.

    Raises:
        SpecError: A file says what cannot be meant; at its line and column.
        RobotError: A file is not found, or an option does not fit it.
    """
    key = next(key for key in ("urdf", "xacro", "mjcf") if getattr(spec, key) is not None)
    given = tuple(find_folder(each, base_dir) for each in spec.packages)
    path = find_file(getattr(spec, key), key, base_dir, given)
    packages = PackagePath.of_file(path, given)
    if spec.args and key != "xacro":
        raise RobotError(f"robot.args: a `{key}` takes no arguments; a `xacro` does")
    if key == "mjcf":
        mjcf = read_mjcf(path, packages)
        urdf, states, excluded = mjcf.urdf, mjcf.states, mjcf.disabled
    else:
        is_xacro = key == "xacro"
        text = render(path, spec.args, packages).encode() if is_xacro else read_bounded(path)
        urdf, states, excluded = parse_urdf(text, path.parent, str(path), packages), (), {}
    urdf = _own_world(urdf)
    refuse_weightless(urdf, str(path))
    srdf, source = _srdf(spec, urdf, states, path, base_dir, given)
    part = imported_part(spec, urdf, srdf, path, source)
    allowed = {**excluded, **part.srdf.disabled}
    return replace(part, srdf=replace(part.srdf, disabled=allowed))


def _srdf(
    spec: RobotSpec,
    urdf: Urdf,
    states: Sequence[NamedState],
    path: Path,
    base_dir: Path,
    given: Sequence[Path],
) -> tuple[Srdf, str]:
    """The SRDF, and what messages call it; keyframes of an MJCF are states of its groups."""
    if spec.srdf is None:
        srdf = default_srdf(urdf, spec.tcp_link or "")
        named = tuple(replace(state, group=DEFAULT_GROUP) for state in states)
        return replace(srdf, states=named), str(path)
    found = find_file(spec.srdf, "srdf", base_dir, given)
    parsed = parse_srdf(read_bounded(found), str(found))
    if urdf.root == ROOT_CALLED_WORLD:
        parsed = _with_own_world(parsed)
    parsed = replace(parsed, states=(*parsed.states, *states))
    return checked_srdf(parsed, urdf, str(found)), str(found)


def _own_world(urdf: Urdf) -> Urdf:
    """The tree with its root renamed where that is called as ours."""
    if WORLD not in {link.name for link in urdf.links} or ("link", WORLD) not in urdf.elements:
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
