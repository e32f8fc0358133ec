"""Recognises the integrated gripper of an imported arm, from its SRDF's end effector or by name."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.robot.description import Joint, Link, Mimic, PlanningGroup
from harness.robot.robot_yaml import FingerSide, GripperFacts
from harness.robot.solids import coal_geometry
from harness.robot.srdf.default_pairs import coal_transform, urdf_poses
from harness.robot.srdf.srdf import Srdf, link_pair
from harness.robot.urdf.urdf import Urdf

SAMPLES = 11
"""Number of joint positions at which the gap between the pads is measured."""

GRIP_FORCE = 20.0
"""Default force of each pad [N]."""

LEAST_TRAVEL = 0.002
"""Smallest change of the gap of a hand that can grasp [m]."""

STATES = {"open": ("open", "opened"), "closed": ("close", "closed")}


class NoGripperError(ValueError):
    """The hand does not close two sides with one joint; the message has the reason."""


@dataclass(frozen=True, eq=False)
class IntegratedGripper:
    """A recognised gripper.

    Attributes:
        facts: The gripper as in a robot.yaml.
        urdf: The robot, with two independent fingers coupled.
        center: Halfway between the pads, in palm axes [m], shape (3,).
        pairs: Links of the hand that may touch each other.
        notes: The assumptions, to which more are added.
    """

    facts: GripperFacts
    urdf: Urdf
    center: FloatArray
    pairs: tuple[tuple[str, str], ...]
    notes: tuple[str, ...]


def recognise(urdf: Urdf, srdf: Srdf, group: PlanningGroup) -> IntegratedGripper:
    """The gripper of a hand's group.

    The two sides are the finger links that move towards each other, or one that moves towards the
    palm. The pad of a side is its link that reaches farthest out; gaps are measured between the
    pads' shapes over the joint's range.

    Raises:
        NoGripperError: Not one joint, not two sides, or a gap that does not change.
    """
    urdf, joint, notes = _one_joint(urdf, group)
    if not np.isfinite([joint.lower, joint.upper]).all():
        raise NoGripperError(f"'{joint.name}' has no limits")
    fingers = _fingers(urdf, joint)
    palm = fingers[0][0].parent
    hand = _Hand(urdf, joint, palm)
    sides = _sides(hand, [links for _, links in fingers])
    pads = tuple(_pad(hand, links, sides) for links in sides)
    positions = np.linspace(joint.lower, joint.upper, SAMPLES)
    gaps = np.array([hand.gap(pads, float(position)) for position in positions])
    if np.ptp(gaps) < LEAST_TRAVEL:
        raise NoGripperError(f"the gap between {pads[0]} and {pads[1]} does not change")
    widest, narrowest = positions[int(gaps.argmax())], positions[int(gaps.argmin())]
    opened = _state(srdf, group.name, joint.name, "open", float(widest))
    closed = _state(srdf, group.name, joint.name, "closed", float(narrowest))
    slope = float(np.abs(np.diff(gaps) / np.diff(positions)).max())
    most = joint.effort if np.isfinite(joint.effort) else 5 * GRIP_FORCE * slope
    facts = GripperFacts(
        group=group.name,
        joint=joint.name,
        palm_link=palm,
        sides={
            name: FingerSide(links=links, pad=pad)
            for name, links, pad in zip(("first", "second"), sides, pads, strict=True)
        },
        open_position=opened,
        closed_position=closed,
        grip_effort=min(most, GRIP_FORCE * slope),
        max_effort=most,
        widths=tuple(zip(positions.tolist(), gaps.tolist(), strict=True)),
    )
    links = [*sides[0], *sides[1], palm]
    pairs = [link_pair(a, b) for n, a in enumerate(links) for b in links[:n] if a != b]
    notes.append(
        f"gripper '{group.name}': {joint.name} moves {pads[0]} and {pads[1]}, up to "
        f"{1000 * gaps.max():.0f} mm apart"
    )
    return IntegratedGripper(facts, urdf, hand.center(pads, closed), tuple(pairs), tuple(notes))


def _one_joint(urdf: Urdf, group: PlanningGroup) -> tuple[Urdf, Joint, list[str]]:
    """The joint that closes the hand; of two equal joints the second mimics the first."""
    joints = {joint.name: joint for joint in urdf.joints}
    driven = [joints[name] for name in group.joint_names]
    if len(driven) == 1:
        return urdf, driven[0], []
    if len(driven) == 2:
        first, second = driven
        alike = (
            first.kind == second.kind
            and first.parent == second.parent
            and (first.lower, first.upper) == (second.lower, second.upper)
        )
        if alike:
            follower = replace(second, mimic=Mimic(first.name))
            changed = tuple(follower if j.name == second.name else j for j in urdf.joints)
            note = f"gripper '{group.name}': {second.name} is made to follow {first.name}"
            return replace(urdf, joints=changed), first, [note]
    names = ", ".join(group.joint_names) or "none"
    raise NoGripperError(f"a gripper has one driven joint, and the group has {names}")


def _fingers(urdf: Urdf, joint: Joint) -> list[tuple[Joint, tuple[str, ...]]]:
    """The first joints that move with the hand, each with all links distal to it."""
    moving = {
        j.name for j in urdf.joints if joint.name in (j.name, j.mimic.joint if j.mimic else "")
    }
    finger_of: dict[str, str] = {}
    found: dict[str, tuple[Joint, list[str]]] = {}
    for each in urdf.joints:
        first = finger_of.get(each.parent) or (each.name if each.name in moving else "")
        if first:
            finger_of[each.child] = first
            found.setdefault(first, (each, []))[1].append(each.child)
    return [(first, tuple(links)) for first, links in found.values()]


class _Hand:
    """The hand's solids at joint positions, in palm axes."""

    def __init__(self, urdf: Urdf, joint: Joint, palm: str) -> None:
        self.urdf, self.joint, self.palm = urdf, joint, palm
        self._links: Mapping[str, Link] = {link.name: link for link in urdf.links}
        self._poses: dict[float, dict[str, SE3]] = {}

    def has_shape(self, link: str) -> bool:
        return bool(self._links[link].collisions)

    def pose(self, link: str, position: float) -> SE3:
        """T_palm_link."""
        if position not in self._poses:
            self._poses[position] = urdf_poses(self.urdf, {self.joint.name: position})
        poses = self._poses[position]
        return poses[self.palm].inverse() @ poses[link]

    def solids(self, link: str, position: float) -> list[tuple[Any, SE3]]:
        """Coal's geometries of a link with their T_palm_shape."""
        pose = self.pose(link, position)
        return [(coal_geometry(s), pose @ s.pose) for s in self._links[link].collisions]

    def middle(self, link: str, position: float) -> FloatArray:
        """Mean of the boxes around a link's solids, shape (3,)."""
        return np.mean([np.mean(box, axis=0) for box in self.boxes(link, position)], axis=0)

    def boxes(self, link: str, position: float) -> list[FloatArray]:
        """Lowest and highest corner of each solid, palm axes, shape (2, 3)."""
        found: list[FloatArray] = []
        for solid, pose in self.solids(link, position):
            solid.computeLocalAABB()
            box = solid.aabb_local
            low, high = np.array(box.min_), np.array(box.max_)
            ends = np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, -1).T
            corners = pose.apply(ends)
            found.append(np.array([corners.min(axis=0), corners.max(axis=0)]))
        return found

    def gap(self, pads: tuple[str, ...], position: float) -> float:
        """Distance between two links' solids, 0 where they overlap [m]."""
        import coal

        first, second = (self.solids(pad, position) for pad in pads)
        nearest = np.inf
        for solid, pose in first:
            for other, other_pose in second:
                result = coal.DistanceResult()
                at, other_at = coal_transform(pose), coal_transform(other_pose)
                coal.distance(solid, at, other, other_at, coal.DistanceRequest(), result)
                nearest = min(nearest, float(result.min_distance))
        return max(nearest, 0.0)

    def center(self, pads: tuple[str, ...], position: float) -> FloatArray:
        """Midpoint between the pads' centres, shape (3,)."""
        return 0.5 * (self.middle(pads[0], position) + self.middle(pads[1], position))


def _sides(hand: _Hand, fingers: Sequence[tuple[str, ...]]) -> tuple[tuple[str, ...], ...]:
    """Finger links of both sides, by closing direction; a single side closes on the palm."""
    shaped = [tuple(link for link in links if hand.has_shape(link)) for links in fingers]
    shaped = [links for links in shaped if links]
    if not shaped:
        raise NoGripperError("its fingers have no collision shapes")
    lower, upper = hand.joint.lower, hand.joint.upper
    moves = [
        np.sum([hand.middle(link, upper) - hand.middle(link, lower) for link in links], axis=0)
        for links in shaped
    ]
    first = [links for links, move in zip(shaped, moves, strict=True) if moves[0] @ move > 0]
    second = [links for links, move in zip(shaped, moves, strict=True) if moves[0] @ move <= 0]
    sides = tuple(tuple(link for links in side for link in links) for side in (first, second))
    if sides[1]:
        return sides
    if len(shaped) > 1 or not hand.has_shape(hand.palm):
        raise NoGripperError("its fingers do not move towards each other")
    return sides[0], (hand.palm,)


def _pad(hand: _Hand, links: tuple[str, ...], sides: Sequence[tuple[str, ...]]) -> str:
    """The link that extends farthest from the palm, in the fingers' direction."""
    middle = 0.5 * (hand.joint.lower + hand.joint.upper)
    fingers = [link for side in sides for link in side if link != hand.palm]
    out = np.mean([hand.middle(link, middle) for link in fingers], axis=0)
    out = out / max(float(np.linalg.norm(out)), 1e-9)

    def reach(link: str) -> float:
        boxes = hand.boxes(link, middle)
        return max(float(np.maximum(low * out, high * out).sum()) for low, high in boxes)

    return max(links, key=reach)


def _state(srdf: Srdf, group: str, joint: str, word: str, default: float) -> float:
    """The joint's position in the group's state of that name."""
    for state in srdf.states:
        if state.group == group and state.name.lower() in STATES[word] and joint in state.positions:
            return state.positions[joint]
    return default
