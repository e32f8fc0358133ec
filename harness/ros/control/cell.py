"""The simulated cell under its controllers: a function of the scenario and the command stream."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from harness.core.types import FloatArray
from harness.language.scenario import Ros2Names
from harness.recording.commands import CommandKind, CommandRecord
from harness.robot.description import RobotDescription
from harness.ros.control.controller import Command, Controller, Outcome, Rows, Window
from harness.ros.control.goals import Code, Defaults, GoalRefused
from harness.ros.control.gripper import GripperMotion
from harness.ros.control.trajectory import follow_result, start_trajectory

if TYPE_CHECKING:
    from harness.simulation.mujoco_simulator import MujocoSimulator

TICK = 0.01
"""Simulated time from one update of the controllers to the next [s]: 100 Hz, as in the course."""

PREEMPTED = "a newer command replaced this goal"
STOPPED = "the session ended while this goal was active"


@dataclass(frozen=True)
class ControllerNames:
    """What controllers are called on the graph.

    Attributes:
        arm: Names of the arm's trajectory controller; all lead to the same one.
        gripper: The name of the gripper's controller; empty where there is no gripper.
    """

    arm: tuple[str, ...]
    gripper: str = ""


def controller_names(description: RobotDescription, names: Ros2Names) -> ControllerNames:
    """The scenario's names, else the robot's, else `<group>_controller` as MoveIt's assistant."""
    own, group, gripper = description.controllers, description.arm_group, description.gripper
    arm = names.arm_controllers or own.get("arm") or (f"{group}_controller",)
    if gripper is None:
        return ControllerNames(arm if group else ())
    default = next(iter(own.get("gripper", ())), f"{gripper.group}_controller")
    return ControllerNames(arm if group else (), names.gripper_controller or default)


class ExternalCell:
    """Controllers on the servos; time moves in `tick` alone, commands come between ticks.

    Attributes:
        commands: Everything that was received.
        outcomes: What ended since it was last taken; in order.
        trajectories: The controllers that follow trajectories, by each of their names.
        gripper: The controller of GripperCommand; None without a gripper.
    """

    def __init__(self, servos: MujocoSimulator, names: ControllerNames) -> None:
        self._servos = servos
        self.description = description = servos.description
        self.commands: list[CommandRecord] = []
        self.outcomes: list[Outcome] = []
        self._rows = max(1, round(TICK / servos.timestep))
        self.trajectories: dict[str, Controller] = {}
        self.gripper: Controller | None = None
        if names.arm:
            group, tracking = description.groups[description.arm_group], description.tracking
            joints = [description.joint_by_name[name] for name in group.joint_names]
            bounds = Defaults(tracking.trajectory, tracking.goal, tracking.goal_time)
            arm = Controller(names.arm[0], joints, partial(start_trajectory, joints, bounds))
            self.trajectories.update(dict.fromkeys(names.arm, arm))
        if names.gripper and description.gripper is not None:
            name, joints = names.gripper, [description.joint_by_name[description.gripper.joint]]
            start = partial(GripperMotion, description, servos.timestep)
            self.gripper = Controller(name, joints, start)
            finger = partial(start_trajectory, joints, Defaults())
            self.trajectories[name] = Controller(name, joints, finger)
        controllers = (*dict.fromkeys(self.trajectories.values()), self.gripper)
        self._controllers = tuple(each for each in controllers if each is not None)
        place, actuated = description.joint_index, servos.actuated_joints
        self._actuated = np.array([place[name] for name in actuated], dtype=np.int64)
        for each in self._controllers:
            each.columns = np.array([actuated.index(name) for name in each.joint_names])
            each.places = np.array([place[name] for name in each.joint_names])
        self.hold_commanded(
            description.start_positions() if servos.sample_count == 1 else servos.joint_positions()
        )

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._servos.time

    @property
    def is_idle(self) -> bool:
        """Whether no controller follows anything."""
        return all(controller.motion is None for controller in self._controllers)

    def hold_commanded(self, positions: FloatArray) -> None:
        """Start from set points in description order, such as a planned motion left them."""
        held = positions[self._actuated][None]
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
        content = content or {}
        code, answer = Code.SUCCESSFUL, "accepted"
        try:
            if kind == "trajectory":
                self._begin(self.trajectories[controller], goal, content)
            elif kind == "gripper":
                self._begin(self.gripper, goal, content)
            elif kind == "cancel":
                self._cancel(goal)
        except GoalRefused as refused:
            code, answer = refused.code, str(refused)
        record = CommandRecord(
            self._servos.sample_count - 1, self.time, kind, controller, goal, content, answer
        )
        self.commands.append(record)
        if code != Code.SUCCESSFUL and kind == "trajectory" and goal:
            self.outcomes.append(Outcome(goal, False, follow_result(code, answer)))
        return record

    def _begin(self, controller: Controller | None, goal: str, content: Mapping[str, Any]) -> None:
        """Let a controller follow a goal; what its joints followed before ends."""
        if controller is None:
            raise GoalRefused(Code.INVALID_GOAL, "the robot has no gripper")
        start = self._last[:, :, controller.columns]
        measured = self._servos.joint_positions()[controller.places]
        motion = controller.start(Command(goal, content, self.time, start, measured))
        for other in self._controllers:
            if other.joint_names == controller.joint_names:
                self._interrupt(other, Code.INVALID_GOAL, PREEMPTED)
        controller.motion, gripper = motion, self.description.gripper
        if gripper is not None and controller.joint_names == (gripper.joint,):
            self._servos.limit_gripper(motion.effort or gripper.grip_effort)

    def _interrupt(self, controller: Controller, code: Code, reason: str) -> None:
        """End what a controller follows before it is reached."""
        motion, controller.motion = controller.motion, None
        if motion is not None and motion.goal:  # what came from a topic has no result
            now = self._window(controller, np.array([self.time]), self._last)
            self.outcomes.append(motion.interrupted(code, reason, now))

    def _cancel(self, goal: str) -> None:
        """Hold the joints of a goal where they are."""
        for controller in self._controllers:
            if controller.goal == goal:
                self._hold(controller, self._servos.joint_positions()[controller.places])
                self._interrupt(controller, Code.SUCCESSFUL, "canceled")
                return
        raise GoalRefused(Code.INVALID_GOAL, "no such goal is active")

    # -- time ---------------------------------------------------------------------------------

    def tick(self) -> None:
        """Move time by one tick, and see which goals ended."""
        servos, count = self._servos, self._rows
        first = servos.sample_count
        times: FloatArray = np.arange(first, first + count, dtype=np.float64) * servos.timestep
        rows = self._set_points(times)
        servos.stream(np.concatenate([self._last, rows], axis=1))
        self._last = rows[:, -1:]
        for controller in self._controllers:
            motion = controller.motion
            if motion is None:
                continue
            ended = motion.judge(self._window(controller, times, rows))
            if ended is not None:
                controller.motion = None
                if ended.hold is not None:
                    self._hold(controller, ended.hold)
                self.outcomes.append(ended)

    def tracking(self) -> list[tuple[Controller, Window]]:
        """Desired and measured motion of every trajectory with a goal, at this moment."""
        return [
            (each, self._window(each, np.array([self.time]), self._last))
            for each in dict.fromkeys(self.trajectories.values())
            if each.goal
        ]

    def finish(self) -> None:
        """End what is still active; the arm holds its last set point."""
        for controller in self._controllers:
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
        for controller in self._controllers:
            if controller.motion is not None:
                whole[:, :, controller.columns] = controller.motion.at(times)
        return whole
