"""Imports a robot from the user's files, and checks them against each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from harness.core.geometry import CollisionMode
from harness.core.inputs import read_bounded
from harness.core.limits import XML_FILE
from harness.language.scenario import RobotSpec
from harness.plugins.formats.keys.moveit import MoveItFiles
from harness.plugins.formats.robot_files.checked_srdf import checked_srdf
from harness.plugins.formats.robot_files.default_group import default_srdf
from harness.plugins.formats.robot_files.format_robot import FormatRobot
from harness.plugins.formats.robot_files.imported_files import (
    files_around,
    refuse_unknown_arguments,
)
from harness.plugins.formats.robot_files.imported_part import imported_part, refuse_unknown_links
from harness.plugins.formats.robot_files.moveit_files import with_joint_limits
from harness.plugins.formats.sdf_robot.model import read_sdf_robot
from harness.plugins.formats.xacro.render import render
from harness.robot.collision_shapes import with_collision_modes
from harness.robot.compose import RobotPart
from harness.robot.decomposed_meshes import decompose_meshes
from harness.robot.description import RENAMED_ROOT, NamedState
from harness.robot.estimated_masses import with_estimated_masses
from harness.robot.find_file import find_file, find_folder
from harness.robot.mechanism import WORLD
from harness.robot.packages import PackagePath
from harness.robot.robot_format import FORMATS
from harness.robot.srdf.read import read_srdf
from harness.robot.srdf.srdf import Srdf
from harness.robot.urdf.urdf import Urdf, parse_urdf


def read_robot(
    spec: RobotSpec, base_dir: Path, collision: CollisionMode | None = None
) -> RobotPart:
    """The robot of `urdf:`, `xacro:`, `mjcf:` or `sdf:`, with its SRDF or a default one.

    See `RobotFormat.read` for arguments and errors.
    """
    key = next(key for key in FORMATS if getattr(spec, key) is not None)
    given = tuple(find_folder(each, base_dir) for each in spec.packages)
    path = find_file(getattr(spec, key), key, base_dir, given)
    packages = files_around(getattr(spec, key), path, given)
    srdf_path = None if spec.srdf is None else find_file(spec.srdf, "srdf", base_dir, given)
    files = [*([path] if key == "xacro" else []), *([srdf_path] if srdf_path else [])]
    refuse_unknown_arguments(spec.args, files)
    if key == "mjcf":
        from harness.plugins.formats.mjcf_robot.mjcf import read_mjcf  # loads MuJoCo

        found = read_mjcf(path, packages)
    elif key == "sdf":
        found = read_sdf_robot(path, packages, given)
    else:
        is_xacro = key == "xacro"
        document = render(path, spec.args, packages) if is_xacro else _content(path)
        found = FormatRobot(parse_urdf(document, path.parent, str(path), packages), (), {})
    urdf, states = _without_world(found.urdf), found.states
    urdf = replace(urdf, links=with_collision_modes(urdf.links, spec.collision, collision))
    srdf = None
    if srdf_path is not None:
        around = PackagePath.of_file(srdf_path, (*given, packages.home))
        parsed = read_srdf(srdf_path, _content(srdf_path), spec.args, around)
        srdf = _srdf(parsed, urdf, states, str(srdf_path))
    refuse_unknown_links(spec, urdf)
    _check_limits(spec, urdf, base_dir)
    decompose_meshes(urdf.links, urdf.mesh_elements)  # what needs no shapes is checked before
    srdf = srdf or _default_srdf(spec, urdf, states, found.hands)
    urdf = with_estimated_masses(urdf)
    part = imported_part(spec, urdf, srdf, path, str(srdf_path or path))
    allowed = {**found.disabled, **part.srdf.disabled}
    disabled = replace(part.srdf, disabled=allowed)
    return replace(part, srdf=disabled, wrench_sensors=found.wrench_sensors)


def _check_limits(spec: RobotSpec, urdf: Urdf, base_dir: Path) -> None:
    """Check MoveIt's joint limits, which are applied after a gripper is mounted.

    Raises:
        SpecError: The file has mistakes, or names joints that do not exist.
        RobotError: It does not exist.
    """
    files = spec.moveit if isinstance(spec.moveit, MoveItFiles) else MoveItFiles()
    if files.joint_limits is not None and spec.gripper is None:
        path = find_file(files.joint_limits, "moveit", base_dir, ())
        with_joint_limits(urdf.joints, path, urdf.name, [])


def _default_srdf(spec: RobotSpec, urdf: Urdf, states: Sequence[NamedState], hands: Srdf) -> Srdf:
    """The SRDF of a robot that has none, with an MJCF's keyframes and an SDF's grippers."""
    srdf = default_srdf(urdf, spec.tcp_link or "")
    named = tuple(replace(each, group=group.name) for group in srdf.groups for each in states)
    groups = (*srdf.groups, *hands.groups)
    return replace(srdf, groups=groups, states=named, end_effectors=hands.end_effectors)


def _srdf(parsed: Srdf, urdf: Urdf, states: Sequence[NamedState], source: str) -> Srdf:
    """The checked SRDF; an MJCF's keyframes become states of its groups."""
    if urdf.root == RENAMED_ROOT:
        groups = tuple(group.with_links(_root_name) for group in parsed.groups)
        parsed = replace(parsed, groups=groups)
    return checked_srdf(replace(parsed, states=(*parsed.states, *states)), urdf, source)


def _root_name(link: str) -> str:
    return RENAMED_ROOT if link == WORLD else link


def _without_world(urdf: Urdf) -> Urdf:
    """The tree with a link named `world` renamed."""
    if WORLD not in {link.name for link in urdf.links}:
        return urdf
    links = tuple(replace(link, name=_root_name(link.name)) for link in urdf.links)
    joints = tuple(
        replace(joint, parent=_root_name(joint.parent), child=_root_name(joint.child))
        for joint in urdf.joints
    )
    elements = {**urdf.elements, ("link", RENAMED_ROOT): urdf.elements["link", WORLD]}
    note = f"the link '{WORLD}' is called '{RENAMED_ROOT}' here: '{WORLD}' is the world's own frame"
    return replace(urdf, links=links, joints=joints, elements=elements, notes=(*urdf.notes, note))


def _content(path: Path) -> bytes:
    return read_bounded(path, "robot description", XML_FILE)
