"""MJCF robots as links and joints: bodies, sites, hinges, slides, shapes, keyframes."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Container, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.spatial import SE3
from harness.core.wrench_sensor import WrenchSensor
from harness.language.files.xml_file import XmlElement
from harness.plugins.formats.mjcf_robot.compiled import compile_mjcf, driven_trees
from harness.plugins.formats.mjcf_robot.files import read_tree
from harness.plugins.formats.mjcf_robot.joints import (
    body_chain,
    mjcf_pose,
    pulled_pairs,
    with_mimics,
)
from harness.plugins.formats.mjcf_robot.links import body_link, links_between
from harness.plugins.formats.mjcf_robot.wrench_sensors import FORCE, TORQUE, wrench_sensors
from harness.plugins.formats.robot_files.format_robot import FormatRobot
from harness.robot.description import NamedState
from harness.robot.mechanism import WORLD, Joint, Link, fixed_joint
from harness.robot.packages import PackagePath
from harness.robot.srdf.srdf import link_pair
from harness.robot.tree import free_name, in_tree_order
from harness.robot.urdf.urdf import Urdf

ROOT = "robot_world"  # The link to which the bodies of MJCF's world body are fixed
UNNAMED = "MuJoCo Model"  # MuJoCo's name of a model without a name


def read_mjcf(path: Path, packages: PackagePath) -> FormatRobot:
    """Read an MJCF file as MuJoCo compiles it.

    Only the force limits of actuators are read: the program drives every joint with its own servo.

    Raises:
        SpecError: A file cannot be read, or MuJoCo refuses it; at line and column where known.
    """
    roots = read_tree(path, packages)
    elements = {
        (kind, item.get("name")): item
        for root in roots
        for item in root.walk()
        for kind in (("link",) if item.tag == "body" else ("joint",) if item.tag == "joint" else ())
        if item.get("name")
    }
    notes: list[str] = []
    spec, model = compile_mjcf(path, roots, packages, notes)
    reader = _Reader(model, spec, path.parent, elements, notes)
    links, joints = reader.tree()
    ordered = in_tree_order(links, joints, str(path), elements)
    name = model.names.split(b"\0")[0].decode()
    name = "" if name == UNNAMED else name
    urdf = Urdf(name, *ordered, tuple(reader.notes), elements)
    states = reader.states({joint.name for joint in joints})
    return FormatRobot(urdf, states, reader.excluded(), reader.wrench_sensors)


@dataclass(eq=False)
class _Reader:
    """Converts a compiled model to links and joints."""

    model: Any
    spec: Any
    folder: Path
    elements: Mapping[tuple[str, str], XmlElement]
    notes: list[str] = field(default_factory=list[str])
    wrench_sensors: dict[str, WrenchSensor] = field(default_factory=dict[str, WrenchSensor])

    def tree(self) -> tuple[list[Link], list[Joint]]:
        model = self.model
        links, joints = [Link(ROOT, None)], list[Joint]()
        names = {0: ROOT}
        dropped: list[str] = []
        passive = _passive_trees(model)
        for body in range(1, model.nbody):
            name = model.body(body).name or f"body_{body}"
            parent = int(model.body_parentid[body])
            is_mocap = model.body_mocapid[body] >= 0
            if (
                parent not in names
                or body in passive
                or self._is_free(body)
                or (is_mocap and not self._carries(body))
            ):
                dropped.append(name)
                continue
            if is_mocap:
                self.notes.append(f"body '{name}' is a mocap body that carries joints: it is fixed")
            names[body] = name
            between, chain = body_chain(model, self.elements, body, names[parent], name)
            own = body_link(self.spec, model, self.folder, body, name, self.notes)
            count = sum(joint.is_movable for joint in chain)
            if count > 1:
                self.notes.append(f"body '{name}' has {count} joints: links are put between them")
            links += links_between(between, count, own)
            joints += chain
        if dropped:
            names_out = ", ".join(dropped)
            self.notes.append(
                f"bodies that are free, or that no actuator moves, are left out: {names_out}"
            )
        self._sites(names, links, joints)
        self.wrench_sensors |= wrench_sensors(model, names)
        self._count_ignored()
        return links, with_mimics(model, joints, self.notes)

    def _is_free(self, body: int) -> bool:
        first, count = int(self.model.body_jntadr[body]), int(self.model.body_jntnum[body])
        return any(int(self.model.jnt_type[first + k]) in (0, 1) for k in range(count))

    def _carries(self, body: int) -> bool:
        """Whether a joint is on a body or on one that it carries."""
        carried = {body}
        for each in range(body + 1, self.model.nbody):  # parents come first
            if int(self.model.body_parentid[each]) in carried:
                carried.add(each)
        return any(int(each) in carried for each in self.model.jnt_bodyid)

    def _sites(self, names: Mapping[int, str], links: list[Link], joints: list[Joint]) -> None:
        """Add sites as frames; one with the name of a body, or of the world, gets another."""
        model, taken = self.model, {WORLD, *(link.name for link in links)}
        joined = {joint.name for joint in joints}
        for number in range(model.nsite):
            name, body = model.site(number).name, int(model.site_bodyid[number])
            if not name or body not in names:
                continue
            pose = mjcf_pose(model.site_pos[number], model.site_quat[number])
            if name == names[body] and pose.distance_to(SE3.identity()) == (0.0, 0.0):
                continue  # the body's own frame
            frame = name if name not in taken else free_name(f"{name}_site", taken)
            if frame != name:
                self.notes.append(
                    f"the site '{name}' is called '{frame}' here: a body has its name"
                )
            pose = mjcf_pose(model.site_pos[number], model.site_quat[number])
            joint = free_name(f"{frame}_site", joined)
            links.append(Link(frame, None))
            joints.append(fixed_joint(joint, names[body], frame, pose))
            taken.add(frame)
            joined.add(joint)

    def _count_ignored(self) -> None:
        model = self.model
        for count, what in (
            (model.nu, "actuators are not used: the program drives every joint with its own servo"),
            (model.ntendon - len(pulled_pairs(model)), "tendons are ignored"),
            (_other_sensors(model), "sensors are ignored"),
            (_with_own_dynamics(model), "joints have an armature or a spring, which is ignored"),
            (int(model.body_geomnum[0]), "geoms of the world body are not part of the robot"),
        ):
            if count:
                self.notes.append(f"{count} {what}")

    def states(self, joints: Container[str]) -> tuple[NamedState, ...]:
        """Keyframes as positions of the robot's joints by name."""
        model = self.model
        names = {j: model.joint(j).name or f"joint_{j}" for j in range(model.njnt)}
        at = {name: int(model.jnt_qposadr[j]) for j, name in names.items() if name in joints}
        return tuple(
            NamedState(
                model.key(number).name or f"key_{number}",
                "",
                {name: float(model.key_qpos[number][place]) for name, place in at.items()},
            )
            for number in range(model.nkey)
        )

    def excluded(self) -> dict[tuple[str, str], str]:
        """Pairs of bodies that the file excludes from contact."""
        pairs: dict[tuple[str, str], str] = {}
        for signature in self.model.exclude_signature:
            first, second = int(signature) >> 16, int(signature) & 0xFFFF
            names = [self.model.body(each).name for each in (first, second)]
            if all(names) and first and second:
                pairs[link_pair(names[0], names[1])] = "Excluded"
        return pairs


def _passive_trees(model: Any) -> set[int]:
    """Bodies on the world whose joints no actuator moves, in a file where actuators move others.

    They are a scene's drawers, doors and sliding objects.
    """
    driven = driven_trees(model)
    return {int(tree) for tree in model.body_rootid[model.dof_bodyid]} - driven if driven else set()


def _other_sensors(model: Any) -> int:
    """Number of sensors of other things than force and torque."""
    return sum(int(kind) not in (FORCE, TORQUE) for kind in model.sensor_type)


def _with_own_dynamics(model: Any) -> int:
    """Number of joints with an armature or a spring."""
    if not model.njnt:
        return 0
    springs = np.reshape(model.jnt_stiffness, (model.njnt, -1)).any(axis=1)
    return int((springs | (model.dof_armature[model.jnt_dofadr] > 0)).sum())
