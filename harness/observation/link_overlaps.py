"""How deep links are inside each other whose contact the SRDF excludes from planner and physics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from harness.core.types import FloatArray, Pair
from harness.observation.body_tracks import (
    MovingBody,
    TrackedShape,
    link_track,
    links_with_shapes,
)
from harness.observation.nearest import ShapePair, pairs_between, smallest_distances
from harness.observation.sampled_clearance import between, knots
from harness.planning.model.robot_model import RobotModel
from harness.recording.run import Finding, Run
from harness.recording.signals import Signals
from harness.robot.description import RobotDescription
from harness.robot.forward_kinematics import LinkPoses

LEAST_DEPTH = 0.001
"""Convex hulls and a calibration are off by as much; less is no overlap [m]."""


def with_link_overlaps(signals: Signals, description: RobotDescription) -> Signals:
    """The signals with the depth of every excluded pair of links that overlaps in this run.

    Pairs that touch with all joints at zero, or as near to it as their limits let them, do so by
    design, as the two sides of a joint do. The others are excluded because somebody, or a sampling
    of random states, found that they never meet. Fingers may meet.
    """
    count = len(signals.times)
    if not count:
        return signals
    shapes = links_with_shapes({link.name: link.collisions for link in description.links})
    apart = _pairs_apart_by_design(description, shapes)
    samples = knots(signals.times, (), ())
    moving = LinkPoses(description, signals.joint_positions[samples])
    overlaps: dict[Pair, FloatArray] = {}
    for pair in apart:
        pairs = _shape_pairs(shapes, moving, *pair, cutoff=0.0)
        distances, _ = smallest_distances(pairs, 0.0, len(samples))
        if float(distances.min()) < -LEAST_DEPTH:
            overlaps[pair] = np.maximum(-between(samples, distances, count), 0.0)
    return replace(signals, link_overlaps=overlaps)


def _pairs_apart_by_design(
    description: RobotDescription, shapes: Mapping[str, tuple[TrackedShape, ...]]
) -> list[Pair]:
    """Excluded pairs of links that are apart with all joints at zero."""
    robot = RobotModel(description)
    lower = np.array([joint.lower for joint in description.movable_joints])
    upper = np.array([joint.upper for joint in description.movable_joints])
    zero = description.with_mimics(np.clip(np.zeros(len(lower)), lower, upper))
    still = LinkPoses(description, zero[None])
    fingers = set() if description.gripper is None else set(description.gripper.links)
    found: list[Pair] = []
    for first, second in sorted(description.allowed_collisions):
        is_rigid = robot.parent_joint(first) == robot.parent_joint(second)
        if {first, second} <= set(shapes) and not is_rigid and not {first, second} <= fingers:
            at_zero = _shape_pairs(shapes, still, first, second)
            if min(pair.distance(0) for pair in at_zero) > LEAST_DEPTH:
                found.append((first, second))
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


def link_overlap_findings(run: Run) -> tuple[Finding, ...]:
    """Links that were inside each other, and that the SRDF excludes from collision checking."""
    found: list[Finding] = []
    for (first, second), depth in run.signals.link_overlaps.items():
        deepest = int(np.argmax(depth))
        time = float(run.signals.times[deepest])
        found.append(
            Finding(
                "link_overlap",
                f"{first} and {second}, which the SRDF excludes from collision checking, were"
                f" {1e3 * depth[deepest]:.1f} mm inside each other; with every joint at zero they"
                " are apart: enable the pair, or expect `collision` with `count_allowed`",
                time,
                values={"pair": [first, second], "depth": float(depth[deepest])},
            )
        )
    return tuple(found)
