"""sequence: Pilz's motions one after the other, blended, all or none."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.goal_checks import check_goal
from harness.cell.goals import group_of, link_limits, resolve_goal
from harness.cell.scope import At, Scope
from harness.cell.step import Step
from harness.core.state_words import stated_name
from harness.core.types import FloatArray
from harness.language.base import NonNegativeLength, SpecModel
from harness.language.goals import GoalFields, LineFields
from harness.plugins.motions.arc import ArcFields, arc_point, check_arc
from harness.ports.motions import MotionSequence
from harness.ports.motions import SequenceItem as PlannedItem

LinkPosition = tuple[str, str, FloatArray]  # a link, a frame, and the link's position in it


class SequenceItemSpec(SpecModel):
    """One motion of a sequence, and how it blends into the next."""

    one_of = ("ptp", "lin", "circ")

    ptp: GoalFields | None = Field(
        default=None, description="The motion is a joint motion, as of the step `ptp`."
    )
    lin: LineFields | None = Field(
        default=None, description="The motion is a straight line, as of the step `lin`."
    )
    circ: ArcFields | None = Field(
        default=None, description="The motion is an arc, as of the step `circ`."
    )
    blend_radius: NonNegativeLength = Field(
        default=0.0,
        description="Inside this distance of its goal the motion blends into the next one; with 0 "
        "it stops there [m].",
    )

    @property
    def kind(self) -> str:
        """The verb of the item's motion."""
        return "ptp" if self.ptp else "lin" if self.lin else "circ"

    @property
    def motion(self) -> GoalFields:
        """The item's one motion."""
        motion = self.ptp or self.lin or self.circ
        if motion is None:
            raise ValueError("the model has one motion")
        return motion


class Sequence(Step):
    """Run motions that blend into each other, all or none: Pilz's motion sequence.

    The blend radii of two motions that follow each other are together less than the distance
    between their goals.
    """

    short = "items"
    short_is_list = True

    verb: ClassVar[str] = "sequence"
    moves_arm: ClassVar[bool] = True
    has_corners: ClassVar[bool] = True

    items: Annotated[tuple[SequenceItemSpec, ...], Field(min_length=1, max_length=1000)] = Field(
        description="The motions, in order."
    )

    def summary(self) -> str:
        return ", ".join(item.kind for item in self.items)

    def check(self, at: At) -> None:
        group = at.scope.check_group(self.group, at.key("group"))
        for index, item in enumerate(self.items):
            inside = At(at.scope, at.key("items", index, item.kind))
            check_goal(item.motion, self.group, inside)
            if item.circ is not None:
                check_arc(item.circ, inside)
        _check_blends(self, group, at)

    def execute(self, cell: Cell) -> None:
        """Resolve every goal for the present state, plan all motions, follow them."""
        cell.sync_scene()
        group = group_of(cell, self.group)
        items = [_planned(item, group, cell) for item in self.items]
        cell.move(group, MotionSequence(items))


def _planned(item: SequenceItemSpec, group: str, cell: Cell) -> PlannedItem:
    goal, radius = resolve_goal(item.motion, group, cell), item.blend_radius
    if item.circ is not None:
        limits = link_limits(item.circ.cartesian_limits)
        return PlannedItem("circ", goal, arc_point(item.circ, cell), radius, limits)
    if item.lin is not None:
        return PlannedItem("lin", goal, None, radius, link_limits(item.lin.cartesian_limits))
    return PlannedItem("ptp", goal, None, radius)


def _check_blends(step: Sequence, group: str, at: At) -> None:
    """Report a blend after the last motion, and blends that overlap: Pilz's rules.

    Goals whose place depends on the run are left to the planner.
    """
    scope = at.scope
    last = len(step.items) - 1
    if step.items[last].blend_radius > 0:
        scope.problems.add(
            at.key("items", last, "blend_radius"),
            "the last motion of a sequence has nothing to blend into",
            "leave its `blend_radius` out",
            needs=(),
        )
    places = [_place(item.motion, group, scope) for item in step.items]
    for index, (first, second) in enumerate(pairwise(step.items)):
        radii = first.blend_radius, second.blend_radius if index + 1 < last else 0.0
        distance = _distance(places[index], places[index + 1])
        if first.blend_radius <= 0 or not distance or sum(radii) < distance:
            continue
        scope.problems.add(
            at.key("items", index, "blend_radius"),
            f"the blend radii overlap: {_mm(radii[0])} here and {_mm(radii[1])} at the next motion,"
            f" whose goal is {_mm(distance)} away",
            "together they must be less than the distance between the goals",
        )


def _place(goal: GoalFields, group: str, scope: Scope) -> LinkPosition | None:
    """Where a goal is, if the file says; frames are resolved all at once, before the motion."""
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


def _place_of_joints(goal: GoalFields, group: str, scope: Scope) -> LinkPosition | None:
    description = scope.description
    if group not in description.groups or scope.link_pose is None:
        return None
    states = description.states_of(group)
    if goal.named_target is not None:
        name = stated_name(goal.named_target, states)
        if name not in states:
            return None
        given = dict(states[name].positions)
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


def _distance(first: LinkPosition | None, second: LinkPosition | None) -> float | None:
    if first is None or second is None or first[:2] != second[:2]:
        return None
    return float(np.linalg.norm(second[2] - first[2]))


def _mm(length: float) -> str:
    return f"{1000 * length:.4g} mm"
