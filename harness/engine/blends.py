"""Blend radii of a sequence, as far as the file alone tells: none reaches into the next."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from harness.cell.program import Loc
from harness.cell.scope import Scope
from harness.core.types import FloatArray
from harness.spec.goals import GoalFields
from harness.spec.steps import Sequence, SequenceItem

Place = tuple[str, str, FloatArray]
"""Which link, in which frame, where."""


def check_blends(step: Sequence, group: str, loc: Loc, scope: Scope) -> None:
    """Report a blend after the last motion, and blends that overlap: Pilz's rules.

    What a motion's place depends on the run for is left to the planner.
    """
    last = len(step.items) - 1
    if step.items[last].blend_radius > 0:
        scope.problems.add(
            (*loc, "items", last, "blend_radius"),
            "the last motion of a sequence has nothing to blend into",
            "leave its `blend_radius` out",
        )
    places = [_place(motion_of(item), group, scope) for item in step.items]
    for index, (first, second) in enumerate(pairwise(step.items)):
        radii = first.blend_radius, second.blend_radius if index + 1 < last else 0.0
        distance = _distance(places[index], places[index + 1])
        if first.blend_radius <= 0 or distance is None or sum(radii) < distance:
            continue
        scope.problems.add(
            (*loc, "items", index, "blend_radius"),
            f"the blend radii overlap: {_mm(radii[0])} here and {_mm(radii[1])} at the next motion,"
            f" whose goal is {_mm(distance)} away",
            "together they must be less than the distance between the goals",
        )


def motion_of(item: SequenceItem) -> GoalFields:
    """The item's one motion."""
    motion = item.ptp or item.lin or item.circ
    if motion is None:
        raise ValueError("the model has one motion")
    return motion


def _place(goal: GoalFields, group: str, scope: Scope) -> Place | None:
    """Where a goal is, if the file tells; frames are resolved all at once, before the motion."""
    description = scope.description
    link = goal.link or description.tcp_link
    at = goal.pose or goal.position
    if at is None:
        return _place_of_joints(goal, group, scope)
    if at.frame in description.static_links and scope.link_pose is not None:
        base = scope.link_pose(description.start_positions(), at.frame)
        return link, "world", base.apply(np.array(at.xyz))
    obj = scope.objects.get(at.frame)
    if obj is not None and obj.is_static:
        return link, "world", obj.pose.apply(np.array(at.xyz))
    return link, at.frame, np.array(at.xyz, dtype=float)


def _place_of_joints(goal: GoalFields, group: str, scope: Scope) -> Place | None:
    description = scope.description
    if group not in description.groups or scope.link_pose is None:
        return None
    states = description.states_of(group)
    if goal.named_target is not None:
        if goal.named_target not in states:
            return None
        given = dict(states[goal.named_target].positions)
    else:
        given = dict(goal.joints or {})
    names = description.groups[group].joint_names
    if any(name not in given for name in names):
        return None
    positions = description.start_positions()
    positions[list(description.group_indices(group))] = [given[name] for name in names]
    tcp = description.tcp_link
    pose = scope.link_pose(description.with_mimics(positions), tcp)
    return tcp, "world", pose.translation


def _distance(first: Place | None, second: Place | None) -> float | None:
    if first is None or second is None or first[:2] != second[:2]:
        return None
    return float(np.linalg.norm(second[2] - first[2]))


def _mm(length: float) -> str:
    return f"{1000 * length:.4g} mm"
