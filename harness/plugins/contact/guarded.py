"""Follows a trajectory until something is noticed, then stops on it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from harness.cell.cell import Cell
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray

LOOK = 0.004
"""Time between two looks [s], of 2 to 10 ms that sensors take; 1, 2 and 4 ms divide it."""
STOPS_AT_CONTACT = (  # what no real robot does here, as `simulated_only`
    "a trajectory controller is not stopped or moved within milliseconds of a contact",
    "use a `lin` that ends where the contact is, or the force mode of the robot's driver in a"
    " program of its own, and judge the recording with `harness grade`",
)
GRID = 0.001  # [s], to which the time of braking is rounded up: a step of the physics


def follow_until(
    planned: JointTrajectory, cell: Cell, notices: Callable[[], bool]
) -> tuple[JointTrajectory, float] | None:
    """Follow a trajectory, and look every 4 ms whether to stop on it.

    Args:
        planned: The trajectory, which begins where the arm is.
        cell: The cell with the arm.
        notices: Whether to stop now.

    Returns:
        The trajectory that was commanded, up to the stop, and the time of braking [s]; None where
        nothing was noticed until its end.
    """
    for look in range(max(1, int(np.ceil(planned.duration / LOOK - 1e-9)))):
        begin, end = look * LOOK, min((look + 1) * LOOK, planned.duration)
        cell.simulator.track(_part(planned, np.array([begin, end])))
        if notices():
            break
    else:
        return None
    followed = _part(planned, np.append(np.arange(0.0, end, LOOK), end))
    stop = _braking(planned, end, cell)
    if stop.duration <= 0:
        return followed, 0.0
    cell.simulator.track(stop)
    return _joined(followed, stop), stop.duration


def _braking(planned: JointTrajectory, begin: float, cell: Cell) -> JointTrajectory:
    """The rest of a trajectory from a moment on, in which its speed falls evenly to zero.

    Its duration T is the least one in which no joint decelerates beyond its limit; the arm gets
    T / 2 further on the trajectory, or to its end where that is nearer.
    """
    description, scaling = cell.description, cell.current.options.acceleration_scaling
    speeds = np.abs(_part(planned, np.array([begin])).velocities[0])
    most = np.array([description.joint_by_name[name].acceleration for name in planned.joint_names])
    time = float((speeds / (scaling * most)).max())
    time = GRID * max(1.0, np.ceil(time / GRID))
    if begin + time / 2 > planned.duration:
        rest = planned.duration - begin
        return _part(planned, begin + np.linspace(0.0, rest, 2 if rest == 0 else 20))
    after = np.linspace(0.0, time, 20)
    path = _part(planned, begin + after - after**2 / (2 * time))
    slower = (1 - after / time)[:, None]
    return replace(path, times=after, velocities=path.velocities * slower)


def _part(planned: JointTrajectory, times: FloatArray) -> JointTrajectory:
    """The points of a trajectory's cubic splines at times, the first of them at time zero."""
    return JointTrajectory(planned.joint_names, times - times[0], *planned.at(times))


def _joined(first: JointTrajectory, second: JointTrajectory) -> JointTrajectory:
    return JointTrajectory(
        first.joint_names,
        np.append(first.times, first.times[-1] + second.times[1:]),
        np.concatenate([first.positions, second.positions[1:]]),
        np.concatenate([first.velocities, second.velocities[1:]]),
        np.concatenate([first.accelerations, second.accelerations[1:]]),
    )
