"""The simulated cell under its controllers: a function of the scenario and the command stream."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from harness.core.types import FloatArray
from harness.language.scenario import Ros2Names
from harness.recording.commands import CommandKind, CommandRecord
from harness.robot.description import RobotDescription
from harness.ros.control.controller import Outcome, Window
from harness.ros.control.goals import Code, Defaults, GoalRefused
from harness.ros.control.gripper import GripperController
from harness.ros.control.spline import Rows
from harness.ros.control.trajectory import Finished, Tracking, TrajectoryController

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


AnyController = TrajectoryController | GripperController


class ExternalCell:
    """Controllers on the servos; time moves in `tick` alone, commands come between ticks."""

    def __init__(self, servos: MujocoSimulator, names: ControllerNames) -> None:
        self._servos = servos
        self.names = names
        self.description = description = servos.description
        self.commands: list[CommandRecord] = []
        self.outcomes: list[Outcome] = []
        """What ended since it was last taken; in order."""
        self._rows = max(1, round(TICK / servos.timestep))
        tracking = description.tracking
        self.trajectories: dict[str, TrajectoryController] = {}
        if names.arm:
            joints = description.groups[description.arm_group].joint_names
            arm = TrajectoryController(
                names.arm[0],
                [description.joint_by_name[name] for name in joints],
                Defaults(tracking.trajectory, tracking.goal, tracking.goal_time),
            )
            self.trajectories.update(dict.fromkeys(names.arm, arm))
        self.gripper: GripperController | None = None
        if names.gripper and description.gripper is not None:
            self.gripper = GripperController(names.gripper, description, servos.timestep)
            finger = TrajectoryController(names.gripper, self.gripper.joints, Defaults())
            self.trajectories[names.gripper] = finger
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
        return not any(controller.is_active for controller in self._controllers)

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
            self.outcomes.append(Finished(goal, None, code, answer))
        return record

    def _begin(
        self, controller: AnyController | None, goal: str, content: Mapping[str, Any]
    ) -> None:
        """Let a controller follow a goal; what its joints followed before ends."""
        if controller is None:
            raise GoalRefused(Code.INVALID_GOAL, "the robot has no gripper")
        previous = controller.goal
        start = self._last[:, :, controller.columns]
        measured = self._servos.joint_positions()[controller.places]
        controller.begin(goal, content, self.time, start, measured)
        self._interrupt(controller, previous, Code.INVALID_GOAL, PREEMPTED)
        for other in self._controllers:
            if other is not controller and other.joint_names == controller.joint_names:
                self._interrupt(other, other.stop(), Code.INVALID_GOAL, PREEMPTED)
        gripper = self.gripper
        if gripper is not None and controller.joint_names == gripper.joint_names:
            effort = gripper.effort if controller is gripper else gripper.gripper.grip_effort
            self._servos.limit_gripper(effort)

    def _interrupt(self, controller: AnyController, goal: str, code: Code, reason: str) -> None:
        """Report that a goal ended before it was reached; goals from a topic have no result."""
        if goal:
            now = self._window(controller, np.array([self.time]), self._last)
            self.outcomes.append(controller.interrupted(goal, code, reason, now))

    def _cancel(self, goal: str) -> None:
        """Hold the joints of a goal where they are."""
        for controller in self._controllers:
            if controller.goal == goal:
                controller.stop()
                self._hold(controller, self._servos.joint_positions()[controller.places])
                self._interrupt(controller, goal, Code.SUCCESSFUL, "canceled")
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
            if not controller.is_active:
                continue
            ended = controller.judge(self._window(controller, times, rows))
            if ended is not None:
                if ended.hold is not None:
                    self._hold(controller, ended.hold)
                self.outcomes.append(ended)

    def tracking(self) -> list[Tracking]:
        """Desired and actual motion of every goal that is followed."""
        found: list[Tracking] = []
        for controller in dict.fromkeys(self.trajectories.values()):
            if controller.goal:
                now = self._window(controller, np.array([self.time]), self._last)
                desired, actual = now.desired[:2, -1], now.measured[:, -1]
                found.append(Tracking(controller.goal, self.time, desired, actual))
        return found

    def finish(self) -> None:
        """End what is still active; the arm holds its last set point."""
        for controller in self._controllers:
            self._interrupt(controller, controller.stop(), Code.INVALID_GOAL, STOPPED)
        self._servos.command(self._last[0, -1])

    def _window(self, controller: AnyController, times: FloatArray, rows: Rows) -> Window:
        """Desired and measured motion of a controller's joints at the last samples."""
        measured = np.array(self._servos.measured(self._servos.sample_count - len(times)))
        columns, places = controller.columns, controller.places
        efforts = self._servos.efforts()[columns]
        return Window(times, rows[:, :, columns], measured[:, :, places], efforts)

    def _hold(self, controller: AnyController, positions: FloatArray) -> None:
        """Command the joints of a controller to rest at some positions."""
        self._last = self._last.copy()
        self._last[:, -1, controller.columns] = 0.0
        self._last[0, -1, controller.columns] = positions

    def _set_points(self, times: FloatArray) -> Rows:
        """Set points of all actuated joints at some times."""
        whole = np.zeros((3, len(times), self._last.shape[2]))
        whole[0] = self._last[0, -1]
        for controller in self._controllers:
            rows = controller.set_points(times)
            if rows is not None:
                whole[:, :, controller.columns] = rows
        return whole
