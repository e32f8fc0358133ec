"""The simulated cell under its controllers: a function of the scenario and the command stream."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from harness.core.types import FloatArray
from harness.language.scenario import Ros2Names
from harness.recording.commands import CommandKind, CommandRecord
from harness.robot.description import RobotDescription, TrackingTolerances
from harness.ros.control.controller import Controller, Outcome, Rows, Window
from harness.ros.control.goals import Code, GoalRefused
from harness.ros.control.gripper import GripperMotion
from harness.ros.control.trajectory import follow_result, start_trajectory

if TYPE_CHECKING:
    from harness.simulation.mujoco_simulator import MujocoSimulator

TICK = 0.01
"""Simulated time from one update of the controllers to the next [s]: 100 Hz, as in the course."""

PREEMPTED = "a newer command replaced this goal"
STOPPED = "the session ended while this goal was active"
UNBOUNDED = TrackingTolerances(np.inf, np.inf)


def controller_names(
    description: RobotDescription, names: Ros2Names
) -> tuple[tuple[str, ...], str]:
    """The scenario's names, else the robot's, else `<group>_controller` as MoveIt's assistant.

    Returns:
        The names of the arm's controller, which all lead to the same one, and the name of the
        gripper's; empty where there is none.
    """
    own, group, gripper = description.controllers, description.arm_group, description.gripper
    arm = names.arm_controllers or own.get("arm") or (f"{group}_controller",)
    if gripper is None:
        return arm if group else (), ""
    default = next(iter(own.get("gripper", ())), f"{gripper.group}_controller")
    return arm if group else (), names.gripper_controller or default


class ExternalCell:
    """Controllers on the servos; time moves in `tick` alone, commands come between ticks.

    Attributes:
        commands: Everything that was received.
        on_outcome: Called with each goal that ended.
        controllers: The controllers, by each of their names.
    """

    def __init__(self, servos: MujocoSimulator, names: Ros2Names) -> None:
        self._servos = servos
        self.description = description = servos.description
        self.commands: list[CommandRecord] = []
        self.on_outcome: Callable[[Outcome], None] = lambda _: None
        self._rows = max(1, round(TICK / servos.timestep))
        self.controllers: dict[str, Controller] = {}
        arm, finger = controller_names(description, names)
        if arm:
            joints = description.groups[description.arm_group].joint_names
            group = self._controller(joints, description.tracking)
            self.controllers.update(dict.fromkeys(arm, group))
        if finger and description.gripper is not None:
            grip = self.controllers[finger] = self._controller(
                [description.gripper.joint], UNBOUNDED
            )
            grip.start["gripper"] = partial(GripperMotion, description, servos.timestep)
        self._each = tuple(dict.fromkeys(self.controllers.values()))
        self.hold_commanded(
            description.start_positions() if servos.sample_count == 1 else servos.joint_positions()
        )

    def _controller(self, names: Sequence[str], bounds: TrackingTolerances) -> Controller:
        """A controller of some joints, which follows trajectories within bounds."""
        description, actuated = self.description, self._servos.physics.actuated
        joints = [description.joint_by_name[name] for name in names]
        places = np.array([description.joint_index[name] for name in names])
        follow = partial(start_trajectory, joints, bounds)
        columns = np.searchsorted(actuated, places)
        return Controller(names, columns, places, {"trajectory": follow})

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._servos.time

    @property
    def is_idle(self) -> bool:
        """Whether no controller follows anything."""
        return all(controller.motion is None for controller in self._each)

    def hold_commanded(self, positions: FloatArray) -> None:
        """Start from set points in description order, such as a planned motion left them."""
        held = positions[self._servos.physics.actuated][None]
        self._last: Rows = np.array([held, np.zeros_like(held), np.zeros_like(held)])

    # -- commands -----------------------------------------------------------------------------

    def receive(
        self,
        kind: CommandKind,
        controller: str = "",
        goal: str = "",
        content: Mapping[str, Any] | None = None,
    ) -> CommandRecord:
        """Let a command take effect now, and record it with what became of it."""
        sample, content = self._servos.sample_count - 1, content or {}
        record = CommandRecord(sample, self.time, kind, controller, goal, content, "accepted")
        try:
            if kind == "cancel":
                self._cancel(goal)
            elif kind != "end":
                self._begin(self.controllers[controller], record)
        except GoalRefused as refused:
            record = replace(record, answer=str(refused))
            if kind == "trajectory" and goal:
                result = follow_result(refused.code, record.answer)
                self.on_outcome(Outcome(goal, False, result))
        self.commands.append(record)
        return record

    def _begin(self, controller: Controller, command: CommandRecord) -> None:
        """Let a controller follow a goal; what it followed before ends."""
        start = self._last[:, :, controller.columns]
        measured = self._servos.joint_positions()[controller.places]
        motion = controller.start[command.kind](command, start, measured)
        self._interrupt(controller, Code.INVALID_GOAL, PREEMPTED)
        controller.motion, gripper = motion, self.description.gripper
        if gripper is not None and "gripper" in controller.start:
            self._servos.limit_gripper(motion.effort or gripper.grip_effort)

    def _interrupt(self, controller: Controller, code: Code, reason: str) -> None:
        """End what a controller follows before it is reached."""
        motion, controller.motion = controller.motion, None
        if motion is not None and motion.goal:  # what came from a topic has no result
            now = self._window(controller, np.array([self.time]), self._last)
            self.on_outcome(motion.interrupted(code, reason, now))

    def _cancel(self, goal: str) -> None:
        """Hold the joints of a goal where they are."""
        for controller in self._each:
            if controller.goal == goal:
                self._hold(controller, self._servos.joint_positions()[controller.places])
                self._interrupt(controller, Code.SUCCESSFUL, "canceled")
                return
        raise GoalRefused("no such goal is active")

    # -- time ---------------------------------------------------------------------------------

    def tick(self) -> None:
        """Move time by one tick, and see which goals ended."""
        servos, count = self._servos, self._rows
        first = servos.sample_count
        times: FloatArray = np.arange(first, first + count, dtype=np.float64) * servos.timestep
        rows = self._set_points(times)
        servos.stream(np.concatenate([self._last, rows], axis=1))
        self._last = rows[:, -1:]
        for controller in self._each:
            motion = controller.motion
            ended = motion.judge(self._window(controller, times, rows)) if motion else None
            if ended is not None:
                controller.motion = None
                if ended.hold is not None:
                    self._hold(controller, ended.hold)
                self.on_outcome(ended)

    def tracking(self) -> list[tuple[Controller, Window]]:
        """Desired and measured motion of every controller with a goal, at this moment."""
        now = np.array([self.time])
        return [(each, self._window(each, now, self._last)) for each in self._each if each.goal]

    def finish(self) -> None:
        """End what is still active; the arm holds its last set point."""
        for controller in self._each:
            self._interrupt(controller, Code.INVALID_GOAL, STOPPED)
        self._servos.command(self._last[0, -1])

    def _window(self, controller: Controller, times: FloatArray, rows: Rows) -> Window:
        """Desired and measured motion of a controller's joints at the last samples."""
        measured = np.array(self._servos.measured(self._servos.sample_count - len(times)))
        columns, places = controller.columns, controller.places
        efforts = self._servos.efforts()[columns]
        return Window(times, rows[:, :, columns], measured[:, :, places], efforts)

    def _hold(self, controller: Controller, positions: FloatArray) -> None:
        """Command the joints of a controller to rest at some positions."""
        self._last = self._last.copy()
        self._last[:, -1, controller.columns] = 0.0
        self._last[0, -1, controller.columns] = positions

    def _set_points(self, times: FloatArray) -> Rows:
        """Set points of all actuated joints at some times."""
        whole = np.zeros((3, len(times), self._last.shape[2]))
        whole[0] = self._last[0, -1]
        for controller in self._each:
            if controller.motion is not None:
                whole[:, :, controller.columns] = controller.motion.at(times)
        return whole
