"""Links and joints as URDF text, every number with all its digits."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from harness.core.errors import RobotError
from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Plane, Shape, Sphere, undivided
from harness.core.spatial import SE3, rotation_from_rpy, rpy_from_rotation
from harness.robot.mechanism import Inertial, Joint, Link

NO_LIMIT = 1e30
"""The written value of an unlimited velocity or effort; larger values are read as unlimited."""


def write_urdf(
    name: str, links: Iterable[Link], joints: Iterable[Joint], folder: Path | None = None
) -> str:
    """A URDF of the links and joints, every number with all its digits.

    Args:
        folder: The folder to which mesh files outside Python packages are relative; None for
            absolute paths.
    """
    root = ET.Element("robot", name=name)
    for link in links:
        element = ET.SubElement(root, "link", name=link.name)
        if link.inertial is not None:
            _write_inertial(element, link.inertial)
        for tag, shapes in (("visual", link.visuals), ("collision", link.collisions)):
            for shape in undivided(shapes):
                for piece in _known_to_urdf(shape):
                    _write_shape(element, tag, piece, folder)
    for joint in joints:
        _write_joint(root, joint)
    ET.indent(root)
    return '<?xml version="1.0"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _text(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)


def _write_pose(parent: ET.Element, pose: SE3) -> None:
    rpy = rpy_from_rotation(pose.rotation)
    if not np.array_equal(rotation_from_rpy(rpy), np.eye(3)) or np.any(pose.translation):
        ET.SubElement(parent, "origin", xyz=_text(pose.translation), rpy=_text(rpy))


def _write_inertial(parent: ET.Element, inertial: Inertial) -> None:
    element = ET.SubElement(parent, "inertial")
    ET.SubElement(element, "origin", xyz=_text(inertial.center_of_mass))
    ET.SubElement(element, "mass", value=repr(float(inertial.mass)))
    numbers = map(repr, inertial.inertia[np.triu_indices(3)].tolist())
    tensor: dict[str, str] = dict(
        zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), numbers, strict=True)
    )
    ET.SubElement(element, "inertia", tensor)


def _known_to_urdf(shape: Shape) -> tuple[Shape, ...]:
    """The shape; a capsule, which URDF lacks, becomes a cylinder and two spheres."""
    if not isinstance(shape.geometry, Capsule):
        return (shape,)
    radius, length = shape.geometry.radius, shape.geometry.length
    ends = (SE3.from_xyz_rpy((0.0, 0.0, side * length / 2)) for side in (-1, 1))
    return (
        replace(shape, geometry=Cylinder(radius, length)),
        *(Shape(Sphere(radius), shape.pose @ end, shape.rgba) for end in ends),
    )


def _write_shape(parent: ET.Element, tag: str, shape: Shape, folder: Path | None) -> None:
    element = ET.SubElement(parent, tag, {"name": shape.name} if shape.name else {})
    _write_pose(element, shape.pose)
    geometry = ET.SubElement(element, "geometry")
    match shape.geometry:
        case Box(size=size):
            ET.SubElement(geometry, "box", size=_text(size))
        case Cylinder(radius=radius, length=length):
            ET.SubElement(geometry, "cylinder", radius=repr(radius), length=repr(length))
        case Sphere(radius=radius):
            ET.SubElement(geometry, "sphere", radius=repr(radius))
        case Mesh(path=path, scale=scale):
            file = package_name(path) or str(path if folder is None else _seen(path, folder))
            ET.SubElement(geometry, "mesh", filename=file, scale=_text(scale))
        case Plane() | Capsule():
            raise RobotError(f"link '{parent.get('name')}': no such shape in a URDF")
    if tag == "visual":
        material = ET.SubElement(element, "material", name="")
        ET.SubElement(material, "color", rgba=_text(shape.rgba))


def package_name(path: Path) -> str:
    """`package://` name of a file inside a Python package; empty for others."""
    for folder in path.parents:
        if (folder / "__init__.py").is_file():
            return f"package://{folder.name}/{path.relative_to(folder).as_posix()}"
    return ""


def _seen(path: Path, folder: Path) -> str:
    return Path(os.path.relpath(path, folder)).as_posix()


def _rate(limit: float) -> str:
    """A velocity or effort limit; URDF has no infinity."""
    return repr(float(limit)) if np.isfinite(limit) else repr(NO_LIMIT)


def _write_joint(parent: ET.Element, joint: Joint) -> None:
    element = ET.SubElement(parent, "joint", name=joint.name, type=joint.kind)
    _write_pose(element, joint.pose)
    ET.SubElement(element, "parent", link=joint.parent)
    ET.SubElement(element, "child", link=joint.child)
    if not joint.is_movable:
        return
    ET.SubElement(element, "axis", xyz=_text(joint.axis))
    limit = {"effort": _rate(joint.effort), "velocity": _rate(joint.velocity)}
    if joint.kind != "continuous" and np.isfinite([joint.lower, joint.upper]).all():
        limit = {"lower": repr(float(joint.lower)), "upper": repr(float(joint.upper)), **limit}
    ET.SubElement(element, "limit", limit)
    dynamics = {"damping": repr(float(joint.damping)), "friction": repr(float(joint.friction))}
    ET.SubElement(element, "dynamics", dynamics)
    if joint.mimic is not None:
        mimic = {
            "joint": joint.mimic.joint,
            "multiplier": repr(float(joint.mimic.multiplier)),
            "offset": repr(float(joint.mimic.offset)),
        }
        ET.SubElement(element, "mimic", mimic)
