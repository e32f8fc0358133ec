"""URDF as links and joints, read from text and written back without losing digits."""

from __future__ import annotations

import importlib.util
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from harness.core.errors import RobotError
from harness.core.geometry import Box, Capsule, Cylinder, Mesh, Plane, Rgba, Shape, Sphere
from harness.core.spatial import SE3, rotation_from_rpy
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


def write_urdf(name: str, links: Iterable[Link], joints: Iterable[Joint]) -> str:
    """A URDF of the links and joints, every number with all its digits."""
    root = ET.Element("robot", name=name)
    for link in links:
        element = ET.SubElement(root, "link", name=link.name)
        if link.inertial is not None:
            _write_inertial(element, link.inertial)
        for tag, shapes in (("visual", link.visuals), ("collision", link.collisions)):
            for shape in shapes:
                for piece in _known_to_urdf(shape):
                    _write_shape(element, tag, piece)
    for joint in joints:
        _write_joint(root, joint)
    ET.indent(root)
    return '<?xml version="1.0"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def rpy_from_rotation(rotation: FloatArray) -> FloatArray:
    """Fixed-axis roll, pitch, yaw of a rotation, stable at pitch ±π/2, shape (3,).

    Roll is taken from the axes turned back by yaw, so that what yaw loses near the singularity,
    roll makes up for.
    """
    yaw = float(np.arctan2(rotation[1, 0], rotation[0, 0]))
    sine, cosine = np.sin(yaw), np.cos(yaw)
    pitch = np.arctan2(-rotation[2, 0], cosine * rotation[0, 0] + sine * rotation[1, 0])
    roll = np.arctan2(
        sine * rotation[0, 2] - cosine * rotation[1, 2],
        cosine * rotation[1, 1] - sine * rotation[0, 1],
    )
    return np.array([roll, pitch, yaw])


# -- reading ----------------------------------------------------------------------------------


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


# -- writing ----------------------------------------------------------------------------------


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
    entries = {
        "ixx": (0, 0),
        "ixy": (0, 1),
        "ixz": (0, 2),
        "iyy": (1, 1),
        "iyz": (1, 2),
        "izz": (2, 2),
    }
    tensor = {key: repr(float(inertial.inertia[place])) for key, place in entries.items()}
    ET.SubElement(element, "inertia", tensor)


def _known_to_urdf(shape: Shape) -> tuple[Shape, ...]:
    """The shape, or the cylinder and two spheres that make up a capsule, which URDF lacks."""
    if not isinstance(shape.geometry, Capsule):
        return (shape,)
    radius, length = shape.geometry.radius, shape.geometry.length
    ends = (SE3.from_xyz_rpy((0.0, 0.0, side * length / 2)) for side in (-1, 1))
    return (
        replace(shape, geometry=Cylinder(radius, length)),
        *(Shape(Sphere(radius), shape.pose @ end, shape.rgba) for end in ends),
    )


def _write_shape(parent: ET.Element, tag: str, shape: Shape) -> None:
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
            ET.SubElement(geometry, "mesh", filename=_mesh_name(path), scale=_text(scale))
        case Plane() | Capsule():
            raise RobotError(f"link '{parent.get('name')}': no such shape in a URDF")
    if tag == "visual":
        material = ET.SubElement(element, "material", name="")
        ET.SubElement(material, "color", rgba=_text(shape.rgba))


def _mesh_name(path: Path) -> str:
    """`package://` name of a file inside a Python package, else its path."""
    for folder in path.parents:
        if (folder / "__init__.py").is_file():
            return f"package://{folder.name}/{path.relative_to(folder).as_posix()}"
    return str(path)


def _write_joint(parent: ET.Element, joint: Joint) -> None:
    element = ET.SubElement(parent, "joint", name=joint.name, type=joint.kind)
    _write_pose(element, joint.pose)
    ET.SubElement(element, "parent", link=joint.parent)
    ET.SubElement(element, "child", link=joint.child)
    if not joint.is_movable:
        return
    ET.SubElement(element, "axis", xyz=_text(joint.axis))
    limit = {"effort": repr(float(joint.effort)), "velocity": repr(float(joint.velocity))}
    if joint.kind != "continuous":
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
