"""Legs that follow each other: blended or with a stop between them, timed and verified."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.amounts import amount
from harness.core.errors import PlanningFailed
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.cartesian.link_motion import (
    ORIENTATION_DEVIATION,
    POSITION_DEVIATION,
    LinkMotions,
)
from harness.planning.cartesian.link_timing import LinkRates
from harness.planning.cartesian.tracing import Trace, off_path
from harness.planning.timing.limits import TimingError
from harness.planning.timing.timing import joined, time_straight
from harness.plugins.motions.curve_timing import RatedCurve, nearest_knots, time_curve
from harness.plugins.motions.joint_spline import JointSpline
from harness.plugins.motions.leg import BlendFailure, Leg, Transition, transition
from harness.recording.motion_failures import DeviationFailure


@dataclass(frozen=True, eq=False)
class LegRun:
    """Legs between two stops, and the transitions between them (one fewer)."""

    legs: tuple[Leg, ...]
    transitions: tuple[Transition, ...]


def runs_of(legs: Sequence[Leg], radii: Sequence[float], motions: LinkMotions) -> list[LegRun]:
    """The legs, parted where nothing is blended.

    Args:
        legs: The legs in their order.
        radii: The radii of the blend after each leg but the last [m]; 0 for a stop.
        motions: The motions of the call.

    Raises:
        PlanningFailed: As `transition`, and INVALID_MOTION_PLAN when two blends overlap.
    """
    runs: list[LegRun] = []
    some: list[Leg] = [legs[0]]
    blends: list[Transition] = []
    for leg, radius in zip(legs[1:], radii, strict=True):
        if radius <= 0:
            runs.append(LegRun(tuple(some), tuple(blends)))
            some, blends = [leg], []
            continue
        blend = transition(some[-1], leg, radius, motions.task.checker)
        if blends and blends[-1].enters >= blend.leaves:
            raise PlanningFailed(
                "INVALID_MOTION_PLAN",
                f"the blends before and after {some[-1].name} overlap: make a radius smaller",
                BlendFailure(radius),
            )
        some.append(leg)
        blends.append(blend)
    return [*runs, LegRun(tuple(some), tuple(blends))]


def time_runs(runs: Sequence[LegRun], motions: LinkMotions) -> JointTrajectory:
    """One trajectory over all runs, at rest between them.

    Raises:
        PlanningFailed: INVALID_MOTION_PLAN, when limits or ways cannot be kept.
    """
    try:
        pieces = [_time_run(run, motions) for run in runs]
    except TimingError as problem:
        raise PlanningFailed("INVALID_MOTION_PLAN", str(problem), *problem.details) from problem
    return joined(pieces)


def _time_run(run: LegRun, motions: LinkMotions) -> JointTrajectory:
    task = motions.task
    names = task.space.joint_names
    if len(run.legs) == 1:
        leg = run.legs[0]
        if leg.path is None or leg.rates is None:
            return time_straight(names, leg.positions[0], leg.positions[-1], task.limits)
        parameters = np.linspace(0.0, 1.0, len(leg.positions))
        trajectory = motions.time(leg.path, Trace(parameters, leg.positions), leg.rates)
        motions.check_path(leg.path, trajectory)
        motions.check_rates(leg.link, trajectory, leg.rates)
        return trajectory
    samples, owners, rates = _samples(run)
    spline = JointSpline(samples)
    curve = RatedCurve(spline, run.legs[0].link, [rates[index] for index in spline.kept])
    trajectory = time_curve(curve, names, task.space, task.limits)
    near = nearest_knots(spline, trajectory)
    _check_ways(run, trajectory, [owners[spline.kept[index]] for index in near], motions)
    return trajectory


def _samples(run: LegRun) -> tuple[FloatArray, list[int], list[LinkRates | None]]:
    """Positions along a run, the leg each belongs to (-1: a transition), and its link's rates."""
    blocks: list[FloatArray] = []
    owners: list[int] = []
    rates: list[LinkRates | None] = []
    first = 0.0
    for index, leg in enumerate(run.legs):
        blend = run.transitions[index] if index < len(run.transitions) else None
        part = leg.part(first, 1.0 if blend is None else blend.leaves)
        part = part if index == 0 else part[1:]  # the transition has its start
        blocks.append(part)
        owners += [index] * len(part)
        rates += [leg.rates] * len(part)
        if blend is not None:
            inside = blend.positions[1:]
            blocks.append(inside)
            owners += [-1] * len(inside)
            rates += [_slower(leg.rates, run.legs[index + 1].rates)] * len(inside)
            first = blend.enters
    return np.concatenate(blocks), owners, rates


def _slower(first: LinkRates | None, second: LinkRates | None) -> LinkRates | None:
    if first is None or second is None:
        return first or second
    return LinkRates(
        min(first.velocity, second.velocity),
        min(first.acceleration, second.acceleration),
        min(first.turning, second.turning),
        min(first.turning_acceleration, second.turning_acceleration),
    )


def _check_ways(
    run: LegRun, trajectory: JointTrajectory, owners: Sequence[int], motions: LinkMotions
) -> None:
    """Check that every sample of a leg through space is on its path.

    Raises:
        PlanningFailed: INVALID_MOTION_PLAN.
    """
    for positions, owner in zip(trajectory.positions, owners, strict=True):
        path = run.legs[owner].path if owner >= 0 else None
        if path is None:
            continue
        pose = motions.pose(positions, path.link)
        shift, turn = off_path(path, pose, motions.task.space.task_space)
        if shift > POSITION_DEVIATION or turn > ORIENTATION_DEVIATION:
            raise PlanningFailed(
                "INVALID_MOTION_PLAN",
                f"{path.link} would leave {run.legs[owner].name} by {amount(shift, 'm')} "
                f"and {amount(turn, 'rad')}",
                DeviationFailure(shift, turn),
            )
