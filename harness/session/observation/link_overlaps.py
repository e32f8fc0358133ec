"""Distances and overlaps of links whose contact the SRDF excludes from planner and physics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from harness.core.kinematics import LinkPoses
from harness.core.types import FloatArray, Pair
from harness.planning.model.robot_model import RobotModel
from harness.recording.signals import Signals
from harness.robot.description import RobotDescription
from harness.session.observation.body_tracks import (
    MovingBody,
    TrackedShape,
    link_track,
    links_with_shapes,
)
from harness.session.observation.nearest import ShapePair, pairs_between, smallest_distances
from harness.session.observation.sampled_clearance import between, knots

SELF = ("robot", "robot")
LEAST_DEPTH = 0.001  # convex hulls and a calibration are off by as much; less is no overlap [m]


def with_excluded_links(signals: Signals, description: RobotDescription) -> Signals:
    """The signals with the distances and the overlaps of links whose contact the SRDF excludes.

    Pairs that touch with all joints at zero, or as near to it as their limits let them, do so by
    design, as the two sides of a joint do. The others are excluded because somebody, or a sampling
    of random states, found that they never meet. The links of a hand may meet. A pair counts as a
    distance of the robot to itself where it is nearer than it is with all joints at zero.
    """
    count = len(signals.times)
    if not count:
        return signals
    shapes = links_with_shapes({link.name: link.collisions for link in description.links})
    apart = _pairs_apart_by_design(description, shapes)
    samples = knots(signals.times, (), ())
    moving = LinkPoses(description.joints, signals.joint_positions[samples])
    overlaps: dict[Pair, FloatArray] = {}
    found = signals
    for pair, at_zero in apart.items():
        cutoff = min(signals.clearance_cutoff, at_zero - LEAST_DEPTH)
        pairs = _shape_pairs(shapes, moving, *pair, cutoff=cutoff)
        distances, _ = smallest_distances(pairs, cutoff, len(samples))
        if float(distances.min()) >= cutoff:
            continue
        every = between(samples, distances, count)
        link = description.link_names.index(pair[1])
        for key in {SELF, _arms_of(pair, description) or SELF}:
            found = _with_distances(found, key, np.where(every < cutoff, every, np.inf), link)
        if float(distances.min()) < -LEAST_DEPTH:
            overlaps[pair] = np.maximum(-every, 0.0)
    return replace(found, link_overlaps=overlaps)


def _arms_of(pair: Pair, description: RobotDescription) -> Pair | None:
    """The two arms that two links belong to, in the robot's order; None where they do not."""
    owners = {description.arm_of_link.get(link, "") for link in pair}
    names = [arm.name for arm in description.arms if arm.name in owners]
    return (names[0], names[1]) if len(names) == 2 else None


def _with_distances(signals: Signals, key: Pair, nearest: FloatArray, link: int) -> Signals:
    """The signals with distances of the robot, or an arm, where they are smallest; inf: unknown."""
    known = signals.clearances.get(key, np.full(len(nearest), signals.clearance_cutoff))
    of_link = signals.clearance_links.get(key, np.full(len(nearest), -1))
    is_nearer = nearest < known
    return replace(
        signals,
        clearances={**signals.clearances, key: np.where(is_nearer, nearest, known)},
        clearance_links={**signals.clearance_links, key: np.where(is_nearer, link, of_link)},
    )


def _pairs_apart_by_design(
    description: RobotDescription, shapes: Mapping[str, tuple[TrackedShape, ...]]
) -> dict[Pair, float]:
    """Excluded pairs of links that are apart with all joints at zero, and how far [m]."""
    robot = RobotModel(description)
    lower = np.array([joint.lower for joint in description.movable_joints])
    upper = np.array([joint.upper for joint in description.movable_joints])
    zero = description.with_mimics(np.clip(np.zeros(len(lower)), lower, upper))
    still = LinkPoses(description.joints, zero[None])
    hands = [{*hand.links, hand.palm_link} for hand in description.grippers]
    found: dict[Pair, float] = {}
    for first, second in sorted(description.allowed_collisions):
        is_rigid = robot.parent_joint(first) == robot.parent_joint(second)
        is_hand = any({first, second} <= hand for hand in hands)
        if {first, second} <= set(shapes) and not is_rigid and not is_hand:
            pairs = _shape_pairs(shapes, still, first, second)
            at_zero = min(pair.distance(0) for pair in pairs)
            if at_zero > LEAST_DEPTH:
                found[first, second] = at_zero
    return found


def _shape_pairs(
    shapes: Mapping[str, tuple[TrackedShape, ...]],
    poses: LinkPoses,
    first: str,
    second: str,
    cutoff: float = np.inf,
) -> list[ShapePair]:
    one, other = (MovingBody(shapes[name], link_track(poses, name)) for name in (first, second))
    return pairs_between([one], other, cutoff)
