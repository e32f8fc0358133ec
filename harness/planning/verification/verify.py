"""Verifies every trajectory as it will be commanded, at a finer resolution than planning."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from harness.core.amounts import amounts
from harness.core.details import Details
from harness.core.trajectory import JointTrajectory
from harness.core.types import BoolArray, FloatArray
from harness.planning.collision import wording
from harness.planning.collision.checker import MotionChecker, touch_records
from harness.planning.timing.limits import Limits
from harness.planning.verification.path_constraints import HeldConstraints
from harness.recording.goal_failures import CollisionFailure
from harness.recording.motion_failures import BrokenRule, PathCollision, TrajectoryFailure

FINAL_RESOLUTION = 1 / 128
"""Joint-space distance between states checked on the path that is found and shortened [rad]."""

VERIFIED_RESOLUTION = 1 / 65536
"""Between states checked on the trajectory that is commanded; most are certified by their
neighbours. At 1/384 rad, 8 of 1,680 paths came up to 0.1 mm nearer than their padding in between;
at 1/1024 rad, 14 of 1,680 on meshes without padding were up to 0.04 mm deep [rad]."""

END_TOLERANCE = 1e-6  # How far a trajectory may start or end from where it should [rad or m]
LIMIT_TOLERANCE = 1e-3  # Share by which a sampled velocity or acceleration may exceed its limit
EFFORT_TOLERANCE = 1e-2
"""Share by which an effort may exceed its limit between the samples that were timed."""

_POSITION_SLACK = 1e-9  # [rad or m] rounding at a limit


@dataclass(frozen=True)
class Defect:
    """What is wrong with a trajectory."""

    message: str
    details: Details


def find_defect(
    trajectory: JointTrajectory,
    checker: MotionChecker,
    start: FloatArray,
    end: FloatArray,
    limits: Limits,
    held: HeldConstraints | None = None,
) -> Defect | None:
    """The first thing that forbids a trajectory to be executed, or None.

    Stamps must rise, the ends be where they should and at rest, positions be inside the joint
    limits, velocities and accelerations inside the scaled ones, jerks and efforts inside theirs;
    path constraints must hold on every sample and midway between, and every state on the way be
    free.
    """
    return (
        _stamps(trajectory)
        or _ends(trajectory, start, end, checker.space.wraps)
        or _limits(trajectory, checker, limits)
        or _jerks(trajectory, limits)
        or _efforts(trajectory, limits)
        or _constraints(trajectory, held)
        or _collision(trajectory, checker)
    )


def find_departure(
    trajectory: JointTrajectory, away: FloatArray, deviation: float
) -> Defect | None:
    """Where a trajectory leaves its path farther than it may, or None.

    Args:
        trajectory: The trajectory with its times.
        away: How far its set points are from the path that was checked [rad], shape (N,).
        deviation: The largest of these distances that is allowed [rad].
    """
    row = int(np.argmax(away))
    if away[row] <= deviation + END_TOLERANCE:
        return None
    time = float(trajectory.times[row])
    off, allowed = amounts(float(away[row]), deviation, "rad")
    return Defect(
        f"at {time:.3f} s it would be {off} of joint space off the path that was checked, "
        f"{allowed} are allowed",
        Details.of(TrajectoryFailure("path", time=time, path_deviation=float(away[row]))),
    )


def path_collision(
    waypoints: FloatArray, checker: MotionChecker, resolution: float = FINAL_RESOLUTION
) -> Defect | None:
    """Where a path without times is blocked first, or None."""
    blocked = checker.first_block(waypoints, resolution)
    if blocked is None:
        return None
    row, state, touches = blocked
    index = max(0, int(np.ceil(row)) - 1)
    edge = f" between waypoints {index + 1} and {index + 2}" if len(waypoints) > 2 else ""
    return Defect(
        f"after {100 * (row - index):.0f} % of the path{edge} it would come too near: "
        f"{wording.touches(touches)}",
        Details.of(
            TrajectoryFailure("collision"),
            PathCollision(touch_records(touches), tuple(map(float, state))),
        ),
    )


def distances_to_path(positions: FloatArray, waypoints: FloatArray) -> FloatArray:
    """Joint-space distances of rows (N, dof) from the polyline through waypoints, shape (N,)."""
    nearest = np.full(len(positions), np.inf)
    for first, second in pairwise(waypoints):
        way = second - first
        shares = (positions - first) @ way / max(float(way @ way), 1e-18)
        away = positions - (first + np.clip(shares, 0.0, 1.0)[:, None] * way)
        nearest = np.minimum(nearest, (away * away).sum(axis=1))
    return np.sqrt(nearest)


def _stamps(trajectory: JointTrajectory) -> Defect | None:
    if trajectory.times[0] == 0.0 and bool(np.all(np.diff(trajectory.times) > 0)):
        return None
    return Defect("the time stamps do not rise from zero", Details.of(TrajectoryFailure("stamps")))


def _ends(
    trajectory: JointTrajectory, start: FloatArray, end: FloatArray, wraps: BoolArray
) -> Defect | None:
    ends: tuple[tuple[BrokenRule, BrokenRule, int, FloatArray], ...] = (
        ("start", "rest at start", 0, start),
        ("end", "rest at end", -1, end),
    )
    for place, rest, row, expected in ends:
        away = np.abs(trajectory.positions[row] - expected)
        joint = int(np.argmax(away))
        off = float(away[joint])
        if not off <= END_TOLERANCE:
            shown, tolerance = amounts(off, END_TOLERANCE, "rad" if wraps[joint] else "m")
            return Defect(
                f"the trajectory's {place} is {shown} of {trajectory.joint_names[joint]} away from"
                f" where it should be, at most {tolerance}",
                Details.of(TrajectoryFailure(place, distance=off)),
            )
        speed = float(np.max(np.abs(trajectory.velocities[row])))
        if not speed <= 1e-9:
            return Defect(
                f"the trajectory is not at rest at its {place}",
                Details.of(TrajectoryFailure(rest, speed=speed)),
            )
    return None


def _limits(trajectory: JointTrajectory, checker: MotionChecker, limits: Limits) -> Defect | None:
    space = checker.space
    outside = np.maximum(space.lower - trajectory.positions, trajectory.positions - space.upper)
    share = 1 + LIMIT_TOLERANCE
    rules: tuple[tuple[BrokenRule, FloatArray], ...] = (
        ("position limit", outside - _POSITION_SLACK),
        ("velocity limit", np.abs(trajectory.velocities) - limits.velocity * share),
        ("acceleration limit", np.abs(trajectory.accelerations) - limits.acceleration * share),
    )
    for what, excess in rules:
        row, joint = np.unravel_index(int(np.argmax(excess)), excess.shape)
        if not excess[row, joint] <= 0:
            name, time = space.joint_names[joint], float(trajectory.times[row])
            beyond = float(excess[row, joint])
            return Defect(
                f"{name} is beyond its {what} by {beyond:.3g} at {time:.3f} s",
                Details.of(TrajectoryFailure(what, name, excess=beyond, time=time)),
            )
    return None


def _jerks(trajectory: JointTrajectory, limits: Limits) -> Defect | None:
    if not np.isfinite(limits.jerk):
        return None
    changes = np.abs(np.diff(trajectory.accelerations, axis=0))
    jerks = changes / np.diff(trajectory.times)[:, None]
    row, joint = np.unravel_index(int(np.argmax(jerks)), jerks.shape)
    if jerks[row, joint] <= limits.jerk * (1 + LIMIT_TOLERANCE):
        return None
    name, time = trajectory.joint_names[joint], float(trajectory.times[row])
    return Defect(
        f"{name} has a jerk of {jerks[row, joint]:.3g}, of at most {limits.jerk:.3g}, "
        f"at {time:.3f} s",
        Details.of(TrajectoryFailure("jerk limit", name, time=time)),
    )


def _efforts(trajectory: JointTrajectory, limits: Limits) -> Defect | None:
    dynamics, share = limits.dynamics, 1 + EFFORT_TOLERANCE
    states = trajectory.positions, trajectory.velocities, trajectory.accelerations
    if dynamics is None or dynamics.are_clearly_within(share, *states):
        return None
    efforts = dynamics.efforts(*states)
    excess = np.abs(efforts) - dynamics.limits * share
    row, joint = np.unravel_index(int(np.argmax(excess)), excess.shape)
    if excess[row, joint] <= 0:
        return None
    name, time = dynamics.joint_names[joint], float(trajectory.times[row])
    still = np.zeros((1, efforts.shape[1]))
    standing = dynamics.efforts(trajectory.positions[row][None], still, still)[0]
    if np.any(np.abs(standing) > dynamics.limits):
        return Defect(*dynamics.standing_overload(trajectory.positions))
    return Defect(
        f"{name} would need {abs(efforts[row, joint]):.1f} of at most "
        f"{dynamics.limits[joint]:.1f} N m (or N) at {time:.3f} s",
        Details.of(TrajectoryFailure("effort limit", name, time=time)),
    )


def _constraints(trajectory: JointTrajectory, held: HeldConstraints | None) -> Defect | None:
    if held is None:
        return None
    positions, times = trajectory.positions, trajectory.times
    states = np.vstack([positions, 0.5 * (positions[1:] + positions[:-1])])
    found = held.first_violation(states)
    if found is None:
        return None
    row, broken = found
    time = np.append(times, 0.5 * (times[1:] + times[:-1]))[row]
    return Defect(
        f"at {time:.2f} s {broken.what}",
        Details.of(TrajectoryFailure("path constraints"), broken.record),
    )


def _collision(trajectory: JointTrajectory, checker: MotionChecker) -> Defect | None:
    positions = trajectory.positions
    if checker.path_free(positions, VERIFIED_RESOLUTION):
        return None
    blocked = checker.first_block(positions, FINAL_RESOLUTION)  # there they are clearly too near
    blocked = blocked or checker.first_block(positions, VERIFIED_RESOLUTION)
    assert blocked is not None
    row, _, touches = blocked
    time = float(np.interp(row, np.arange(len(positions)), trajectory.times))
    return Defect(
        f"at {time:.2f} s it would come too near: {wording.touches(touches)}",
        Details.of(
            TrajectoryFailure("collision", time=time), CollisionFailure(touch_records(touches))
        ),
    )
