"""Motions of several arms that go on at once."""

from __future__ import annotations

from collections.abc import Sequence

from harness.cell.cell import Cell
from harness.core.errors import PlanningFailed
from harness.core.trajectory import JointTrajectory, together
from harness.ports.motions import TimedMotion
from harness.robot.description import ALL_ARMS

DELAYS = 10  # of a motion of another arm, tried one after the other: tenths of what runs already
SET_POINTS = 0.01  # [s], between set points, of which delays are multiples


def follow_together(cell: Cell, motions: Sequence[JointTrajectory]) -> tuple[float, ...]:
    """Follow motions of different arms at once; returns when each begins [s].

    Each was planned around the arms before it at their ends. It begins as soon as the timed
    motion of all of them is free, in tenths of the motion before, at the latest when that has
    ended.

    Raises:
        PlanningFailed: INVALID_MOTION_PLAN, the motions are not free one after the other.
    """
    begun, whole = [(motions[0], 0.0)], motions[0]
    for motion in motions[1:]:
        whole, delay = _earliest(cell, begun, motion, whole.duration)
        begun.append((motion, delay))
    cell.notes.trajectory = whole
    cell.simulator.track(whole)
    return tuple(delay for _, delay in begun)


def _earliest(
    cell: Cell,
    begun: Sequence[tuple[JointTrajectory, float]],
    motion: JointTrajectory,
    longest: float,
) -> tuple[JointTrajectory, float]:
    """Motions of arms and one more, and the earliest begin at which they are free [s].

    Raises:
        PlanningFailed: INVALID_MOTION_PLAN; none is.
    """
    start, names = cell.planning_start(), cell.robot.group_joints(ALL_ARMS)
    rest = start[list(cell.robot.group_indices(ALL_ARMS))]
    for number in range(DELAYS + 1):
        delay = round(number * longest / DELAYS / SET_POINTS) * SET_POINTS
        if number == DELAYS:
            delay = longest
        whole = together([*begun, (motion, delay)], names, rest)
        try:
            cell.planner.plan(cell.motion(ALL_ARMS, TimedMotion(whole)))
        except PlanningFailed:
            if number == DELAYS:
                raise
        else:
            return whole, delay
    raise AssertionError("the last delay is accepted or raises")
