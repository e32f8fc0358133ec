"""Imports a URDF as one object that stands in the world, with the joints of its parts."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.geometry import Box, Capsule, Cylinder, Geometry, Mesh, Shape, Sphere
from harness.core.spatial import SE3
from harness.language.files.xml_file import XmlElement, read_xml
from harness.language.world import ObjectSpec, PartKey, ShapeSpec, WorldSpec
from harness.plugins.formats.fixture_words import PartJoint, on_fixture, part_model
from harness.plugins.formats.notes import Notes
from harness.plugins.formats.object_words import MassProperties, look_words, mass_words, together
from harness.plugins.formats.plain_values import pose_spec, rounded
from harness.plugins.formats.sdf.values import validated
from harness.plugins.formats.touching_links import urdf_poses
from harness.robot.mechanism import Joint, Link
from harness.robot.packages import PackagePath
from harness.robot.tree import carriers, joints_to
from harness.robot.urdf.urdf import Urdf, parse_urdf
from harness.world.imported import ImportedWorld


def load_urdf(path: Path, folders: Sequence[Path] = ()) -> ImportedWorld:
    """The world of a URDF: its root link stands at the world's origin.

    What hangs on the root by a joint that moves is a part; joints further out are held where the
    file has them at zero. A shape has the name of its <collision>, or of its link: the step `open`
    takes the one called `handle`, or the one that it names.

    Args:
        folders: Folders that may be read besides the file's.

    Raises:
        SpecError: The file cannot be read, or is no URDF of one tree; at line and column.
    """
    root = read_xml(path)
    packages = PackagePath.of_file(path, folders)
    urdf = parse_urdf(root, path.parent, str(path), packages)
    notes = Notes()
    for text in (*urdf.notes, *packages.notes):
        notes.add(root.place, text)
    fixture = _Fixture(urdf, root, notes)
    name = (urdf.name or path.stem)[:100]
    world = WorldSpec(world=name, objects=(fixture.object(name),))
    return ImportedWorld(world, path, notes.all())


class _Fixture:
    """The links of a URDF, at zero, as an object and its parts."""

    def __init__(self, urdf: Urdf, root: XmlElement, notes: Notes) -> None:
        self._urdf, self._root, self._notes = urdf, root, notes
        self._poses = urdf_poses(urdf, {})
        self._carrier = carriers(urdf.joints, urdf.root)

    def object(self, name: str) -> ObjectSpec:
        """The links that do not move, with a joint for each part that hangs on them.

        Raises:
            SpecError: Nothing of the file touches, or a value is refused.
        """
        urdf = self._urdf
        fixed = [link for link in urdf.links if self._carrier[link.name] == urdf.root]
        moving = [joint for joint in urdf.joints if joint.is_movable]
        parts = [self._part(j) for j in moving if self._carrier[j.parent] == urdf.root]
        joints = tuple(part for part in parts if part is not None)
        shapes, visuals = self._shapes(fixed)
        if not shapes and not joints:
            self._root.refuse("nothing of it touches: no link has a <collision>")
        words: dict[str, Any] = {"name": name, "static": True, "joints": joints}
        looks = look_words(shapes, visuals) if shapes or visuals else {}
        return validated(ObjectSpec, words | looks, self._root)

    def _part(self, joint: Joint) -> PartKey | None:
        """What a joint moves; None where nothing of it touches, which is noted."""
        urdf, element = self._urdf, self._urdf.elements["joint", joint.name]
        on_joint = [
            link
            for link in urdf.links
            if joint.name in {each.name for each in joints_to(link.name, urdf.joints)}
        ]
        for other in urdf.joints:
            inside = other.is_movable and other.parent in {link.name for link in on_joint}
            if inside:
                place = urdf.elements["joint", other.name].place
                message = f"the joint '{other.name}' is held where the file puts it"
                self._notes.add(place, f"{message}: a part has one joint")
        if joint.mimic is not None:
            self._notes.add(element.place, f"the joint '{joint.name}' follows no other one here")
        shapes, visuals = self._shapes(on_joint)
        if not shapes:
            message = f"the joint '{joint.name}' and what it moves are left out"
            self._notes.add(element.place, f"{message}: nothing of it touches")
            return None
        axis, point = on_fixture(self._poses[joint.child], joint.axis, np.zeros(3))
        part = PartJoint(
            name=joint.name,
            kind="slide" if joint.kind == "prismatic" else "hinge",
            axis=axis,
            point=point,
            limits=(joint.lower, joint.upper),
            friction=joint.friction,
            damping=joint.damping,
        )
        if part.limits != part.usable_limits:
            lower, upper = part.usable_limits
            text = (
                f"the joint '{joint.name}' moves from {lower:g} to {upper:g} {joint.position_unit}"
            )
            self._notes.add(element.place, f"{text} here")
        masses = [
            MassProperties(
                link.inertial.mass, link.inertial.center_of_mass, link.inertial.inertia
            ).placed(self._poses[link.name])
            for link in on_joint
            if link.inertial is not None
        ]
        words = part.words(shapes, [] if visuals == shapes else visuals)
        words |= mass_words(together(masses)) if masses else {}  # else it follows from the volume
        return validated(part_model(), words, element)

    def _shapes(self, links: Sequence[Link]) -> tuple[list[ShapeSpec], list[ShapeSpec]]:
        """The shapes of links that touch, and those that are drawn, in the root's frame."""
        touching: list[ShapeSpec] = []
        for link in links:
            friction = self._urdf.frictions.get(link.name)
            for number, shape in enumerate(link.collisions):
                name = shape.name or (link.name if not number else f"{link.name}_{number}")
                touching.append(self._shape(shape, link, name, friction))
        drawn = [self._shape(shape, link, "") for link in links for shape in link.visuals]
        return touching, drawn

    def _shape(
        self, shape: Shape, link: Link, name: str, friction: float | None = None
    ) -> ShapeSpec:
        placed: SE3 = self._poses[link.name] @ shape.pose
        words = {
            "name": name[:100] or None,
            "pose": pose_spec(placed),
            "color": tuple(round(value, 6) for value in shape.rgba),
            "friction": friction,
            **_geometry_words(shape.geometry),
        }
        return validated(ShapeSpec, words, self._urdf.elements["link", link.name])


def _geometry_words(geometry: Geometry) -> dict[str, Any]:
    match geometry:
        case Box(size=size):
            return {"box": {"size": tuple(map(rounded, size))}}
        case Cylinder(radius=radius, length=length):
            return {"cylinder": {"radius": rounded(radius), "length": rounded(length)}}
        case Capsule(radius=radius, length=length):
            return {"capsule": {"radius": rounded(radius), "length": rounded(length)}}
        case Sphere(radius=radius):
            return {"sphere": {"radius": rounded(radius)}}
        case Mesh(path=path, scale=scale):
            return {"mesh": {"file": str(path), "scale": scale}}
        case _:
            raise TypeError(f"a URDF has no {type(geometry).__name__}")
