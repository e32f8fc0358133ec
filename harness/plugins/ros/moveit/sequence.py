"""Plans MoveIt's motion sequences: items one after another, blended where they say so."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from harness.cell.cell import Cell
from harness.core.errors import StepFailed
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.plugins.ros.moveit.planning import (
    PILZ,
    Planned,
    group_of,
    pilz_item,
    plan_from,
    scaled,
)
from harness.plugins.ros.moveit.values import positions_of
from harness.ports.motion_planning import MotionRequest
from harness.ports.motions import MotionSequence
from harness.recording.motion_failures import SequenceFailure

MOST_ITEMS = 1000
"""Items of a sequence, as of the step `sequence`."""


def plan_sequence(cell: Cell, request: Any) -> Planned:
    """Plan a MotionSequenceRequest with items: one trajectory that stops where nothing is blended.

    Items are planned with the pipeline of the first one, as in MoveIt.

    Raises:
        StepFailed: With MoveIt's code: an item cannot be planned, or the sequence cannot be read.
    """
    items = [replace(each, req=_in_pipeline(each.req, request.items[0])) for each in request.items]
    _check(items)
    cell.sync_scene()
    group = group_of(cell, items[0].req.group_name)
    first = start = positions_of(cell, items[0].req.start_state)
    columns = [
        cell.description.joint_index[name] for name in cell.description.groups[group].joint_names
    ]
    parts: list[JointTrajectory] = []
    for place, run in _runs(items):
        parts.append(_plan_run(cell, place, run, start))
        start = start.copy()
        start[columns] = parts[-1].positions[-1]
        start = cell.description.with_mimics(start)
    return Planned(_joined(parts), first)


def _in_pipeline(request: Any, first: Any) -> Any:
    return replace(request, pipeline_id=first.req.pipeline_id)


def _check(items: Sequence[Any]) -> None:
    """Raise where MoveIt refuses a sequence, and where it has several groups."""
    radii = [float(each.blend_radius) for each in items]
    states = [each.req.start_state.joint_state for each in items[1:]]
    if len(items) > MOST_ITEMS:
        raise StepFailed("INVALID_MOTION_PLAN", f"a sequence has at most {MOST_ITEMS} items")
    if not all(0 <= radius < np.inf for radius in radii):
        raise StepFailed("INVALID_MOTION_PLAN", "a blend radius is negative or no number")
    if radii[-1] != 0:
        raise StepFailed("INVALID_MOTION_PLAN", "the blend radius of the last item is not 0")
    if any(len(state.name) or len(state.position) for state in states):
        raise StepFailed("INVALID_ROBOT_STATE", "an item after the first one has a start state")
    if len({str(each.req.group_name) for each in items}) > 1:
        raise StepFailed("FAILURE", "the items are of several groups; send a sequence for each")


def _runs(items: Sequence[Any]) -> Iterator[tuple[int, list[Any]]]:
    """The items between two stops, and the place of the first of them."""
    place, run = 0, list[Any]()
    for index, item in enumerate(items):
        run.append(item)
        if item.blend_radius == 0:
            yield place, run
            place, run = index + 1, []


def _plan_run(cell: Cell, place: int, run: Sequence[Any], start: FloatArray) -> JointTrajectory:
    """The trajectory of items that are blended into each other, or of one item.

    Raises:
        StepFailed: With the number of the item.
    """
    name = f"item {place + 1}" if len(run) == 1 else f"items {place + 1} to {place + len(run)}"
    try:
        if len(run) == 1:
            return plan_from(cell, run[0].req, start).trajectory
        return _plan_blended(cell, run, start)
    except StepFailed as failure:
        found, reason = failure.details.find(SequenceFailure), failure.message
        if found is not None and isinstance(failure.__cause__, StepFailed):
            name, reason = f"item {place + found.item + 1}", failure.__cause__.message
        raise StepFailed(failure.code, f"{name}: {reason}", *failure.details) from failure


def _plan_blended(cell: Cell, run: Sequence[Any], start: FloatArray) -> JointTrajectory:
    """Blended items have one speed: the lowest scaling factors of them."""
    if str(run[0].req.pipeline_id) != PILZ:
        raise StepFailed("FAILURE", f"only the motions of {PILZ} are blended")
    group = group_of(cell, run[0].req.group_name)
    items = [pilz_item(cell, each.req, group, start, float(each.blend_radius)) for each in run]
    each = [scaled(cell, item.req) for item in run]
    options = replace(
        each[0],
        velocity_scaling=min(one.velocity_scaling for one in each),
        acceleration_scaling=min(one.acceleration_scaling for one in each),
    )
    return cell.planner.plan(MotionRequest(group, start, MotionSequence(items), options)).trajectory


def _joined(parts: Sequence[JointTrajectory]) -> JointTrajectory:
    """Trajectories one after another; each begins where the one before it ends at rest."""
    begin, times = 0.0, list[FloatArray]()
    for part in parts:
        times.append(part.times + begin)
        begin += part.duration
    first = [0] + [1] * (len(parts) - 1)
    rows = {
        name: np.concatenate(
            [getattr(part, name)[skip:] for part, skip in zip(parts, first, strict=True)]
        )
        for name in ("positions", "velocities", "accelerations")
    }
    stamps = np.concatenate([each[skip:] for each, skip in zip(times, first, strict=True)])
    return replace(parts[0], times=stamps, **rows)
