"""SDF models as robots: their links, joints and frames as those of a URDF."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path

import numpy as np

from harness.core.errors import collected
from harness.core.spatial import SE3
from harness.language.files.xml_file import XmlElement
from harness.plugins.formats.robot_files.format_robot import FormatRobot
from harness.plugins.formats.sdf.bodies import check_links, link_name, scopes_of
from harness.plugins.formats.sdf.elements import note_unread_elements
from harness.plugins.formats.sdf.joints import joint_axis
from harness.plugins.formats.sdf.model_path import ModelPath
from harness.plugins.formats.sdf.round_meshes import FOLDER
from harness.plugins.formats.sdf.scope import WORLD, Named, SdfScope
from harness.plugins.formats.sdf.shapes import ShapeReader
from harness.plugins.formats.sdf.tree import SdfTree
from harness.plugins.formats.sdf.values import bound, number, text_of
from harness.plugins.formats.sdf_robot.links import LinkWriter, element, placed, text
from harness.robot.description import RENAMED_ROOT
from harness.robot.packages import PackagePath, environment_folders
from harness.robot.srdf.srdf import EndEffector, Srdf, SrdfGroup
from harness.robot.urdf.urdf import parse_urdf

TYPES = ("revolute", "continuous", "prismatic", "fixed")


def read_sdf_robot(path: Path, packages: PackagePath, given: Sequence[Path]) -> FormatRobot:
    """Read the model of an SDF file whose joints move, or its only one.

    The base of the robot is the origin of the file; `packages` is that of the file, and `given` are
    the scenario's folders of models and meshes.

    Raises:
        SpecError: The file is no SDF of a robot; at the line and column.
    """
    model_path = ModelPath(path.parent, (*given, *environment_folders(), packages.home))
    tree = SdfTree(path, model_path, model="robot")
    reader = ShapeReader(model_path, tree.notes, checks_meshes=False)
    writer = _Writer(_robot(tree), LinkWriter(reader))
    packages = PackagePath(packages.home, (*model_path.roots, FOLDER))
    urdf = parse_urdf(writer.robot(), path.parent, str(path), packages)
    notes = (
        f"{each.message}{', the first' * (each.count > 1)} in line {each.line}"
        f" of {Path(each.path).name}"
        for each in tree.notes.all()
    )
    urdf = replace(urdf, notes=(*urdf.notes, *notes), frictions=writer.links.frictions)
    return FormatRobot(urdf, (), {}, hands=writer.hands())


def _robot(tree: SdfTree) -> SdfScope:
    """The model that is the robot."""
    models = list(tree.world.nested.values())
    moving = [each for each in models if any(map(_moves, scopes_of(each)))]
    if not models:
        tree.root.refuse("there is no <model> in it: this describes no robot")
    first, *others = moving or models
    if others:
        message = f"several models could be the robot: {first.name}, {others[0].name}"
        others[0].element.refuse(message, "a file of a robot has one model whose joints move")
    for other in (each for each in models if each is not first):
        tree.notes.add(other.element.place, f"the model '{other.name}' is left out")
    return first


def _moves(scope: SdfScope) -> bool:
    joints = [item.element for item in scope.named.values() if item.kind == "joint"]
    return any(joint.get("type").strip() != "fixed" for joint in joints)


@dataclass(eq=False)
class _Writer:
    """Writes a model as the elements of a URDF, each with its place in the SDF.

    Attributes:
        poses: T_base_item of the base and of all links, joints and frames, by name.
    """

    model: SdfScope
    links: LinkWriter
    poses: dict[str, SE3] = field(default_factory=lambda: {WORLD: SE3.identity()})

    def robot(self) -> XmlElement:
        """The `<robot>`, with a link of the base in front of a root that is not at it.

        Raises:
            SpecError: The model has mistakes.
        """
        scopes = scopes_of(self.model)
        for scope in scopes:
            check_links(scope)
        kinds = {"link": self._link, "joint": self._joint, "frame": self._frame}
        named = [(scope, *each) for scope in scopes for each in scope.named.items()]
        items = [each for each in named if each[2].kind in kinds]
        for scope, own, item in items:
            place = scope.in_world() @ scope.locate(own, item.element)
            self.poses[self._name(scope, own)] = place
        written = collected(lambda each: kinds[each[2].kind](*each), items)
        parts, source = [*chain(*written)], self.model.element
        joints = [each for each in parts if each.tag == "joint"]
        children = {each.children[1].get("link") for each in joints}
        links = [each.get("name") for each in parts if each.tag == "link"]
        roots = [each for each in links if each not in children]
        held = [each for each in joints if each.children[0].get("link") == RENAMED_ROOT]
        if len(roots) == 1 and not held:
            held = [_fixed(source, WORLD, roots[0], self.poses[roots[0]])]
            parts += held
        if [each.get("type") for each in held] == ["fixed"] and _is_identity(
            self.poses[held[0].children[1].get("link")]
        ):
            parts.remove(held[0])
        elif held:
            parts.append(element(source, "link", name=RENAMED_ROOT))
        return element(source, "robot", *parts, name=self.model.name)

    def hands(self) -> Srdf:
        """The model's `<gripper>` elements as end effectors, each a group of its fingers.

        Raises:
            SpecError: One lacks a palm or fingers, or names an unknown link.
        """
        groups, tools = list[SrdfGroup](), list[EndEffector]()
        for item in self.model.element.findall("gripper"):
            name, palm = item.need("name").strip(), item.find("palm_link")
            if palm is None or item.find("gripper_link") is None:
                item.refuse("a <gripper> has a <palm_link> and <gripper_link>s")
            parent, *fingers = (
                self._carrier(self.model, each.text.strip(), each)
                for each in (palm, *item.findall("gripper_link"))
            )
            groups.append(SrdfGroup(name, links=tuple(fingers)))
            tools.append(EndEffector(name, parent, name))
        return Srdf(tuple(groups), end_effectors=tuple(tools))

    def _name(self, scope: SdfScope, own: str) -> str:
        """A name with those of the models in the robot's model that it is in."""
        return f"{scope.path}::{own}".removeprefix(f"{self.model.path}::")

    def _carrier(self, scope: SdfScope, name: str, source: XmlElement) -> str:
        """The link to which a name refers."""
        return link_name(scope, name, source).removeprefix(f"{self.model.path}::")

    def _link(self, scope: SdfScope, own: str, item: Named) -> list[XmlElement]:
        return [self.links.link(scope, own, self._name(scope, own), item.element)]

    def _frame(self, scope: SdfScope, own: str, item: Named) -> list[XmlElement]:
        """A frame, as a link without mass on the link that it is attached to."""
        source, name = item.element, self._name(scope, own)
        carrier = self._carrier(scope, own, source)
        pose = self.poses[carrier].inverse() @ self.poses[name]
        link = element(source, "link", name=name)
        return [] if carrier == WORLD else [link, _fixed(source, carrier, name, pose)]

    def _joint(self, scope: SdfScope, own: str, item: Named) -> list[XmlElement]:
        """A joint, and the link in front of its child where the joint is not at the child."""
        source, name = item.element, self._name(scope, own)
        kind = source.need("type").strip()
        if kind not in TYPES:
            message = f"joint '{name}' has the type '{kind}'; known are {', '.join(TYPES)}"
            source.refuse(message, at="type")
        parent, child = (
            self._carrier(scope, text_of(source, tag), source) for tag in ("parent", "child")
        )
        front = self.poses[parent].inverse()
        if kind == "fixed":
            return [_joint(source, name, kind, parent, child, front @ self.poses[child])]
        back = self.poses[name].inverse() @ self.poses[child]
        kind, motion = self._motion(scope, own, source, kind)
        moved = child if _is_identity(back) else name
        joint = _joint(source, name, kind, parent, moved, front @ self.poses[name], *motion)
        if moved == child:
            return [joint]
        return [joint, element(source, "link", name=name), _fixed(source, name, child, back)]

    def _motion(
        self, scope: SdfScope, own: str, source: XmlElement, kind: str
    ) -> tuple[str, list[XmlElement]]:
        """The type of a joint that moves, with its axis, limits, dynamics and mimic."""
        axis, in_scope = joint_axis(scope, own, source)
        limit, dynamics = (axis.find(tag) or element(axis, tag) for tag in ("limit", "dynamics"))
        for part in (axis, limit, dynamics):
            note_unread_elements(part, f"robot/{part.tag}", self.links.reader.notes)
        values = {tag: bound(limit, tag) for tag in ("lower", "upper", "effort", "velocity")}
        given = {tag: text(value) for tag, value in values.items() if np.isfinite(value)}
        ends = [given.pop(tag) for tag in ("lower", "upper") if tag in given]
        if kind == "continuous" or (kind == "revolute" and not ends):
            kind, ends = "continuous", []
        elif len(ends) == 1:
            limit.refuse(f"joint '{own}' has one end of its range; give both, or none")
        else:
            given |= zip(("lower", "upper"), ends, strict=False)
        direction = scope.locate(own, source).rotation.T @ in_scope
        rates = {tag: text(number(dynamics, tag, 0.0)) for tag in ("damping", "friction")}
        found = [
            element(axis.find("xyz") or axis, "axis", xyz=text(*direction)),
            *[element(limit, "limit", **given)] * (kind == "continuous" or bool(ends)),
            element(dynamics, "dynamics", **rates),
        ]
        for mimic in axis.findall("mimic"):
            slope = number(mimic, "multiplier", 1.0)
            offset = number(mimic, "offset", 0.0) - slope * number(mimic, "reference", 0.0)
            words = {"multiplier": text(slope), "offset": text(offset)}
            leader = self._name(scope, mimic.need("joint").strip())
            found.append(element(mimic, "mimic", joint=leader, **words))
        return kind, found


def _is_identity(pose: SE3) -> bool:
    """Whether a pose that is computed in two ways is none."""
    return np.allclose(pose.matrix(), np.eye(4), rtol=0.0, atol=1e-12)


def _fixed(source: XmlElement, parent: str, child: str, pose: SE3) -> XmlElement:
    return _joint(source, f"{child}_fixed", "fixed", parent, child, pose)


def _joint(
    source: XmlElement, name: str, kind: str, parent: str, child: str, pose: SE3, *more: XmlElement
) -> XmlElement:
    """A joint, with its links as its first children."""
    before = element(source, "parent", link=RENAMED_ROOT if parent == WORLD else parent)
    after = element(source, "child", link=child)
    parts = (before, after, placed(source, pose), *more)
    return element(source, "joint", *parts, name=name, type=kind)
