"""URDF text as links and joints."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from harness.core.errors import collected
from harness.core.geometry import Mesh
from harness.language.base import LARGEST_NUMBER
from harness.language.files.xml_file import XmlElement, parse_xml
from harness.robot.mechanism import Joint, Link
from harness.robot.packages import PackagePath
from harness.robot.tree import Elements, in_tree_order
from harness.robot.urdf.joints import (
    held_without_range,
    placeholder_limits,
    ranges_of_continuous,
    ranges_of_many_turns,
    read_joint,
    resolved_mimics,
)
from harness.robot.urdf.links import LinkReader
from harness.robot.urdf.ros2_control import with_interfaces
from harness.robot.urdf.values import rgba
from harness.robot.xacro_file import xacro_parts

COEFFICIENTS = ("mu1", "mu2")  # Sliding friction along the two directions of a surface
MOST_LINKS = 500  # pairs of links grow with its square
OF_SRDF = ("group", "group_state", "end_effector", "virtual_joint", "disable_collisions")
READ = {
    "robot": ("link", "joint", "material", "ros2_control"),
    "link": ("inertial", "visual", "collision"),
    "inertial": ("origin", "mass", "inertia"),
    "visual": ("origin", "geometry", "material"),
    "collision": ("origin", "geometry", "material"),
    "joint": (
        "parent",
        "child",
        "origin",
        "axis",
        "limit",
        "dynamics",
        "mimic",
        "safety_controller",
        "calibration",
    ),
}
"""The elements that are known, by the element that they are in."""


MeshElements = Mapping[Mesh, tuple[XmlElement, str]]


@dataclass(frozen=True, eq=False)
class Urdf:
    """A robot's tree: links with parents before children, joints in the order of their children."""

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    notes: tuple[str, ...] = ()
    elements: Elements = field(default_factory=dict[tuple[str, str], XmlElement])
    root_element: XmlElement | None = None
    mesh_elements: MeshElements = field(default_factory=dict[Mesh, tuple[XmlElement, str]])
    frictions: Mapping[str, float] = field(default_factory=dict[str, float])

    @property
    def root(self) -> str:
        """The link without a parent joint."""
        return self.links[0].name


def parse_urdf(
    document: str | bytes | XmlElement,
    folder: Path,
    source: str,
    packages: PackagePath | None = None,
) -> Urdf:
    """Read a URDF.

    In addition to URDF, `<capsule radius length>` is supported.

    Args:
        packages: Search path for other mesh file names; by default around `folder`.

    Raises:
        SpecError: The document is not a URDF of one tree; at the line and column.
    """
    root = document if isinstance(document, XmlElement) else parse_xml(document, source)
    if root.tag != "robot":
        key = {"sdf": "sdf", "mujoco": "mjcf"}.get(root.tag, "")
        message = f"the root element is <{root.tag}>, a URDF's is <robot>"
        root.refuse(message, f"a robot in {key.upper()} is named by `{key}`" if key else "")
    replaced = next(xacro_parts(root), None)
    if replaced is not None:
        item, key, text = replaced
        message = f"`{text}` is xacro, and this is read as a URDF"
        item.refuse(message, "name the file with `xacro`, not with `urdf`", at=key)
    notes: list[str] = []
    materials = {
        item.get("name"): rgba(color)
        for item in root.findall("material")
        if (color := item.find("color")) is not None
    }
    packages = packages or PackagePath(folder.resolve())
    reader = LinkReader(folder, packages, materials, notes)
    elements = _by_name(root)
    readers = {"link": reader.link, "joint": read_joint}
    parts = [each for each in root.children if each.tag in readers]
    read = collected(lambda each: readers[each.tag](each), parts)
    links = [each for each in read if isinstance(each, Link)]
    joints = [each for each in read if isinstance(each, Joint)]
    notes += reader.left_out()
    notes += placeholder_limits(root.findall("joint"))
    notes += ranges_of_continuous(root.findall("joint"))
    notes += ranges_of_many_turns(joints)
    if not links and any(root.find(tag) is not None for tag in OF_SRDF):
        root.refuse(
            "this is an SRDF", "its links and joints are in a URDF; an SRDF is named by `srdf`"
        )
    if not links:
        root.refuse("there is no <link> in it: this describes no robot")
    if len(links) > MOST_LINKS:
        root.refuse(f"{len(links)} links; at most {MOST_LINKS} are read")
    ranged = {joint.name for joint in joints if joint.is_movable}
    joints = held_without_range(with_interfaces(joints, root, notes), notes)
    held = [joint.name for joint in joints if joint.name in ranged and not joint.is_movable]
    if held and len(held) == len(ranged):
        message = "no joint of the robot can move: `lower` and `upper` are equal"
        elements["joint", held[0]].refuse(message, "give their ranges, or make them continuous")
    joints = resolved_mimics(joints, elements)
    notes += packages.notes
    ordered = in_tree_order(links, joints, source, elements)
    return Urdf(
        root.get("name"),
        *ordered,
        (*_ignored(root), *notes),
        elements,
        root,
        reader.meshes,
        link_frictions(root),
    )


def _by_name(root: XmlElement) -> dict[tuple[str, str], XmlElement]:
    """Links and joints by kind and name; a duplicate name is a mistake."""
    elements: dict[tuple[str, str], XmlElement] = {}
    for item in root.children:
        if item.tag in ("link", "joint"):
            key = (item.tag, item.need("name"))
            if not key[1]:
                item.refuse(f"a {item.tag} without a name", at="name")
            if key in elements:
                line = elements[key].place.line
                item.refuse(f"{item.tag} '{key[1]}' is there twice, first in line {line}")
            elements[key] = item
    return elements


def link_frictions(root: XmlElement) -> dict[str, float]:
    """The sliding friction coefficient by link: the smaller of its two directions.

    A value that is no number is left out, as these elements are for another program.
    """
    found: dict[str, float] = {}
    for item in root.findall("gazebo"):
        values = [
            value
            for tag in COEFFICIENTS
            for child in item.findall(tag)
            if (value := _coefficient(child.get("value") or child.text)) is not None
        ]
        if values and item.get("reference"):
            found[item.get("reference")] = min(values)
    return found


def _coefficient(text: str) -> float | None:
    """A coefficient of friction; None for a text that is none."""
    try:
        value = float(text)
    except ValueError:
        return None
    return min(value, LARGEST_NUMBER) if value >= 0 and not math.isnan(value) else None


def _ignored(root: XmlElement) -> list[str]:
    """A note for each kind of ignored element."""
    found: dict[tuple[str, str], list[XmlElement]] = {}

    def look_into(element: XmlElement) -> None:
        for child in element.children:
            if child.tag not in READ[element.tag]:
                found.setdefault((element.tag, child.tag), []).append(child)
            elif child.tag in READ:
                look_into(child)

    look_into(root)
    return [_ignored_note(parent, items) for (parent, _), items in sorted(found.items())]


def _ignored_note(parent: str, items: Sequence[XmlElement]) -> str:
    """The note on ignored elements of one kind; in a part of a robot, where the first one is."""
    tag, place = items[0].tag, items[0].place
    count = f"{len(items)} <{tag}> element{'s' if len(items) > 1 else ''}"
    if parent == "robot":
        has_friction = any(each.find(key) for each in items for key in COEFFICIENTS)
        but = f", except {' and '.join(COEFFICIENTS)} of a gripper's pads" if has_friction else ""
        return f"{count} ignored{but}"
    owners = ", ".join(f"<{each}>" for each, tags in READ.items() if tag in tags)
    where = f"the first in line {place.line} of {Path(place.source.path).name}"
    hint = f"it belongs to {owners}" if owners else f"a macro would be called as <xacro:{tag}>"
    return f"{count} in <{parent}> ignored, {where}; {hint}"
