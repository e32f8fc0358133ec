"""The simulated cell under its controllers: a function of the scenario and the command stream."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from harness.core.errors import StepFailed
from harness.core.types import FloatArray
from harness.plugins.ros.control.controller import Controller, Outcome, Rows, Window
from harness.plugins.ros.control.goals import Code, GoalRefused
from harness.plugins.ros.control.gripper import GripperMotion
from harness.plugins.ros.control.step_response import StepResponse
from harness.plugins.ros.control.summaries import result_of, summary_of
from harness.plugins.ros.control.trajectory import follow_result, start_trajectory
from harness.plugins.ros.program_parts.controllers import ControllerNames
from harness.recording.commands import CommandKind, CommandRecord
from harness.robot.description import TrackingTolerances
from harness.robot.end_effector import Gripper

if TYPE_CHECKING:
    from harness.simulation.mujoco_simulator import MujocoSimulator

TICK = 0.01  # [s] of simulated time between updates of controllers: 100 Hz, as in the course

PLANNED = "planned"  # what became of a request to plan, where it is no failure
CANCELED = "canceled"
PREEMPTED = "a newer command replaced this goal"
STOPPED = "the session ended while this goal was active"
UNBOUNDED = TrackingTolerances(np.inf, np.inf)


class ExternalCell:
    """Controllers on the servos; time moves in `tick` alone, commands come between ticks.

    Attributes:
        commands: Everything that was received.
        end: The end of the launched program or of the session, since `begin`.
        on_outcome: Called with each goal that ended.
        controllers: The controllers, by each of their names.
        change_scene: Changes the planning scene; raises StepFailed where it cannot.
    """

    def __init__(self, servos: MujocoSimulator, names: ControllerNames) -> None:
        self._servos = servos
        self.description = description = servos.description
        self.commands: list[CommandRecord] = []
        self.on_outcome: Callable[[Outcome], object] = lambda _: None
        self.change_scene: Callable[[Sequence[dict[str, Any]]], None] = lambda _: None
        self._rows = max(1, round(TICK / servos.timestep))
        self.controllers: dict[str, Controller] = {}
        for arm, own in names.by_arm.items():
            robot = description.of_arm.get(arm, description)
            if own.arm:
                joints, bounds = robot.group_joints(robot.arm_group), robot.controller_tolerances
                mover = self._controller(joints, bounds or UNBOUNDED)
                self.controllers.update(dict.fromkeys(own.arm, mover))
            if robot.gripper is not None:
                finger = (robot.gripper.joint,)
                self.controllers[own.gripper] = self._controller(finger, UNBOUNDED, robot.gripper)
        self._each = tuple(dict.fromkeys(self.controllers.values()))
        self.begin()

    def _controller(
        self, names: Sequence[str], bounds: TrackingTolerances, gripper: Gripper | None = None
    ) -> Controller:
        description = self.description
        joints = [description.joint_by_name[name] for name in names]
        places = np.array([description.joint_index[name] for name in names])
        columns = np.searchsorted(self._servos.physics.actuated, places)
        return Controller(joints, columns, places, bounds, gripper)

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._servos.time

    @property
    def is_idle(self) -> bool:
        """Whether no controller follows anything."""
        return all(controller.motion is None for controller in self._each)

    def begin(self) -> None:
        """Start from the set points as a planned motion left them."""
        self.end: CommandRecord | None = None
        held = self._servos.commanded_positions()[self._servos.physics.actuated][None]
        self._last: Rows = np.array([held, np.zeros_like(held), np.zeros_like(held)])
        self._sent = self._last
        joints = self.description.movable_joints
        limits = [joints[place].velocity for place in self._servos.physics.actuated]
        self._steps = StepResponse(np.array(limits))

    def receive(
        self, kind: CommandKind, controller: str = "", goal: str = "", **content: Any
    ) -> CommandRecord:
        """Let a command take effect now, and record it with its result."""
        sample = self._servos.sample_count - 1
        summary = summary_of(kind, content)
        record = CommandRecord(
            sample, self.time, kind, controller, goal, content, "accepted", summary
        )
        try:
            if kind == "cancel":
                self._cancel(goal)
            elif kind == "end":
                self.end = record
            elif kind == "scene":
                self.change_scene(content["changes"])
            elif kind == "plan":
                answer = content["answer"]
                record = replace(record, answer=answer, has_failed=answer != PLANNED)
            else:
                self._begin(self.controllers[controller], record)
        except StepFailed as failure:  # of a change of the planning scene
            record = replace(record, answer=str(failure), has_failed=True)
        except GoalRefused as refused:
            record = replace(record, answer=str(refused), has_failed=True)
            if kind == "trajectory" and goal:
                result = follow_result(refused.code, record.answer)
                self.on_outcome(Outcome(goal, False, result))
        self.commands.append(record)
        return record

    def _begin(self, controller: Controller, command: CommandRecord) -> None:
        """Let a controller follow a goal; what it followed before ends."""
        start, gripper = self._last[:, :, controller.columns], controller.gripper
        if gripper is not None and command.kind == "gripper":
            motion = GripperMotion(self._servos, gripper, command, float(start[0, -1, 0]))
        else:
            motion = start_trajectory(controller.joints, controller.bounds, command, start)
        self._interrupt(controller, Code.INVALID_GOAL, PREEMPTED)
        controller.motion = motion
        if command.kind == "trajectory":
            jump = motion.at(np.array([self.time]))[0, 0] - start[0, 0]
            self._steps.add(self.time, controller.columns, jump)
            self._last = self._last.copy()
            self._last[0, -1, controller.columns] += jump  # where a command of this tick starts
        if gripper is not None:
            self._servos.limit_gripper(motion.effort or gripper.grip_effort, gripper.joint)

    def _interrupt(self, controller: Controller, code: Code, reason: str) -> None:
        """End what a controller follows before it is reached."""
        motion, controller.motion = controller.motion, None
        if motion is not None and motion.goal:  # what came from a topic has no result
            self._end(motion.interrupted(code, reason, self._now(controller)), reason)

    def _end(self, outcome: Outcome, reason: str = "") -> None:
        """Record what became of a goal, and report it."""
        for place, command in reversed([*enumerate(self.commands)]):
            if outcome.goal and command.goal == outcome.goal and command.kind != "cancel":
                self.commands[place] = replace(
                    command,
                    result=f"{reason or result_of(outcome)}, t={self.time:.2f} s",
                    has_failed=not outcome.has_succeeded and reason != PREEMPTED,
                )
                break
        self.on_outcome(outcome)

    def _cancel(self, goal: str) -> None:
        """Hold the joints of a goal where they are."""
        for controller in self._each:
            if controller.motion is not None and controller.motion.goal == goal:
                self._hold(controller, self._servos.joint_positions()[controller.places])
                self._interrupt(controller, Code.SUCCESSFUL, CANCELED)
                return
        raise GoalRefused("no such goal is active")

    def tick(self, end: float = np.inf) -> None:
        """Move time by one tick, but not beyond `end` [s], and see which goals ended."""
        servos, left = self._servos, (end - self.time) / self._servos.timestep
        count = self._rows if left >= self._rows else max(1, round(left))
        first = servos.sample_count
        times: FloatArray = np.arange(first, first + count, dtype=np.float64) * servos.timestep
        rows = self._set_points(times)
        sent = self._steps.applied(times, rows)
        servos.stream(np.concatenate([self._sent, sent], axis=1))
        self._last, self._sent = rows[:, -1:], sent[:, -1:]
        for controller in self._each:
            motion = controller.motion
            ended = motion.judge(self._window(controller, times, rows)) if motion else None
            if ended is not None:
                controller.motion = None
                if ended.hold is not None:
                    self._hold(controller, ended.hold)
                self._end(ended)

    def feedback(self) -> Iterator[tuple[str, Any]]:
        """Every goal that is followed, and the feedback of its action at this moment."""
        for each in self._each:
            if each.motion is not None and each.motion.goal:
                yield each.motion.goal, each.motion.feedback(self._now(each))

    def motion_of(self, controller: Controller) -> tuple[FloatArray, FloatArray]:
        """Motion of a controller's joints now: desired, shape (3, dof), and measured, (2, dof)."""
        window = self._now(controller)
        return window.desired[:, -1], window.measured[:, -1]

    def finish(self) -> None:
        """End what is still active; the arm holds its last set point."""
        for controller in self._each:
            self._interrupt(controller, Code.INVALID_GOAL, STOPPED)
        self._servos.command(self._sent[0, -1])

    def _now(self, controller: Controller) -> Window:
        """Desired and measured motion of a controller's joints at this moment."""
        return self._window(controller, np.array([self.time]), self._last)

    def _window(self, controller: Controller, times: FloatArray, rows: Rows) -> Window:
        """Desired and measured motion of a controller's joints at the last samples."""
        measured = np.array(self._servos.measured(self._servos.sample_count - len(times)))
        columns, places = controller.columns, controller.places
        efforts = self._servos.efforts()[columns]
        return Window(times, rows[:, :, columns], measured[:, :, places], efforts)

    def _hold(self, controller: Controller, positions: FloatArray) -> None:
        """Command the joints of a controller to rest at some positions."""
        self._steps.stop(controller.columns)
        self._last, self._sent = self._last.copy(), self._sent.copy()
        for rows in (self._last, self._sent):
            rows[:, -1, controller.columns] = 0.0
            rows[0, -1, controller.columns] = positions

    def _set_points(self, times: FloatArray) -> Rows:
        """Set points of all actuated joints at some times."""
        whole = np.zeros((3, len(times), self._last.shape[2]))
        whole[0] = self._last[0, -1]
        for controller in self._each:
            if controller.motion is not None:
                whole[:, :, controller.columns] = controller.motion.at(times)
        return whole
