"""A GripperCommand: one joint to a position under an effort limit, until it stalls."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from harness.core.types import FloatArray
from harness.plugins.ros.bag.messages import message
from harness.plugins.ros.control.controller import Outcome, Rows, Window
from harness.plugins.ros.control.goals import LIMIT_SLACK, Code, GoalRefused
from harness.plugins.ros.interfaces import GRIPPER
from harness.recording.commands import CommandRecord
from harness.robot.end_effector import Gripper
from harness.simulation.gripper_drive import (
    GOAL_TOLERANCE,
    STALL_SPEED,
    STALL_TIME,
    gripper_ramp,
)

if TYPE_CHECKING:
    from harness.simulation.mujoco_simulator import MujocoSimulator


class GripperMotion:
    """Moves the gripper's joint as the step `gripper` does, independent of the arm."""

    def __init__(
        self,
        servos: MujocoSimulator,
        gripper: Gripper,
        command: CommandRecord,
        commanded: float,
    ) -> None:
        """Plan the motion to `position` under `max_effort`, 0 for the gripper's own.

        Args:
            commanded: The last set point of the joint.

        Raises:
            GoalRefused: A number is not finite, or beyond the joint's limits.
        """
        description = servos.description
        target, effort = (float(command.content[key]) for key in ("position", "max_effort"))
        if not np.isfinite([target, effort]).all() or effort < 0:
            raise GoalRefused(
                f"position ({target:g}) and max_effort ({effort:g}) must be finite numbers,"
                " max_effort not below 0"
            )
        joint = description.joint_by_name[gripper.joint]
        if not joint.lower - LIMIT_SLACK <= target <= joint.upper + LIMIT_SLACK:
            reach = f"from {joint.lower:g} to {joint.upper:g}"
            raise GoalRefused(f"'{joint.name}' goes {reach}, not to {target:g}")
        self.goal, self.effort = command.goal, min(effort, gripper.max_effort)
        self._speed = description.closing_speed(gripper)
        self._range = abs(gripper.closed_position - gripper.open_position)
        self._target, self._timestep, self._begin = target, servos.timestep, command.time
        here = float(servos.joint_positions()[description.joint_index[joint.name]])
        points = gripper_ramp(joint, self._speed, here, commanded, target, servos.timestep)
        self._rows: Rows = np.array([points.positions, points.velocities, points.accelerations])
        self._recent: list[float] = []

    def at(self, times: FloatArray) -> Rows:
        rows = np.rint((times - self._begin) / self._timestep).astype(int)
        return self._rows[:, np.clip(rows, 0, self._rows.shape[1] - 1)]

    def judge(self, window: Window) -> Outcome | None:
        """Whether the joint reached its goal, or stands still before it and keeps squeezing."""
        count = round(STALL_TIME / self._timestep)
        self._recent = [*self._recent, *window.measured[0, :, 0].tolist()][-count:]
        end = self._begin + (self._rows.shape[1] - 1) * self._timestep
        is_near = abs(self._recent[-1] - self._target) <= GOAL_TOLERANCE * self._range
        has_arrived = is_near and window.times[-1] >= end - 1e-9
        travel = float(np.ptp(self._recent))
        is_still = len(self._recent) == count and travel < STALL_SPEED * self._speed * STALL_TIME
        if not (has_arrived or is_still):
            return None
        hold = np.array([self._target])
        return self._ended(window, hold, stalled=not is_near, reached_goal=is_near)

    def feedback(self, window: Window) -> Any:
        return self._message("Feedback", window)

    def interrupted(self, code: Code, reason: str, window: Window) -> Outcome:
        del code, reason  # its result has no fields for them
        return self._ended(window, None)

    def _ended(self, window: Window, hold: FloatArray | None, **flags: bool) -> Outcome:
        return Outcome(
            self.goal, any(flags.values()), self._message("Result", window, **flags), hold
        )

    def _message(self, part: str, window: Window, **flags: bool) -> Any:
        position, effort = float(window.measured[0, -1, 0]), float(window.efforts[0])
        return message(f"{GRIPPER}_{part}", position=position, effort=effort, **flags)
