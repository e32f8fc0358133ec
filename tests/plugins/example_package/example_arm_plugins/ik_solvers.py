"""Two inverse kinematics solvers: one that works, and one that is wrong on purpose."""

import numpy as np

from harness.ports import IkRequest, IkResult, IkSolver, PoseGoal

RESTARTS, ITERATIONS = 40, 60


class Newton(IkSolver):
    """Damped Newton steps to a pose, with restarts and a Jacobian of finite differences."""

    name = "newton"
    offset = 0.0

    @classmethod
    def fits(cls, request: IkRequest) -> bool:
        """Poses only."""
        return isinstance(request.goal, PoseGoal)

    def solve(self, request: IkRequest) -> IkResult:
        """One solution, from the seed if there is one near it."""
        rng, positions = request.rng, np.array(request.seed_positions)
        for _ in range(RESTARTS):
            for _ in range(ITERATIONS):
                error = _error(request, positions)
                if np.linalg.norm(error) < 1e-8:
                    return IkResult((positions + self.offset,))
                columns = [
                    (_error(request, positions + 1e-6 * axis) - error) / 1e-6
                    for axis in np.eye(len(positions))
                ]
                J = -np.column_stack(columns)
                damped = J @ J.T + 1e-6 * np.eye(6)
                positions = positions + J.T @ np.linalg.solve(damped, error)
            positions = rng.uniform(-np.pi, np.pi, len(positions))
        return IkResult(())


def _error(request: IkRequest, positions: np.ndarray) -> np.ndarray:
    """Position error [m] and rotation vector to the goal [rad], shape (6,)."""
    target, pose = request.goal.pose, request.link_pose(positions)
    R = target.rotation @ pose.rotation.T
    axis = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    sine = np.linalg.norm(axis)
    angle = np.arctan2(sine, 0.5 * (np.trace(R) - 1.0))
    turn = axis * (angle / sine) if sine > 1e-12 else axis + (angle > 1.0)
    return np.concatenate([target.translation - pose.translation, turn])


class OffByABit(Newton):
    """Newton steps whose answers are off by 0.01 rad in every joint: wrong on purpose."""

    name = "off_by_a_bit"
    offset = 0.01
