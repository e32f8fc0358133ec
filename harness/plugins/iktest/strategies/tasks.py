"""Tasks of an arm: to reach a pose, a position with a pitch, or a position."""

from __future__ import annotations

from typing import Literal

import numpy as np

from harness.core.spatial import SE3, pitch_of
from harness.core.types import FloatArray
from harness.plugins.iktest.chain import Chain

Task = Literal["pose", "position and pitch", "position"]

ROWS: dict[Task, int] = {"pose": 6, "position and pitch": 4, "position": 3}
"""Number of coordinates that a task fixes: the number of joints that it needs."""

_LEAST_HORIZONTAL = 0.05  # the pitch of an x axis that is nearly vertical changes no faster


def natural_task(chain: Chain) -> Task:
    """The task of most coordinates that the chain has enough joints for."""
    fitting: list[Task] = [task for task, rows in ROWS.items() if rows <= chain.dof]
    return fitting[0] if fitting else "position"


def miss(task: Task, target: SE3, reached: SE3) -> tuple[float, float]:
    """Position error [m] and pitch or orientation error [rad] of a pose, by the task."""
    shift, turn = target.distance_to(reached)
    if task == "pose":
        return shift, turn
    pitch = abs(pitch_of(target.rotation) - pitch_of(reached.rotation))
    return shift, pitch if "pitch" in task else 0.0


def task_jacobians(chain: Chain, task: Task, samples: FloatArray) -> FloatArray:
    """Jacobians of a task's coordinates, with positions in shares of the arm's reach.

    Args:
        samples: Joint positions, shape (N, dof).

    Returns:
        The Jacobians, shape (N, rows, dof).
    """
    jacobians, rotations = chain.jacobians(samples)
    jacobians[:, :3] /= max(chain.farthest()[1], 1e-6)
    if task == "pose":
        return jacobians
    if task == "position":
        return jacobians[:, :3]
    x_axes = rotations[:, :, 0]
    horizontal = np.maximum(np.hypot(x_axes[:, 0], x_axes[:, 1]), _LEAST_HORIZONTAL)
    about = np.stack([-x_axes[:, 1], x_axes[:, 0], np.zeros(len(x_axes))], axis=1)
    pitch = np.einsum("ni,nij->nj", about / horizontal[:, None], jacobians[:, 3:])
    return np.concatenate([jacobians[:, :3], pitch[:, None]], axis=1)


def task_error(task: Task, target: SE3, here: SE3, reach: float) -> FloatArray:
    """Error to a target in the rows of `task_jacobians`; `reach` in m.

    The rotation error is of first order.
    """
    shift = (target.translation - here.translation) / reach
    if task == "position":
        return shift
    if task == "position and pitch":
        return np.append(shift, pitch_of(target.rotation) - pitch_of(here.rotation))
    crossed = np.cross(here.rotation, target.rotation, axis=0)  # column by column
    return np.concatenate([shift, 0.5 * crossed.sum(axis=1)])


def manipulability(chain: Chain, task: Task, samples: FloatArray) -> FloatArray:
    """Smallest singular value of the task's Jacobian at (N, dof) positions; 0 is singular."""
    values = np.linalg.svd(task_jacobians(chain, task, samples), compute_uv=False)
    return np.asarray(values[:, -1], dtype=float)
