"""Imports a robot from the user's files, and checks them against each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from harness.core.errors import RobotError, RobotOptionError
from harness.language.files.xml_file import read_bounded
from harness.language.scenario import RobotSpec
from harness.robot.compose import WORLD, RobotPart
from harness.robot.description import NamedState
from harness.robot.find_file import find_file, find_folder
from harness.robot.imported_part import imported_part
from harness.robot.mjcf.mjcf import read_mjcf
from harness.robot.packages import PackagePath
from harness.robot.srdf.check import checked_srdf
from harness.robot.srdf.default_group import DEFAULT_GROUP, default_srdf
from harness.robot.srdf.srdf import Srdf, parse_srdf
from harness.robot.tree import carriers
from harness.robot.urdf.urdf import Urdf, parse_urdf
from harness.robot.xacro.file import render

RENAMED_ROOT = "robot_world"
"""New name of a robot's root link that is named `world`, like the root of every composed robot."""


def read_robot(spec: RobotSpec, base_dir: Path) -> RobotPart:
    """The robot of `urdf:`, `xacro:` or `mjcf:`, with its SRDF or a default one.

    Args:
        spec: The `robot:` of the scenario.
        base_dir: The scenario's folder, to which paths are relative.

    Raises:
        SpecError: A file has mistakes; at line and column.
        RobotError: A file is not found, or an option does not fit it.
    """
    key = next(key for key in ("urdf", "xacro", "mjcf") if getattr(spec, key) is not None)
    given = tuple(find_folder(each, base_dir) for each in spec.packages)
    path = find_file(getattr(spec, key), key, base_dir, given)
    packages = PackagePath.of_file(path, given)
    if spec.args and key != "xacro":
        raise RobotOptionError("args", f"a `{key}` takes no arguments; a `xacro` does")
    if key == "mjcf":
        mjcf = read_mjcf(path, packages)
        urdf, states, excluded = mjcf.urdf, mjcf.states, mjcf.disabled
    else:
        is_xacro = key == "xacro"
        text = render(path, spec.args, packages).encode() if is_xacro else read_bounded(path)
        urdf, states, excluded = parse_urdf(text, path.parent, str(path), packages), (), {}
    urdf = _without_world(urdf)
    _refuse_weightless(urdf, str(path))
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
    """The SRDF, and its name in messages; keyframes of an MJCF become states of its groups."""
    if spec.srdf is None:
        srdf = default_srdf(urdf, spec.tcp_link or "")
        named = tuple(replace(state, group=DEFAULT_GROUP) for state in states)
        return replace(srdf, states=named), str(path)
    found = find_file(spec.srdf, "srdf", base_dir, given)
    parsed = parse_srdf(read_bounded(found), str(found))
    if urdf.root == RENAMED_ROOT:
        parsed = _with_renamed_root(parsed)
    parsed = replace(parsed, states=(*parsed.states, *states))
    return checked_srdf(parsed, urdf, str(found)), str(found)


def _without_world(urdf: Urdf) -> Urdf:
    """The tree with a link named `world` renamed."""
    if WORLD not in {link.name for link in urdf.links} or ("link", WORLD) not in urdf.elements:
        return urdf

    def name(link: str) -> str:
        return RENAMED_ROOT if link == WORLD else link

    links = tuple(replace(link, name=name(link.name)) for link in urdf.links)
    joints = tuple(
        replace(joint, parent=name(joint.parent), child=name(joint.child)) for joint in urdf.joints
    )
    elements = {**urdf.elements, ("link", RENAMED_ROOT): urdf.elements["link", WORLD]}
    return replace(urdf, links=links, joints=joints, elements=elements)


def _with_renamed_root(srdf: Srdf) -> Srdf:
    """The SRDF with chains from the renamed root."""
    groups = tuple(
        replace(
            group,
            chains=tuple(
                (RENAMED_ROOT if base == WORLD else base, tip) for base, tip in group.chains
            ),
        )
        for group in srdf.groups
    )
    return replace(srdf, groups=groups)


def _refuse_weightless(urdf: Urdf, source: str) -> None:
    """Refuse a robot with a massless rigid group that a joint moves.

    Raises:
        SpecError: A group has no mass; at the link's `<mass>`, or at the link without one.
    """
    carrier = carriers(urdf.joints, urdf.root)
    masses = {carrier[link.name]: 0.0 for link in urdf.links}
    for link in urdf.links:
        if link.inertial is not None:
            masses[carrier[link.name]] += link.inertial.mass
    for first, mass in masses.items():
        if mass > 0 or first == urdf.root:
            continue
        message = f"link '{first}' moves and weighs nothing"
        hint = "give it an <inertial> with its mass [kg] and inertia [kg m^2]"
        element = urdf.elements.get(("link", first))
        if element is None:
            raise RobotError(f"{source}: {message}; {hint}")
        inertial = element.find("inertial")
        written = None if inertial is None else inertial.find("mass")
        (written or element).refuse(message, hint, at="value" if written else "name")
