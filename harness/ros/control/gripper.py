"""A gripper action controller: one joint to a position under an effort limit, until it stalls."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.types import FloatArray
from harness.robot.description import RobotDescription
from harness.ros.control.controller import Controller, Outcome, Window
from harness.ros.control.goals import LIMIT_SLACK, Code, GoalRefused
from harness.ros.control.spline import Rows
from harness.simulation.gripper_drive import GOAL_TOLERANCE, STALL_SPEED, STALL_TIME, joint_speed
from harness.simulation.set_points import SetPoints, ramp


@dataclass(frozen=True, eq=False)
class Gripped(Outcome):
    """How a GripperCommand ended, in the fields of its result."""

    position: float = 0.0
    effort: float = 0.0
    stalled: bool = False
    reached_goal: bool = False


@dataclass(eq=False)
class _Active:
    goal: str
    target: float
    points: SetPoints
    begin: float


class GripperController(Controller[_Active]):
    """Moves the gripper's joint as the step `gripper` does, independent of the arm.

    Attributes:
        effort: The effort limit of the last goal [N or N m].
    """

    def __init__(self, name: str, description: RobotDescription, timestep: float) -> None:
        gripper = description.gripper
        assert gripper is not None
        super().__init__(name, [description.joint_by_name[gripper.joint]])
        self.gripper, self.effort = gripper, gripper.grip_effort
        self._timestep = timestep
        self._speed = joint_speed(description, gripper)
        self._range = abs(gripper.closed_position - gripper.open_position)
        self._recent: list[float] = []

    def begin(
        self, goal: str, content: Mapping[str, Any], now: float, start: Rows, measured: FloatArray
    ) -> None:
        """Move to `position` under `max_effort`, 0 for the gripper's own."""
        target, effort = float(content["position"]), float(content["max_effort"])
        if not np.isfinite([target, effort]).all() or effort < 0:
            raise GoalRefused(Code.INVALID_GOAL, "position and max_effort must be finite numbers")
        [joint], commanded = self.joints, float(start[0, -1, 0])
        if not joint.lower - LIMIT_SLACK <= target <= joint.upper + LIMIT_SLACK:
            raise GoalRefused(
                Code.INVALID_GOAL,
                f"'{joint.name}' goes from {joint.lower:g} to {joint.upper:g}, not to {target:g}",
            )
        here = float(measured[0])
        turns_back = (target - here) * (commanded - here) < 0
        first = here if turns_back else commanded
        points = ramp(first, target, self._speed, joint.acceleration, self._timestep)
        self._active, self._recent = _Active(goal, target, points, now), []
        own = self.gripper
        self.effort = min(effort, own.max_effort) if effort else own.grip_effort

    def set_points(self, times: FloatArray) -> Rows | None:
        if self._active is None:
            return None
        points = self._active.points
        rows = np.rint((times - self._active.begin) / self._timestep).astype(int)
        rows = np.clip(rows, 0, len(points) - 1)
        return np.array([part[rows] for part in vars(points).values()])

    def judge(self, window: Window) -> Gripped | None:
        """Whether the joint reached its goal, or stands still before it and keeps squeezing."""
        active = self._active
        if active is None:
            return None
        count = round(STALL_TIME / self._timestep)
        self._recent = [*self._recent, *window.measured[0, :, 0].tolist()][-count:]
        is_over = (
            window.times[-1] >= active.begin + (len(active.points) - 1) * self._timestep - 1e-9
        )
        miss = abs(self._recent[-1] - active.target)
        reached = is_over and miss <= GOAL_TOLERANCE * self._range
        travel = float(np.ptp(self._recent))
        is_still = len(self._recent) == count and travel < STALL_SPEED * self._speed * STALL_TIME
        if not (reached or is_still):
            return None
        reached = miss <= GOAL_TOLERANCE * self._range
        hold, effort = np.array([active.target]), float(window.efforts[0])
        return Gripped(self.stop(), hold, self._recent[-1], effort, not reached, reached)

    def interrupted(self, goal: str, code: Code, reason: str, window: Window) -> Gripped:
        del code, reason  # its result has no fields for them
        return Gripped(goal, None, float(window.measured[0, -1, 0]), float(window.efforts[0]))
