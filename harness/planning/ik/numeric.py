"""Numeric inverse kinematics of any chain: damped least squares from many joint positions."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import sqrt

import eigenpy
import numpy as np
import pinocchio as pin

from harness.core.spatial import SE3, pitch_of
from harness.core.types import FloatArray
from harness.planning.ik.pose_table import pose_table
from harness.planning.model.robot_model import GroupSpace
from harness.ports.goals import PoseGoal, PositionGoal

LinkGoal = PoseGoal | PositionGoal

RESTARTS, MOST_RESTARTS = 18, 64
"""Searches from the pose table after the one from the seed, and the limit while none succeeds.
Success rates of every bundled arm are in docs/reference/inverse_kinematics.md."""

_EXACT = 1e-13  # [m, rad] error at which Newton steps stop
_CONVERGED = 1e-9  # [m, rad] error at which least squares stop
_MOST_ITERATIONS = 100  # steps of one search; most end long before, by `_CONVERGES`
_HELD = 1e12  # damping with which a joint does not move
_WINDOW = 4  # iterations over which progress is measured
_CONVERGES, _CONVERGES_FAST = 0.8, 0.5
"""Shares of the squared error that remain after a window, above which a restart is cheaper: while
no solution is known, and once there is one."""
_MINIMUM = 1 - 1e-9  # The same share at a minimum, of a goal that cannot be reached
_FOUND = 1e-8  # [m, rad] largest error of a solution
_NO_HEADING = 1e-9  # [1] horizontal part below which the x axis is vertical
UP = np.array([0.0, 0.0, 1.0])
_VERTICAL = 1e-6  # [1] cosine below which a pitch is a quarter turn


@dataclass(frozen=True, eq=False)
class TiltGoal:
    """A link's origin at a point, and its rotation up to a turn about the vertical.

    Attributes:
        position: The position in the world [m], shape (3,).
        up: The world's vertical in the link's axes, shape (3,).
    """

    link: str
    position: FloatArray
    up: FloatArray

    @classmethod
    def of(cls, link: str, pose: SE3) -> TiltGoal:
        """What an arm of five joints can choose of a pose T_world_link."""
        return cls(link, pose.translation, pose.rotation[2])


class LinkTask:
    """The error of a link relative to its goal, and the Jacobian of the error.

    Rows are metres and radians in world axes: position (3), then for a pose the rotation vector
    from the link to the goal (3), for a position with pitch the pitch (1; 2 when x is vertical),
    for a tilt the difference of the verticals (3).
    Rotation rows are multiplied by `metres_per_radian`: their weight relative to a distance where
    both cannot be satisfied.
    """

    def __init__(
        self, space: GroupSpace, goal: LinkGoal | TiltGoal, *, metres_per_radian: float = 1.0
    ) -> None:
        self.space = space
        self.goal = goal
        self._turn = metres_per_radian
        self._robot = space.robot
        self._frame = space.robot.frame_id(goal.link)
        self._goal_rotation = np.asarray(goal.pose.rotation) if isinstance(goal, PoseGoal) else None

    def link_pose(self, positions: FloatArray) -> SE3:
        """T_world_link at group positions."""
        return self._robot.link_pose(self.space.whole(positions), self.goal.link)

    def cost(self, positions: FloatArray) -> float:
        """The squared error at positions."""
        error, _ = self.evaluate(positions)
        return float(error.dot(error))

    def evaluate(self, positions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Error (m,) and Jacobian (m, dof) at positions; a step `pinv(J) @ error` closes in."""
        error, jacobian = self._evaluate(positions)
        if self._turn != 1.0:
            error[3:] *= self._turn
            jacobian[3:] *= self._turn
        return error, jacobian

    def _evaluate(self, positions: FloatArray) -> tuple[FloatArray, FloatArray]:
        model, data = self._robot.model, self._robot.data
        configuration = self.space.configuration(positions)
        whole = pin.computeFrameJacobian(
            model, data, configuration, self._frame, pin.LOCAL_WORLD_ALIGNED
        )
        placement = pin.updateFramePlacement(model, data, self._frame)
        # one joint gives a one-dimensional array
        jacobian = self.space.jacobian(whole.reshape(6, -1))
        rotation = placement.rotation
        goal = self.goal
        if isinstance(goal, PoseGoal):
            error = np.empty(6)
            error[:3] = goal.pose.translation - placement.translation
            error[3:] = pin.log3(self._goal_rotation @ rotation.T)
            return error, jacobian
        shift = goal.position - placement.translation
        if isinstance(goal, TiltGoal):
            up: FloatArray = rotation @ goal.up
            tilted = np.cross(jacobian[3:].T, up).T  # change of the link's vertical, (3, dof)
            return np.concatenate([shift, UP - up]), np.vstack([jacobian[:3], tilted])
        if goal.pitch is None:
            return shift, jacobian[:3]
        x_axis: FloatArray = rotation[:, 0]
        turned = np.cross(jacobian[3:].T, x_axis).T  # change of the x axis, (3, dof)
        if abs(np.cos(goal.pitch)) < _VERTICAL:
            return np.concatenate([shift, -x_axis[:2]]), np.vstack([jacobian[:3], turned[:2]])
        horizontal = float(np.hypot(x_axis[0], x_axis[1]))
        ahead = x_axis[:2] / horizontal if horizontal > _NO_HEADING else np.array([1.0, 0.0])
        slope = x_axis[2] * (ahead @ turned[:2]) - horizontal * turned[2]
        pitch = float(np.arcsin(np.clip(np.sin(goal.pitch), -1.0, 1.0)))
        return np.append(shift, pitch - pitch_of(rotation)), np.vstack([jacobian[:3], slope])

    def polish(self, positions: FloatArray, iterations: int = 8) -> tuple[FloatArray, float]:
        """Refine a near solution by Newton steps; returns positions and the remaining error."""
        positions = np.array(positions, dtype=float)
        error, jacobian = self.evaluate(positions)
        squared = float(error.dot(error))
        for _ in range(iterations):
            if squared < _EXACT**2:
                break
            step = np.linalg.lstsq(jacobian, error, rcond=1e-8)[0]
            candidate = positions + step
            new_error, new_jacobian = self.evaluate(candidate)
            new_squared = float(new_error.dot(new_error))
            if new_squared >= squared:
                break
            positions, error, jacobian, squared = candidate, new_error, new_jacobian, new_squared
        return positions, sqrt(squared)

    def least_squares(
        self, seed: FloatArray, *, remaining: float = _MINIMUM
    ) -> tuple[FloatArray, float]:
        """Damped least squares inside the position limits, from one seed.

        Levenberg-Marquardt with the damping proportional to the squared error [1]; joints
        at a limit that would exceed it are excluded from a step.

        Args:
            remaining: The share of the squared error above which the search ends, if it remains
                after `_WINDOW` iterations.

        Returns:
            Joint positions and the norm of the error there.

        References:
            [1] T. Sugihara, "Solvability-Unconcerned Inverse Kinematics by the
                Levenberg-Marquardt Method", IEEE T-RO 27(5), 2011.
        """
        lower, upper = self.space.lower, self.space.upper
        positions = np.minimum(np.maximum(seed, lower), upper)
        error, jacobian = self.evaluate(positions)
        cost, factor = float(error.dot(error)), 1.0
        earlier = [np.inf] * _WINDOW
        for _ in range(_MOST_ITERATIONS):
            if cost < _CONVERGED**2 or cost > remaining * earlier[0]:
                break
            earlier = [*earlier[1:], cost]
            damping = factor * 0.5 * cost + 1e-12
            candidate = _damped_step(positions, error, jacobian, damping, lower, upper)
            new_error, new_jacobian = self.evaluate(candidate)
            new_cost = float(new_error.dot(new_error))
            if new_cost < cost:
                positions, error, jacobian, cost = candidate, new_error, new_jacobian, new_cost
                factor = max(factor * 0.3, 1e-3)
            else:
                factor *= 10.0
                if factor > 1e8:
                    break
        return positions, sqrt(cost)


def _damped_step(
    positions: FloatArray,
    error: FloatArray,
    jacobian: FloatArray,
    damping: float,
    lower: FloatArray,
    upper: FloatArray,
) -> FloatArray:
    """The positions after a step of damped least squares; joints that exceed a limit stop there."""
    transposed = jacobian.T
    gradient, normal = transposed.dot(error), transposed.dot(jacobian)
    diagonal = normal.ravel()[:: len(gradient) + 1]
    diagonal += damping
    target = positions + _solved(normal, gradient)
    inside: FloatArray = np.minimum(np.maximum(target, lower), upper)
    beyond = inside != target
    if not np.count_nonzero(beyond):
        return inside
    diagonal[beyond] = _HELD
    target = positions + _solved(normal, gradient)
    return np.where(beyond, inside, np.minimum(np.maximum(target, lower), upper))


def _solved(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """The solution of a symmetric system; not finite where the matrix is not positive."""
    return eigenpy.LLT(matrix).solve(right).reshape(-1)  # one joint gives a two-dimensional array


def solve_numeric(
    space: GroupSpace,
    goal: LinkGoal,
    seed_positions: FloatArray,
    *,
    most_restarts: int = MOST_RESTARTS,
    enough: int | None = None,
    part: TiltGoal | None = None,
) -> list[FloatArray]:
    """Find joint positions that bring a link to its goal: from the seed, then from near the goal.

    Args:
        most_restarts: The largest number of searches after the first, if none finds a solution.
        enough: The number of solutions that ends the search; None for a spread.
        part: The part of the goal that suffices, where the rest comes as near as it can.

    Returns:
        Distinct solutions in order of finding, exact to 1e-9, inside the limits; may be empty.
    """
    task = LinkTask(space, goal)
    found: list[FloatArray] = []
    for number, start in enumerate(starts(space, goal, seed_positions, most_restarts)):
        remaining = _CONVERGES_FAST if found else _CONVERGES
        positions, error = task.least_squares(start, remaining=remaining)
        if part is not None:
            positions, error = LinkTask(space, part).polish(positions)
        if error < _FOUND and all(space.distance(positions, other) > 1e-4 for other in found):
            found.append(positions)
        if len(found) == enough or (found and number >= RESTARTS):
            break
    return found


def starts(
    space: GroupSpace, goal: LinkGoal, seed_positions: FloatArray, restarts: int
) -> Iterator[FloatArray]:
    """Where searches start: at the seed, and at the table's positions nearest to the goal.

    The seed comes first, or second if the first of the others is nearer to the goal.
    """
    task, seed = LinkTask(space, goal), np.asarray(seed_positions, dtype=float)
    near = list(pose_table(space, goal.link).nearest(goal, restarts))
    if near and task.cost(near[0]) < task.cost(seed):
        yield near.pop(0)
    yield seed
    yield from near
