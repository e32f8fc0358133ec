"""Motions of several arms that go on at once."""

from __future__ import annotations

from harness.cell.cell import Cell
from harness.core.errors import PlanningFailed
from harness.core.trajectory import JointTrajectory, together
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
