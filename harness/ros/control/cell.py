"""The simulated cell under its controllers: a function of the scenario and the command stream."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from harness.core.types import FloatArray, IntArray
from harness.language.scenario import Ros2Names
from harness.recording.commands import CommandKind, CommandRecord
from harness.robot.description import RobotDescription
from harness.ros.control.goals import Code, GoalRefused
from harness.ros.control.gripper import Gripped, GripperController
from harness.ros.control.spline import Rows
from harness.ros.control.trajectory import (
    Defaults,
    Finished,
    Tracking,
    TrajectoryController,
)

TICK = 0.01
"""Simulated time from one update of the controllers to the next [s]: 100 Hz, as in the course."""

PREEMPTED = "a newer command replaced this goal"
STOPPED = "the session ended while this goal was active"


class Servos(Protocol):
    """The part of the simulator that external control needs."""

    description: RobotDescription

    @property
    def timestep(self) -> float: ...
    @property
    def sample_count(self) -> int: ...
    @property
    def time(self) -> float: ...
    @property
    def actuated_joints(self) -> tuple[str, ...]: ...
    def joint_positions(self) -> FloatArray: ...
    def stream(self, rows: Rows) -> None: ...
    def measured(self, first: int) -> tuple[FloatArray, FloatArray]: ...
    def efforts(self) -> FloatArray: ...
    def limit_gripper(self, effort: float) -> None: ...


Controller = TrajectoryController | GripperController
Outcome = Finished | Gripped


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
    """Controllers on the servos; time moves in `tick` alone, commands come between ticks."""

    def __init__(self, servos: Servos, names: ControllerNames) -> None:
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
            finger = TrajectoryController(names.gripper, [self.gripper.joint], Defaults())
            self.trajectories[names.gripper] = finger
        controllers = (*dict.fromkeys(self.trajectories.values()), self.gripper)
        self._controllers: tuple[Controller, ...] = tuple(c for c in controllers if c is not None)
        start = (
            description.start_positions() if servos.sample_count == 1 else servos.joint_positions()
        )
        held = np.array([start[description.joint_index[name]] for name in servos.actuated_joints])
        self._last: Rows = (held[None], np.zeros((1, len(held))), np.zeros((1, len(held))))

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
        place = self.description.joint_index
        held = np.array([positions[place[name]] for name in self._servos.actuated_joints])
        self._last = (held[None], np.zeros((1, len(held))), np.zeros((1, len(held))))

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
                self._begin_trajectory(controller, goal, content)
            elif kind == "gripper":
                self._begin_gripper(goal, content)
            elif kind == "cancel":
                self._cancel(goal)
        except GoalRefused as refused:
            code, answer = refused.code, str(refused)
        record = CommandRecord(
            self._servos.sample_count - 1, self.time, kind, controller, goal, content, answer
        )
        self.commands.append(record)
        if code != Code.SUCCESSFUL and kind == "trajectory" and goal:
            self.outcomes.append(Finished(goal, code, answer))
        return record

    def _begin_trajectory(self, name: str, goal: str, content: Mapping[str, Any]) -> None:
        controller = self.trajectories[name]
        columns = self._columns(controller)
        start = tuple(part[-1:, columns] for part in self._last)
        previous = controller.goal
        controller.begin(goal, content, self.time, (start[0], start[1], start[2]))
        if previous:
            self._preempt(controller, previous)
        if self.gripper is not None and controller.joint_names == self.gripper.joint_names:
            self._stop_others(self.gripper)
            self._servos.limit_gripper(self.gripper.gripper.grip_effort)

    def _begin_gripper(self, goal: str, content: Mapping[str, Any]) -> None:
        gripper = self.gripper
        if gripper is None:
            raise GoalRefused(Code.INVALID_GOAL, "the robot has no gripper")
        column = self._columns(gripper)[0]
        commanded = float(self._last[0][-1, column])
        index = self.description.joint_index[gripper.joint.name]
        measured = float(self._servos.joint_positions()[index])
        previous = gripper.goal
        effort = gripper.begin(goal, content, self.time, commanded, measured)
        if previous:
            self._preempt(gripper, previous)
        self._stop_others(self.trajectories[gripper.name])
        self._servos.limit_gripper(effort)

    def _stop_others(self, controller: Controller) -> None:
        """Stop a controller of the same joint."""
        goal = controller.stop()
        if goal:
            self._preempt(controller, goal)

    def _preempt(self, controller: Controller, goal: str) -> None:
        if isinstance(controller, TrajectoryController):
            self.outcomes.append(Finished(goal, Code.INVALID_GOAL, PREEMPTED))
        else:
            self.outcomes.append(self._gripped(controller, goal))

    def _gripped(self, gripper: GripperController, goal: str) -> Gripped:
        index = self.description.joint_index[gripper.joint.name]
        effort = float(self._servos.efforts()[self._columns(gripper)[0]])
        return Gripped(goal, float(self._servos.joint_positions()[index]), effort, False, False)

    def _cancel(self, goal: str) -> None:
        """Hold the joints of a goal where they are."""
        for controller in self._controllers:
            if controller.goal == goal:
                controller.stop()
                self._hold(controller)
                if isinstance(controller, GripperController):
                    self.outcomes.append(self._gripped(controller, goal))
                else:
                    self.outcomes.append(Finished(goal, Code.SUCCESSFUL, "canceled"))
                return
        raise GoalRefused(Code.INVALID_GOAL, "no such goal is active")

    # -- time ---------------------------------------------------------------------------------

    def tick(self) -> None:
        """Move time by one tick, and see which goals ended."""
        servos, count = self._servos, self._rows
        first = servos.sample_count
        times: FloatArray = np.arange(first, first + count, dtype=np.float64) * servos.timestep
        rows = self._set_points(times)
        servos.stream(_joined(self._last, rows))
        self._last = (rows[0][-1:], rows[1][-1:], rows[2][-1:])
        positions, velocities = servos.measured(first)
        for controller in self._controllers:
            if not controller.is_active:
                continue
            places = [self.description.joint_index[name] for name in controller.joint_names]
            columns = self._columns(controller)
            if isinstance(controller, GripperController):
                self._judge_gripper(controller, times, positions[:, places[0]], columns[0])
                continue
            desired = (rows[0][:, columns], rows[1][:, columns], rows[2][:, columns])
            ended = controller.judge(times, desired, positions[:, places], velocities[:, places])
            if ended is not None:
                if ended.code in (Code.PATH_TOLERANCE_VIOLATED, Code.GOAL_TOLERANCE_VIOLATED):
                    self._hold(controller)
                self.outcomes.append(ended)

    def tracking(self) -> list[Tracking]:
        """Desired and actual motion of every goal that is followed."""
        positions, velocities = self._servos.measured(self._servos.sample_count - 1)
        found: list[Tracking] = []
        for controller in dict.fromkeys(self.trajectories.values()):
            if controller.goal:
                places = [self.description.joint_index[name] for name in controller.joint_names]
                columns = self._columns(controller)
                found.append(
                    Tracking(
                        controller.goal,
                        self.time,
                        self._last[0][-1, columns],
                        self._last[1][-1, columns],
                        positions[-1, places],
                        velocities[-1, places],
                    )
                )
        return found

    def finish(self) -> None:
        """End what is still active; the arm holds its last set point."""
        for controller in self._controllers:
            goal = controller.stop()
            if goal and isinstance(controller, GripperController):
                self.outcomes.append(self._gripped(controller, goal))
            elif goal:
                self.outcomes.append(Finished(goal, Code.INVALID_GOAL, STOPPED))

    def _judge_gripper(
        self, gripper: GripperController, times: FloatArray, positions: FloatArray, column: int
    ) -> None:
        target = gripper.target
        effort = float(self._servos.efforts()[column])
        ended = gripper.judge(float(times[-1]), positions, effort)
        if ended is not None:
            assert target is not None
            self._last[0][-1, column] = target  # it keeps squeezing
            self._last[1][-1, column] = self._last[2][-1, column] = 0.0
            self.outcomes.append(ended)

    def _hold(self, controller: Controller) -> None:
        """Command the joints of a controller to where they are."""
        columns = self._columns(controller)
        positions = self._servos.joint_positions()
        places = [self.description.joint_index[name] for name in controller.joint_names]
        last = tuple(part.copy() for part in self._last)
        last[0][-1, columns] = positions[places]
        last[1][-1, columns] = 0.0
        last[2][-1, columns] = 0.0
        self._last = (last[0], last[1], last[2])

    def _set_points(self, times: FloatArray) -> Rows:
        """Set points of all actuated joints at some times."""
        shape = (len(times), self._last[0].shape[1])
        positions = np.broadcast_to(self._last[0][-1], shape).copy()
        velocities, accelerations = np.zeros(shape), np.zeros(shape)
        for controller in self._controllers:
            rows = controller.set_points(times)
            if rows is not None:
                columns = self._columns(controller)
                for whole, part in zip((positions, velocities, accelerations), rows, strict=True):
                    whole[:, columns] = part
        return positions, velocities, accelerations

    def _columns(self, controller: Controller) -> IntArray:
        """Places of a controller's joints among the actuated ones."""
        names = self._servos.actuated_joints
        return np.array([names.index(name) for name in controller.joint_names], dtype=np.int64)


def _joined(first: Rows, rest: Rows) -> Rows:
    parts: Sequence[FloatArray] = [np.vstack([a, b]) for a, b in zip(first, rest, strict=True)]
    return parts[0], parts[1], parts[2]
