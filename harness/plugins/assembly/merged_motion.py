"""Motions of several arms that go on at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.cell.cell import Cell
from harness.core.errors import PlanningFailed
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.ports.motion_planning import MotionRequest
from harness.ports.motions import TimedMotion
from harness.robot.description import ALL_ARMS

DELAYS = 10  # of a motion of another arm, tried one after the other: tenths of what runs already
SET_POINTS = 0.01  # [s], between set points, of which delays are multiples


class MergedMotion:
    """Motions of different arms as one.

    Each was planned around the arms before it at their ends. It begins as soon as the timed
    motion of all of them is free, in tenths of the motion before, at the latest when that has
    ended.

    Attributes:
        delays: When each motion begins [s].
    """

    def __init__(self, cell: Cell) -> None:
        """Merge motions that start where the robot is now."""
        self._cell, self._start = cell, cell.planning_start()
        self._motions: list[tuple[JointTrajectory, float]] = []
        self._whole: JointTrajectory | None = None

    @property
    def delays(self) -> tuple[float, ...]:
        return tuple(delay for _, delay in self._motions)

    def add(self, motion: JointTrajectory) -> None:
        """Let a motion begin as early as possible.

        Raises:
            PlanningFailed: INVALID_MOTION_PLAN, not even after the end of the others.
        """
        if self._whole is None:
            self._whole, self._motions = motion, [(motion, 0.0)]
            return
        names, longest = self._cell.robot.group_joints(ALL_ARMS), self._whole.duration
        rest = self._start[list(self._cell.robot.group_indices(ALL_ARMS))]
        options = self._cell.current.options
        for number in range(DELAYS + 1):
            delay = round(number * longest / DELAYS / SET_POINTS) * SET_POINTS
            delay = longest if number == DELAYS else delay
            motions = [*self._motions, (motion, delay)]
            whole = together(motions, names, rest)
            try:
                request = MotionRequest(ALL_ARMS, self._start, TimedMotion(whole), options)
                self._cell.planner.plan(request)
            except PlanningFailed:
                if number == DELAYS:
                    raise
            else:
                self._whole, self._motions = whole, motions
                return

    def follow(self) -> None:
        """Follow the whole motion, which the step notes.

        Raises:
            StepFailed: CONTROL_FAILED; an arm cannot follow it.
        """
        assert self._whole is not None
        self._cell.notes.trajectory = self._whole
        self._cell.simulator.track(self._whole)


def together(
    motions: Sequence[tuple[JointTrajectory, float]], names: tuple[str, ...], rest: FloatArray
) -> JointTrajectory:
    """Motions of different joints as one.

    Args:
        motions: Each motion, and the time at which it begins [s].
        names: The joints of the whole.
        rest: Positions of the joints that no motion moves, shape (dof,).
    """
    stamps = [np.round(motion.times + delay, 9) for motion, delay in motions]
    times = np.unique(np.concatenate([[0.0], *stamps]))
    positions = np.tile(rest, (len(times), 1))
    velocities, accelerations = np.zeros_like(positions), np.zeros_like(positions)
    for motion, delay in motions:
        columns = [names.index(name) for name in motion.joint_names]
        rows = motion.at(times - delay)
        moves = ((times > delay) & (times < delay + motion.duration))[:, None]
        positions[:, columns] = rows[0]
        velocities[:, columns] = np.where(moves, rows[1], 0.0)
        accelerations[:, columns] = np.where(moves, rows[2], 0.0)
    return JointTrajectory(names, times, positions, velocities, accelerations)
