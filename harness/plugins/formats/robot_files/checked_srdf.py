"""Checks an SRDF against its URDF."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace

from harness.core.suggestion import did_you_mean
from harness.language.files.xml_file import XmlElement
from harness.plugins.formats.robot_files.absent_names import Absent, without_absent
from harness.plugins.formats.robot_files.default_group import DEFAULT_GROUP, default_srdf
from harness.robot.description import NamedState, PlanningGroup
from harness.robot.groups import planning_groups
from harness.robot.mechanism import Joint
from harness.robot.srdf.srdf import Srdf, has_several_values
from harness.robot.urdf.urdf import Urdf


def checked_srdf(srdf: Srdf, urdf: Urdf, source: str) -> Srdf:
    """The SRDF without pairs of unknown links, and without groups of another variant's joints.

    Raises:
        SpecError: It names other unknown joints, links or groups; located.
    """
    srdf, absent = without_absent(srdf, urdf, source)
    resolved = planning_groups(srdf, urdf.joints, source)
    root = srdf.root_element
    if root is None:
        return srdf
    joints = {joint.name: joint for joint in urdf.joints}
    lost = {name for kind, name in absent if kind == "joint"}
    links = {link.name for link in urdf.links} | {"world"}
    notes: list[str] = []
    _check_states(root, srdf, joints, absent, notes)
    _check_end_effectors(root, srdf, links, absent)
    virtual = {joint.name for joint in srdf.virtual_joints}
    for item in root.findall("passive_joint"):
        _check_name(item, "name", "passive_joint", "joint", {*joints, *lost, *virtual})
    for joint in srdf.virtual_joints:
        if joint.kind != "fixed":
            notes.append(f"SRDF: the {joint.kind} virtual joint '{joint.name}' counts as fixed")
    known = {pair: reason for pair, reason in srdf.disabled.items() if links.issuperset(pair)}
    if len(known) < len(srdf.disabled):
        lost = sorted({name for pair in srdf.disabled for name in pair} - links)
        notes.append(f"SRDF: disable_collisions of unknown links ignored: {', '.join(lost)}")
    states = tuple(
        _within(state, joints, notes) for state in _with_groups(srdf.states, resolved, notes)
    )
    srdf = replace(srdf, disabled=known, states=states, notes=(*srdf.notes, *notes))
    if srdf.groups:
        return srdf
    default = default_srdf(urdf)
    note = f"SRDF: no groups; '{DEFAULT_GROUP}' is the longest chain"
    return replace(srdf, groups=default.groups, notes=(*srdf.notes, note))


def _check_states(
    root: XmlElement, srdf: Srdf, joints: Mapping[str, Joint], absent: Absent, notes: list[str]
) -> None:
    """Refuse states of unknown groups and joints; adds a note on positions of fixed joints."""
    groups = {group.name for group in srdf.groups}
    virtual = {joint.name for joint in srdf.virtual_joints}
    for item in root.findall("group_state"):
        what = f"state '{item.get('name')}'"
        if ("group", item.get("group")) in absent:
            continue
        if "group" in item.attributes:
            _check_name(item, "group", what, "group", groups)
        for each in item.findall("joint"):
            name = each.get("name")
            if name in virtual or ("joint", name) in absent:
                continue
            _check_name(each, "name", what, "joint", joints)
            if has_several_values(each):
                if joints[name].is_movable:
                    each.refuse(f"{what}: joint '{name}' has one position", at="value")
                notes.append(f"SRDF: {what} places '{name}', which is fixed: ignored")


def _check_end_effectors(
    root: XmlElement, srdf: Srdf, links: Collection[str], absent: Absent
) -> None:
    groups = {group.name for group in srdf.groups}
    for item in root.findall("end_effector"):
        names = {("group", item.get("group")), ("group", item.get("parent_group"))}
        if absent & names or item.get("group") not in groups:
            continue
        what = f"end effector '{item.get('name')}'"
        for key, known in (("parent_link", links), ("parent_group", groups)):
            if item.get(key):
                _check_name(item, key, what, key.rpartition("_")[2], known)


def _check_name(item: XmlElement, key: str, what: str, kind: str, known: Collection[str]) -> None:
    """Refuse an attribute that does not name one of the known things of a kind.

    Raises:
        SpecError: It names none of them; with the nearest name.
    """
    name = item.get(key)
    if name not in known:
        hint = did_you_mean(name, sorted(known), f"{kind}s")
        item.refuse(f"{what} names the unknown {kind} '{name}'", hint, at=key)


def _with_groups(
    states: Iterable[NamedState], groups: Mapping[str, PlanningGroup], notes: list[str]
) -> Iterable[NamedState]:
    """The states; one without a group belongs to the first group with all its joints."""
    for state in states:
        if state.group:
            yield state
            continue
        names = set(state.positions)
        group = next((g.name for g in groups.values() if names <= set(g.joint_names)), None)
        if group is None:
            notes.append(f"SRDF: state '{state.name}' names no group; ignored")
            continue
        notes.append(f"SRDF: state '{state.name}' names no group; taken as of '{group}'")
        yield replace(state, group=group)


def _within(state: NamedState, joints: Mapping[str, Joint], notes: list[str]) -> NamedState:
    """A state without virtual joints; adds a note on positions outside the limits."""
    positions = {name: value for name, value in state.positions.items() if name in joints}
    for name, value in positions.items():
        joint = joints[name]
        if joint.is_movable and not joint.lower - 1e-6 <= value <= joint.upper + 1e-6:
            notes.append(
                f"SRDF: state '{state.name}' has {name} at {value:g}, outside its limits "
                f"[{joint.lower:g}, {joint.upper:g}]"
            )
    return replace(state, positions=positions)
