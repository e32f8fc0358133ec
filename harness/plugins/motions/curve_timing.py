"""Times a smooth joint-space curve under the limits of the joints and of a link."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray, IntArray
from harness.planning.cartesian.link_timing import CENTRIPETAL_SHARE, LinkRates
from harness.planning.model.robot_model import GroupSpace
from harness.planning.timing.limits import Limits, joint_motion, sampled_within_limits
from harness.planning.timing.profiles import resting
from harness.planning.timing.toppra_passes import Bounds
from harness.planning.timing.toppra_solver import fastest
from harness.plugins.motions.joint_spline import JointSpline

_TINY = 1e-9  # [rad, m per rad] stands for zero, so that nothing is divided by it


@dataclass(frozen=True, eq=False)
class RatedCurve:
    """A curve and the Cartesian limits of the link at each of its knots.

    Attributes:
        spline: The curve in joint space.
        link: The link whose motion is limited.
        rates: The link's limits at every knot; None where only the joints are limited.
    """

    spline: JointSpline
    link: str
    rates: Sequence[LinkRates | None]


def time_curve(
    curve: RatedCurve, joint_names: tuple[str, ...], space: GroupSpace, limits: Limits
) -> JointTrajectory:
    """Compute the fastest motion along a curve from rest to rest.

    Raises:
        TimingError: The limits cannot be satisfied.
    """
    spline = curve.spline
    if spline.length < _TINY:
        return resting(joint_names, spline.samples[0])
    grid = spline.grid()
    knots = np.minimum(np.searchsorted(spline.knots, grid, side="right") - 1, len(spline.knots) - 1)
    timed, total = fastest(spline.cubics, limits, grid, _link_bounds(curve, space, grid, knots))
    motion = joint_motion(timed, total)
    trajectory = sampled_within_limits(
        joint_names, motion, total, limits, lambda points: link_excess(curve, space, points)
    )
    trajectory.positions[[0, -1]] = spline.samples[[0, -1]]
    return trajectory


def nearest_knots(spline: JointSpline, trajectory: JointTrajectory) -> IntArray:
    """The nearest knot of a curve for each sample of a motion along it, in ascending order."""
    nearest: list[int] = []
    low, before = 0, trajectory.positions[0]
    for positions in trajectory.positions:
        reach = spline.knots[low] + 2 * float(np.linalg.norm(positions - before))
        ahead = spline.samples[low : int(np.searchsorted(spline.knots, reach)) + 2]
        low += int(np.argmin(((ahead - positions) ** 2).sum(axis=1)))
        nearest.append(low)
        before = positions
    return np.array(nearest, dtype=np.int64)


def link_excess(curve: RatedCurve, space: GroupSpace, trajectory: JointTrajectory) -> float:
    """Factor by which the link exceeds its limits between samples; at most 1 within the limits."""
    if all(rates is None for rates in curve.rates):
        return 0.0
    near = nearest_knots(curve.spline, trajectory)
    poses = [
        space.robot.link_pose(space.whole(positions), curve.link)
        for positions in trajectory.positions
    ]
    steps = np.diff(trajectory.times)
    places = np.array([pose.translation for pose in poses])
    velocities = np.diff(places, axis=0) / steps[:, None]
    worst = 0.0
    for row, step in enumerate(steps):
        rates = [curve.rates[near[row]], curve.rates[near[row + 1]]]
        if any(rate is None for rate in rates):
            continue
        some = [rate for rate in rates if rate is not None]
        speed = max(rate.velocity for rate in some)
        worst = max(worst, float(np.linalg.norm(velocities[row])) / speed)
        if space.task_space.holds_pose:
            turning = poses[row].distance_to(poses[row + 1])[1] / step
            worst = max(worst, turning / max(rate.turning for rate in some))
        if row and curve.rates[near[row - 1]] is not None:
            push = max(rate.acceleration for rate in some)
            change = (velocities[row] - velocities[row - 1]) / (0.5 * (step + steps[row - 1]))
            worst = max(worst, float(np.sqrt(np.linalg.norm(change) / push)) / 1.002)
    return worst


def _link_bounds(
    curve: RatedCurve, space: GroupSpace, grid: FloatArray, knots: IntArray
) -> Bounds | None:
    if all(rates is None for rates in curve.rates):
        return None
    positions, first, _ = curve.spline.evaluate(grid)
    rates = np.array(
        [_link_rates(space, curve.link, *row) for row in zip(positions, first, strict=True)]
    )
    shifts, turns = rates[:, :3], rates[:, 3:]
    bends = np.gradient(shifts, grid, axis=0)
    speed = np.maximum(np.linalg.norm(shifts, axis=1), _TINY)
    along = (bends * shifts).sum(axis=1) / speed
    across = np.linalg.norm(bends - (along / speed)[:, None] * shifts, axis=1)
    turning = np.linalg.norm(turns, axis=1) * space.task_space.holds_pose
    turning_bend = np.gradient(turning, grid)
    allowed = np.array(
        [
            (np.inf,) * 4
            if (some := curve.rates[knot]) is None
            else (some.velocity, some.acceleration, some.turning, some.turning_acceleration)
            for knot in knots
        ]
    )
    velocity, acceleration, most_turning, turn_acceleration = allowed.T
    squared = np.minimum((velocity / speed) ** 2, (most_turning / np.maximum(turning, _TINY)) ** 2)
    squared = np.minimum(squared, CENTRIPETAL_SHARE * acceleration / np.maximum(across, _TINY))
    free = np.isinf(acceleration)
    pull = np.where(free, 0.0, across * np.where(free, 0.0, squared))
    forward = np.sqrt(np.where(free, np.inf, acceleration**2 - pull**2))
    speeds = np.column_stack([speed / forward, turning / turn_acceleration])
    bends = np.column_stack([along / forward, turning_bend / turn_acceleration])
    none, most = np.zeros_like(speeds), np.ones(2)
    return Bounds(speeds, bends, none, most, np.minimum(squared, 1e8), between=False)


def _link_rates(
    space: GroupSpace, link: str, positions: FloatArray, rates: FloatArray
) -> FloatArray:
    """The link's twist in world axes for rates of the group's joints, shape (6,)."""
    robot = space.robot
    model, data = robot.model, robot.data
    pin.computeJointJacobians(model, data, robot.configuration(space.whole(positions)))
    frame = robot.frame_id(link)
    pin.updateFramePlacement(model, data, frame)
    jacobian = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
    jacobian = jacobian.reshape(6, -1)  # one joint gives a one-dimensional array
    return jacobian[:, robot.velocity_columns] @ (space.matrix @ rates)
