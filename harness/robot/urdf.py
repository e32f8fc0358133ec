"""URDF text as links and joints."""

from __future__ import annotations

import importlib.util
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.core.errors import RobotError
from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Rgba, Shape, Sphere
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.robot.description import Inertial, Joint, JointKind, Link, Mimic

DEFAULT_RGBA: Rgba = (0.6, 0.6, 0.6, 1.0)
KINDS: dict[str, JointKind] = {
    "fixed": "fixed",
    "revolute": "revolute",
    "continuous": "continuous",
    "prismatic": "prismatic",
}


@dataclass(frozen=True, eq=False)
class Urdf:
    """A robot's tree: links with parents before children, joints in the order of their children."""

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]

    @property
    def root(self) -> str:
        """The link that is no joint's child."""
        return self.links[0].name


def parse_xml(text: str, source: str) -> ET.Element:
    """Root element of a document without document type or entities.

    Raises:
        RobotError: The text is not well-formed, or declares a document type or an entity.
    """
    if re.search(r"<!\s*(DOCTYPE|ENTITY)", text, re.IGNORECASE):
        raise RobotError(f"{source}: a robot's XML has no DOCTYPE and no entities; remove them")
    try:
        return ET.fromstring(text)
    except ET.ParseError as error:
        raise RobotError(f"{source}: not well-formed XML: {error}") from error


def parse_urdf(text: str, folder: Path, source: str) -> Urdf:
    """Read a URDF.

    Soft limits of a `safety_controller` narrow the position limits, as MoveIt has it. Beyond URDF,
    `<capsule radius length>` is known, and `package://x/y` is a file of the Python package x.

    Args:
        text: The document.
        folder: Where relative mesh file names start.
        source: What messages call the document.

    Raises:
        RobotError: The document is not a URDF of one tree; the message names link or joint.
    """
    root = parse_xml(text, source)
    if root.tag != "robot":
        raise RobotError(f"{source}: the root element is <{root.tag}>, a URDF's is <robot>")
    try:
        materials = {
            item.attrib["name"]: _rgba(color)
            for item in root.findall("material")
            if (color := item.find("color")) is not None
        }
        links = {
            item.attrib["name"]: _link(item, folder, materials) for item in root.findall("link")
        }
        joints = [_joint(item) for item in root.findall("joint")]
    except KeyError as error:
        raise RobotError(f"{source}: an element lacks its attribute {error}") from error
    except ValueError as error:
        raise RobotError(f"{source}: {error}") from error
    ordered = in_tree_order(links.values(), joints, source)
    return Urdf(root.get("name", ""), *ordered)


def in_tree_order(
    links: Iterable[Link], joints: Sequence[Joint], source: str
) -> tuple[tuple[Link, ...], tuple[Joint, ...]]:
    """Links from the root outwards, joints in the order of their child links.

    Raises:
        RobotError: They are not one tree.
    """
    by_name = {link.name: link for link in links}
    children: dict[str, list[Joint]] = {name: [] for name in by_name}
    parents: dict[str, str] = {}
    for joint in joints:
        for name in (joint.parent, joint.child):
            if name not in by_name:
                raise RobotError(f"{source}: joint '{joint.name}' names the unknown link '{name}'")
        if joint.child in parents:
            raise RobotError(f"{source}: link '{joint.child}' is the child of two joints")
        parents[joint.child] = joint.parent
        children[joint.parent].append(joint)
    roots = [name for name in by_name if name not in parents]
    if len(roots) != 1:
        raise RobotError(f"{source}: a robot has one root link, found {', '.join(roots) or 'none'}")
    ordered_links, ordered_joints, stack = (
        [by_name[roots[0]]],
        list[Joint](),
        children[roots[0]][::-1],
    )
    while stack:
        joint = stack.pop()
        ordered_joints.append(joint)
        ordered_links.append(by_name[joint.child])
        stack.extend(children[joint.child][::-1])
    if len(ordered_links) != len(by_name):
        lost = sorted(set(by_name) - {link.name for link in ordered_links})
        raise RobotError(f"{source}: joints run in a circle around {', '.join(lost)}")
    return tuple(ordered_links), tuple(ordered_joints)


def _numbers(text: str, count: int) -> FloatArray:
    values = np.array([float(word) for word in text.split()])
    if values.shape != (count,) or not np.all(np.isfinite(values)):
        raise ValueError(f"expected {count} finite numbers, found '{text}'")
    return values


def _pose(element: ET.Element) -> SE3:
    origin = element.find("origin")
    if origin is None:
        return SE3.identity()
    return SE3.from_xyz_rpy(
        _numbers(origin.get("xyz", "0 0 0"), 3), _numbers(origin.get("rpy", "0 0 0"), 3)
    )


def _rgba(color: ET.Element) -> Rgba:
    red, green, blue, alpha = (float(value) for value in _numbers(color.attrib["rgba"], 4))
    return red, green, blue, alpha


def _link(element: ET.Element, folder: Path, materials: dict[str, Rgba]) -> Link:
    name = element.attrib["name"]
    try:
        inertial = element.find("inertial")
        return Link(
            name,
            None if inertial is None else _inertial(inertial),
            tuple(_shape(item, folder, materials) for item in element.findall("visual")),
            tuple(_shape(item, folder, materials) for item in element.findall("collision")),
        )
    except ValueError as error:
        raise ValueError(f"link '{name}': {error}") from error


def _inertial(element: ET.Element) -> Inertial:
    """Mass properties with the tensor turned into link axes."""
    mass, tensor = element.find("mass"), element.find("inertia")
    if mass is None or tensor is None:
        raise ValueError("<inertial> has a <mass> and an <inertia>")
    xx, yy, zz = (float(tensor.attrib[key]) for key in ("ixx", "iyy", "izz"))
    xy, xz, yz = (float(tensor.get(key, "0")) for key in ("ixy", "ixz", "iyz"))
    pose = _pose(element)
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if not np.array_equal(pose.rotation, np.eye(3)):
        inertia = pose.rotation @ inertia @ pose.rotation.T
    return Inertial(float(mass.attrib["value"]), pose.translation, inertia)


def _shape(element: ET.Element, folder: Path, materials: dict[str, Rgba]) -> Shape:
    geometry = element.find("geometry")
    if geometry is None or len(geometry) != 1:
        raise ValueError(f"<{element.tag}> has one <geometry> with one shape")
    material = element.find("material")
    rgba = DEFAULT_RGBA
    if material is not None:
        color = material.find("color")
        known = materials.get(material.get("name", ""), DEFAULT_RGBA)
        rgba = known if color is None else _rgba(color)
    return Shape(_geometry(geometry[0], folder), _pose(element), rgba, element.get("name", ""))


def _geometry(item: ET.Element, folder: Path) -> Box | Cylinder | Sphere | Capsule | Mesh:
    match item.tag:
        case "box":
            x, y, z = (float(value) for value in _numbers(item.attrib["size"], 3))
            return Box((x, y, z))
        case "cylinder":
            return Cylinder(float(item.attrib["radius"]), float(item.attrib["length"]))
        case "sphere":
            return Sphere(float(item.attrib["radius"]))
        case "capsule":
            return Capsule(float(item.attrib["radius"]), float(item.attrib["length"]))
        case "mesh":
            x, y, z = (float(value) for value in _numbers(item.get("scale", "1 1 1"), 3))
            return Mesh(_mesh_path(item.attrib["filename"], folder), (x, y, z))
        case _:
            raise ValueError(f"unknown geometry <{item.tag}>")


def _mesh_path(filename: str, folder: Path) -> Path:
    """The mesh's file; `package://x/y` is y in the installed Python package x."""
    if filename.startswith("package://"):
        package, _, rest = filename.removeprefix("package://").partition("/")
        spec = importlib.util.find_spec(package)
        if spec is None or not spec.submodule_search_locations:
            raise ValueError(f"mesh '{filename}': the package '{package}' is not installed")
        return Path(spec.submodule_search_locations[0]) / rest
    return (folder / filename.removeprefix("file://")).resolve()


def _joint(element: ET.Element) -> Joint:
    name = element.attrib["name"]
    try:
        kind = KINDS[element.attrib["type"]]
    except KeyError:
        found = element.get("type")
        raise ValueError(
            f"joint '{name}' has the type '{found}'; known are {', '.join(KINDS)}"
        ) from None
    parent, child = element.find("parent"), element.find("child")
    if parent is None or child is None:
        raise ValueError(f"joint '{name}' has a <parent> and a <child>")
    axis_element = element.find("axis")
    axis = _numbers("1 0 0" if axis_element is None else axis_element.attrib["xyz"], 3)
    limit, safety = element.find("limit"), element.find("safety_controller")
    lower, upper, velocity, effort = -np.inf, np.inf, np.inf, np.inf
    if limit is not None:
        velocity, effort = float(limit.get("velocity", "inf")), float(limit.get("effort", "inf"))
        if kind != "continuous":
            lower, upper = float(limit.get("lower", "0")), float(limit.get("upper", "0"))
    elif kind in ("revolute", "prismatic"):
        raise ValueError(f"joint '{name}' is {kind} and has no <limit>")
    if safety is not None:
        lower = max(lower, float(safety.get("soft_lower_limit", "-inf")))
        upper = min(upper, float(safety.get("soft_upper_limit", "inf")))
    dynamics, mimic = element.find("dynamics"), element.find("mimic")
    return Joint(
        name,
        kind,
        parent.attrib["link"],
        child.attrib["link"],
        _pose(element),
        axis if kind == "fixed" else axis / np.linalg.norm(axis),
        lower,
        upper,
        velocity,
        effort=effort,
        damping=0.0 if dynamics is None else float(dynamics.get("damping", "0")),
        friction=0.0 if dynamics is None else float(dynamics.get("friction", "0")),
        mimic=None
        if mimic is None
        else Mimic(
            mimic.attrib["joint"],
            float(mimic.get("multiplier", "1")),
            float(mimic.get("offset", "0")),
        ),
    )
