"""Recognises the integrated gripper of an imported arm, from its SRDF's end effector or by name."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import product
from typing import Any

import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.plugins.formats.touching_links import coal_transform, urdf_poses
from harness.robot.collision_shapes import convex_shapes
from harness.robot.description import NamedState, PlanningGroup
from harness.robot.mechanism import Joint, Mimic
from harness.robot.mesh_file import hull_of, is_flat
from harness.robot.robot_yaml import FingerSide, GripperFacts
from harness.robot.solids import DOT, box_corners, coal_geometry
from harness.robot.srdf.srdf import Srdf, link_pair
from harness.robot.urdf.urdf import Urdf

SAMPLES = 11  # Number of joint positions at which the gap between the pads is measured
GRIP_FORCE = 20.0  # Default force of each pad [N]
PAD_FRICTION = 1.0  # Sliding friction coefficient of pads whose file has none
LEAST_TRAVEL = 0.002  # Smallest change of the gap of a hand that can grasp [m]
CLOSED_JAW = 0.01  # Largest gap between a closed jaw and the palm [m]

WIDE = 0.99
"""Share of the largest gap at which a hand counts as open: a jaw can turn on without opening."""

SHARED_RANGE = 0.5
"""Share of the larger range of two alike fingers above which they can follow each other."""


STATES = {"open": ("open", "opened"), "closed": ("close", "closed")}


class NoGripperError(ValueError):
    """The hand does not close two sides with one joint; the message has the reason."""


@dataclass(frozen=True, eq=False)
class IntegratedGripper:
    """A recognised gripper.

    Attributes:
        facts: The gripper as in a robot.yaml.
        urdf: The robot, with two independent fingers coupled.
        srdf: Its SRDF, with the group of the hand.
        center: Halfway between the pads, in palm axes [m], shape (3,).
        body: Middle of the palm's shapes, in palm axes [m], shape (3,); its origin where it has
            none, or is a pad itself.
        pairs: Links of the hand that may touch each other.
        notes: The assumptions, to which more are added.
    """

    facts: GripperFacts
    urdf: Urdf
    srdf: Srdf
    center: FloatArray
    body: FloatArray
    pairs: tuple[tuple[str, str], ...]
    notes: tuple[str, ...]


def recognise(urdf: Urdf, srdf: Srdf, group: PlanningGroup) -> IntegratedGripper:
    """The gripper of a hand's group.

    The two sides are the finger links that move towards each other, or one that moves towards the
    palm. The pad of a side is its link that reaches farthest out; the next one where the gap
    between those does not change. Gaps are measured between the pads' convex parts over the joint's
    range; those of a jaw that turns from its outer half, since at the hinge it always touches.

    Raises:
        NoGripperError: Not one joint, not two sides, or a gap that does not change.
    """
    urdf, joint, notes = _one_joint(urdf, group)
    if not np.isfinite([joint.lower, joint.upper]).all():
        kind = "is continuous and" if joint.kind == "continuous" else ""
        raise NoGripperError(" ".join(f"'{joint.name}' {kind} has no limits".split()))
    if joint.kind != "prismatic" and joint.upper - joint.lower > 2 * np.pi:
        raise NoGripperError(f"'{joint.name}' turns by more than a full turn")
    fingers = _fingers(urdf, joint)
    palm = fingers[0][0].parent
    hand = _Hand(urdf, joint, palm)
    sides = _sides(hand, [links for _, links in fingers])
    positions = np.linspace(joint.lower, joint.upper, SAMPLES)
    pads, gaps = _pads(hand, sides, positions)
    if palm in pads and gaps.min() > CLOSED_JAW:
        raise NoGripperError(f"'{pads[0]}' stays {1000 * gaps.min():.0f} mm away from '{palm}'")
    narrowest = positions[int(gaps.argmin())]
    wide = positions[gaps >= WIDE * gaps.max()]
    widest = wide[int(np.abs(wide - narrowest).argmin())]
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
        friction=_friction(urdf, group.name, pads, notes),
        widths=tuple(zip(positions.tolist(), gaps.tolist(), strict=True)),
    )
    links = [*sides[0], *sides[1], palm]
    pairs = [link_pair(a, b) for n, a in enumerate(links) for b in links[:n] if a != b]
    if not np.isfinite(joint.effort):
        unit = "N" if joint.kind == "prismatic" else "N m"
        notes.append(
            f"gripper '{group.name}': {joint.name} has no effort limit: {most:.3g} {unit} is"
            f" assumed, {5 * GRIP_FORCE:g} N at each pad"
        )
    notes.append(
        f"gripper '{group.name}': {joint.name} moves {pads[0]} and {pads[1]}, up to "
        f"{1000 * gaps.max():.0f} mm apart"
    )
    has_body = hand.has_shape(palm) and palm not in pads
    body = hand.middle(palm, closed) if has_body else np.zeros(3)
    srdf = _with_states(srdf, facts, notes)
    center = hand.center(pads, closed)
    return IntegratedGripper(facts, urdf, srdf, center, body, tuple(pairs), tuple(notes))


def is_gripper(urdf: Urdf, joints: tuple[str, ...]) -> bool:
    """Whether joints close two sides of a gripper."""
    try:
        recognise(urdf, Srdf(), PlanningGroup("gripper", joints))
    except NoGripperError:
        return False
    return True


def _one_joint(urdf: Urdf, group: PlanningGroup) -> tuple[Urdf, Joint, list[str]]:
    """The joint that closes the hand; of alike joints the others mimic the first."""
    joints = {joint.name: joint for joint in urdf.joints}
    changed: dict[str, Joint] = {}
    for name in group.joint_names[1:]:
        first, other = joints[group.joint_names[0]], joints[name]
        multiplier, lower, upper = _mirrored(first, other)
        if not multiplier:
            names = ", ".join(group.joint_names)
            raise NoGripperError(f"a gripper has one driven joint, and the group has {names}")
        joints[first.name] = changed[first.name] = replace(first, lower=lower, upper=upper)
        changed[name] = replace(other, mimic=Mimic(first.name, multiplier))
    if not group.joint_names:
        raise NoGripperError("a gripper has one driven joint, and the group has none")
    leader = joints[group.joint_names[0]]
    if not changed:
        return urdf, leader, []
    coupled = tuple(changed.get(joint.name, joint) for joint in urdf.joints)
    followers = ", ".join(group.joint_names[1:])
    verb = "is" if len(changed) == 2 else "are"
    note = f"gripper '{group.name}': {followers} {verb} made to follow {leader.name}"
    return replace(urdf, joints=coupled), leader, [note]


def _mirrored(first: Joint, second: Joint) -> tuple[float, float, float]:
    """How two alike fingers follow each other, 1 or -1, and the limits of both; 0 if they do not.

    They turn or slide on the same link, and share most of their ranges.
    """
    if first.kind != second.kind or first.parent != second.parent:
        return 0.0, 0.0, 0.0
    best = 0.0, 0.0, 0.0
    for multiplier in (1.0, -1.0):
        ends = sorted((multiplier * second.lower, multiplier * second.upper))
        lower, upper = max(first.lower, ends[0]), min(first.upper, ends[1])
        largest = max(first.upper - first.lower, ends[1] - ends[0])
        shared = upper - lower
        if shared > best[2] - best[1] and shared >= SHARED_RANGE * largest:
            best = multiplier, lower, upper
    return best


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
    """Where the solids of a hand are at joint positions, in palm axes.

    Attributes:
        out: Direction from the palm to the fingers, shape (3,).
    """

    def __init__(self, urdf: Urdf, joint: Joint, palm: str) -> None:
        self.joint, self.palm, self.out = joint, palm, np.zeros(3)
        self._shapes = {link.name: link.collisions for link in urdf.links}
        self._poses = cache(lambda position: urdf_poses(urdf, {joint.name: position}))
        self._pads: dict[str, list[tuple[Any, SE3]]] = {}

    def has_shape(self, link: str) -> bool:
        return bool(self._shapes[link])

    def pose(self, link: str, position: float) -> SE3:
        """T_palm_link."""
        poses = self._poses(position)
        return poses[self.palm].inverse() @ poses[link]

    def corners(self, link: str, position: float) -> list[FloatArray]:
        """The corners of each solid of a link [m], shape (n, 3) each."""
        pose = self.pose(link, position)
        return [
            (pose @ shape.pose).apply(_hull_corners(coal_geometry(shape)))
            for shape in self._shapes[link]
        ]

    def middle(self, link: str, position: float) -> FloatArray:
        """Mean of the boxes around a link's solids, shape (3,)."""
        ends = [(each.min(axis=0), each.max(axis=0)) for each in self.corners(link, position)]
        return np.mean(ends, axis=(0, 1))

    def reach(self, link: str, position: float) -> float:
        """How far out a link extends [m]; -inf for one without shapes."""
        ends = [float((each @ self.out).max()) for each in self.corners(link, position)]
        return max(ends, default=-np.inf)

    def pad(self, link: str) -> list[tuple[Any, SE3]]:
        """The convex parts of a pad with their T_link_shape, or what was kept of them."""
        if link not in self._pads:
            shapes = convex_shapes(self._shapes[link])
            self._pads[link] = [(coal_geometry(shape), shape.pose) for shape in shapes]
        return self._pads[link]

    def keep_outer_half(self, link: str) -> None:
        """Measure gaps of a finger that slides from the outer half of what is beyond the palm."""
        pose = self.pose(link, self.joint.lower)
        start = self.reach(self.palm, self.joint.lower) - float(pose.translation @ self.out)
        self._keep(link, pose.rotation.T @ self.out, start)

    def keep_far_from_hinge(self, link: str) -> None:
        """Measure gaps of a jaw that turns from what is farther away than half of its reach."""
        lower = self.joint.lower
        hinge = self.pose(link, lower).inverse() @ self.pose(self.joint.child, lower)
        axis = hinge.rotation @ self.joint.axis
        arms = np.concatenate([pose.apply(_hull_corners(solid)) for solid, pose in self.pad(link)])
        arms = arms - hinge.translation
        arms = arms - np.outer(arms @ axis, axis)
        farthest = max(arms, key=np.linalg.norm)
        farthest = farthest / np.linalg.norm(farthest)
        self._keep(link, farthest, float(farthest @ hinge.translation))

    def _keep(self, link: str, out: FloatArray, start: float) -> None:
        """Keep of a pad what is beyond the middle between a start and its farthest corner.

        Args:
            link: The link of the pad.
            out: The unit vector along which distances count, link axes.
            start: The distance where the half begins; before the parts, their nearest corner [m].
        """
        parts = [pose.apply(_hull_corners(solid)) for solid, pose in self.pad(link)]
        ends = np.concatenate([points @ out for points in parts])
        low, high = float(ends.min()), float(ends.max())
        middle = 0.5 * (high + (start if low < start < high else low))
        cut = [_above(points, points @ out - middle) for points in parts]
        solids = [points for points in cut if len(points) > 3 and not is_flat(points)]
        self._pads[link] = [(hull_of(points), SE3.identity()) for points in solids]

    def gap(self, pads: tuple[str, str], position: float) -> float:
        """Distance between the parts of two pads, 0 where they overlap [m]."""
        first, second = (
            [(solid, self.pose(pad, position) @ place) for solid, place in self.pad(pad)]
            for pad in pads
        )
        pairs = product(first, second)
        return max(min((_distance(*one, *other) for one, other in pairs), default=np.inf), 0.0)

    def center(self, pads: tuple[str, str], position: float) -> FloatArray:
        """Midpoint between the pads' centres; where a single jaw meets the palm, shape (3,)."""
        if self.palm not in pads:
            return 0.5 * (self.middle(pads[0], position) + self.middle(pads[1], position))
        jaw = next(pad for pad in pads if pad != self.palm)
        at, dot = self.pose(jaw, position), _dot()
        pairs = [
            (_distance(solid, at @ place, *part), (at @ place).apply(_hull_corners(solid)), part)
            for solid, place in self.pad(jaw)
            for part in self.pad(self.palm)
        ]
        most = min(distance for distance, _, _ in pairs) + LEAST_TRAVEL
        meeting = [
            corner
            for distance, corners, part in pairs
            if distance <= most
            for corner in corners
            if _distance(*part, dot, SE3(np.eye(3), corner)) <= most
        ]
        if not meeting:  # edges or faces are nearest
            return self.middle(jaw, position)
        return 0.5 * (np.min(meeting, axis=0) + np.max(meeting, axis=0))


def _dot() -> Any:
    import coal

    return coal.Sphere(DOT)


def _distance(first: Any, first_pose: SE3, second: Any, second_pose: SE3) -> float:
    """Distance between two of Coal's geometries, below 0 where they overlap [m]."""
    import coal

    result = coal.DistanceResult()
    places = coal_transform(first_pose), coal_transform(second_pose)
    coal.distance(first, places[0], second, places[1], coal.DistanceRequest(), result)
    return float(result.min_distance)


def _above(points: FloatArray, heights: FloatArray) -> FloatArray:
    """The corners of what of a convex body is above a plane, from its corners and their heights."""
    high, low = np.flatnonzero(heights > 0), np.flatnonzero(heights <= 0)
    share = (heights[high][:, None] / (heights[high][:, None] - heights[low]))[..., None]
    crossed = points[high][:, None] + share * (points[low] - points[high][:, None])
    return np.concatenate([points[high], crossed.reshape(-1, 3)])


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
    along = max(moves, key=np.linalg.norm)
    if not along.any():
        raise NoGripperError("its fingers do not move")
    along = along if moves[0] @ along >= 0 else -along
    first = [links for links, move in zip(shaped, moves, strict=True) if along @ move > 0]
    second = [links for links, move in zip(shaped, moves, strict=True) if along @ move <= 0]
    sides = tuple(tuple(link for links in side for link in links) for side in (first, second))
    if sides[1]:
        return sides
    if len(shaped) > 1 or not hand.has_shape(hand.palm):
        raise NoGripperError("its fingers do not move towards each other")
    return sides[0], (hand.palm,)


def _pads(
    hand: _Hand, sides: Sequence[tuple[str, ...]], positions: FloatArray
) -> tuple[tuple[str, str], FloatArray]:
    """The link of each side that touches objects, and the gap between them at positions."""
    fingers = [link for side in sides for link in side if link != hand.palm]
    has_palm, slides = any(hand.palm in side for side in sides), hand.joint.kind == "prismatic"
    middle = 0.5 * (hand.joint.lower + hand.joint.upper)
    out = np.mean([hand.middle(link, middle) for link in fingers], axis=0)
    if (
        hand.has_shape(hand.palm)
        and not has_palm
        and out @ (out - hand.middle(hand.palm, middle)) < 0
    ):
        out = -out  # the palm has its origin at the fingertips
    hand.out = out / max(float(np.linalg.norm(out)), 1e-9)
    if has_palm and not slides:  # a jaw always touches at its hinge
        for link in fingers:
            hand.keep_far_from_hinge(link)
    first, second = (
        sorted(side, key=lambda link: hand.reach(link, middle), reverse=True) for side in sides
    )
    ranks = [(n, m) for n in range(len(first)) for m in range(len(second))]
    ranks.sort(key=lambda rank: (abs(rank[0] - rank[1]), sum(rank)))  # alike fingers, alike pads
    for pads in ((first[n], second[m]) for n, m in ranks):
        gaps = [hand.gap(pads, float(position)) for position in positions]
        if np.ptp(gaps) < LEAST_TRAVEL:
            continue
        if slides and not has_palm and hand.out.any():
            for pad in pads:
                hand.keep_outer_half(pad)
            gaps = [hand.gap(pads, float(position)) for position in positions]
        return pads, np.array(gaps)
    raise NoGripperError(f"the gap between {first[0]} and {second[0]} does not change")


def _friction(urdf: Urdf, group: str, pads: Sequence[str], notes: list[str]) -> float:
    """The sliding friction coefficient of the pads: the smaller one where they differ."""
    known = [urdf.frictions.get(pad, PAD_FRICTION) for pad in pads]
    if urdf.frictions.keys() & set(pads):
        notes.append(f"gripper '{group}': its pads have the friction {min(known):g} of the file")
    return min(known)


def _with_states(srdf: Srdf, facts: GripperFacts, notes: list[str]) -> Srdf:
    """The SRDF with states `open` and `close` of the hand, unless it has such ones.

    States of the hand that do not place its joint are left out.
    """
    own = [state for state in srdf.states if state.group == facts.group]
    empty = [state for state in own if facts.joint not in state.positions]
    if empty:
        names = ", ".join(f"'{state.name}'" for state in empty)
        notes.append(f"SRDF: {names} of '{facts.group}' left out: '{facts.joint}' is not placed")
    named = {state.name.lower() for state in own if state not in empty}
    ends = {"open": facts.open_position, "closed": facts.closed_position}
    added = (
        NamedState(STATES[word][0], facts.group, {facts.joint: position})
        for word, position in ends.items()
        if named.isdisjoint(STATES[word])
    )
    kept = (state for state in srdf.states if state not in empty)
    return replace(srdf, states=(*kept, *added))


def _state(srdf: Srdf, group: str, joint: str, word: str, default: float) -> float:
    """The joint's position in the group's state of that name."""
    for state in srdf.states:
        if state.group == group and state.name.lower() in STATES[word] and joint in state.positions:
            return state.positions[joint]
    return default


def _hull_corners(solid: Any) -> FloatArray:
    """Corners of a convex hull; of another of Coal's geometries those of its box, (n, 3) [m]."""
    if hasattr(solid, "points"):
        return np.array(solid.points(), dtype=float).reshape(-1, 3)
    return box_corners(solid)
