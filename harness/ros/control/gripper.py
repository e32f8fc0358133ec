"""A gripper action controller: one joint to a position under an effort limit, until it stalls."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.types import FloatArray
from harness.robot.description import Gripper, Joint, RobotDescription
from harness.ros.control.goals import LIMIT_SLACK, Code, GoalRefused
from harness.ros.control.spline import Rows
from harness.simulation.gripper_drive import GOAL_TOLERANCE, STALL_SPEED, STALL_TIME, joint_speed
from harness.simulation.set_points import SetPoints, ramp


@dataclass(frozen=True)
class Gripped:
    """How a GripperCommand ended, in the fields of its result."""

    goal: str
    position: float
    effort: float
    stalled: bool
    reached_goal: bool


@dataclass(eq=False)
class _Active:
    goal: str
    target: float
    points: SetPoints
    begin: float


class GripperController:
    """Moves the gripper's joint as the step `gripper` does, independent of the arm."""

    def __init__(self, name: str, description: RobotDescription, timestep: float) -> None:
        gripper = description.gripper
        assert gripper is not None
        self.name = name
        self.gripper: Gripper = gripper
        self.joint: Joint = description.joint_by_name[gripper.joint]
        self.joint_names = (gripper.joint,)
        self._timestep = timestep
        self._speed = joint_speed(description, gripper)
        self._range = abs(gripper.closed_position - gripper.open_position)
        self._active: _Active | None = None
        self._recent: list[float] = []

    @property
    def is_active(self) -> bool:
        """Whether it is on its way."""
        return self._active is not None

    @property
    def goal(self) -> str:
        """The identifier of the goal that it follows."""
        return self._active.goal if self._active else ""

    def begin(
        self, goal: str, content: Mapping[str, Any], now: float, commanded: float, measured: float
    ) -> float:
        """Move to a position from now on; the effort limit that applies.

        Args:
            goal: The identifier of the goal.
            content: `position` and `max_effort`, 0 for the gripper's own.
            now: The present simulated time [s].
            commanded: The last set point of the joint.
            measured: The measured position of the joint.

        Raises:
            GoalRefused: The position cannot be reached, or is no number.
        """
        target, effort = float(content["position"]), float(content["max_effort"])
        if not np.isfinite([target, effort]).all() or effort < 0:
            raise GoalRefused(Code.INVALID_GOAL, "position and max_effort must be finite numbers")
        joint = self.joint
        if not joint.lower - LIMIT_SLACK <= target <= joint.upper + LIMIT_SLACK:
            raise GoalRefused(
                Code.INVALID_GOAL,
                f"'{joint.name}' goes from {joint.lower:g} to {joint.upper:g}, not to {target:g}",
            )
        turns_back = (target - measured) * (commanded - measured) < 0
        start = measured if turns_back else commanded
        points = ramp(start, target, self._speed, joint.acceleration, self._timestep)
        self._active, self._recent = _Active(goal, target, points, now), []
        return min(effort, self.gripper.max_effort) if effort else self.gripper.grip_effort

    def stop(self) -> str:
        """Follow nothing any more; the identifier of the goal that was followed."""
        goal, self._active = self.goal, None
        return goal

    def set_points(self, times: FloatArray) -> Rows | None:
        """Set points at some times; None where it follows nothing."""
        if self._active is None:
            return None
        points = self._active.points
        rows = np.rint((times - self._active.begin) / self._timestep).astype(int)
        rows = np.clip(rows, 0, len(points) - 1)
        return points.positions[rows], points.velocities[rows], points.accelerations[rows]

    def judge(self, now: float, positions: FloatArray, effort: float) -> Gripped | None:
        """How it ended; None while it goes on.

        Args:
            now: The present simulated time [s].
            positions: Measured positions since the last call, shape (N,).
            effort: The effort of the joint.
        """
        active = self._active
        if active is None:
            return None
        count = round(STALL_TIME / self._timestep)
        self._recent = [*self._recent, *positions.tolist()][-count:]
        is_over = now >= active.begin + (len(active.points) - 1) * self._timestep - 1e-9
        miss = abs(self._recent[-1] - active.target)
        reached = is_over and miss <= GOAL_TOLERANCE * self._range
        travel = float(np.ptp(self._recent))
        is_still = len(self._recent) == count and travel < STALL_SPEED * self._speed * STALL_TIME
        if not (reached or is_still):
            return None
        reached = miss <= GOAL_TOLERANCE * self._range
        return Gripped(self.stop(), self._recent[-1], effort, not reached, reached)

    @property
    def target(self) -> float | None:
        """Where the joint is commanded to; None where it follows nothing."""
        return self._active.target if self._active else None
