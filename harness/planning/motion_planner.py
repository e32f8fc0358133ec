"""The planner's front door: free motions, joint motions, straight lines, each verified."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from harness.core.errors import ErrorCode, PlanningFailed
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.free_motion import find_motion
from harness.planning.goals import find_goals
from harness.planning.kinematics import PinocchioKinematics, meets_tolerance
from harness.planning.linear_path import (
    ORIENTATION_DEVIATION,
    POSITION_DEVIATION,
    STEP_LENGTH,
    Line,
    Trace,
    deviation,
    time_line,
    trace,
)
from harness.planning.profiles import cubic_curve, on_grid, resting, sample
from harness.planning.scene import CoalScene
from harness.planning.task import PlanningTask, make_task
from harness.planning.timing import Limits, TimingError, time_straight
from harness.ports import Goal, JointGoal, MotionPlan, PlanningOptions, PoseGoal
from harness.robot.description import RobotDescription

STATE_CHECKS_PER_SECOND = 20_000
"""What a second of `planning_time` is worth in state checks, on every machine.

One check of a UR with its gripper in the lesson's world takes 20 to 25 microseconds on the
project's machines, so that a second there buys twice as much.
"""

RELATIVE_STEP = 0.002
"""Step of a motion that goes as far as it can [m]."""


class VerifiedPlanner:
    """The port `MotionPlanner` over a scene."""

    def __init__(self, scene: CoalScene, kinematics: PinocchioKinematics) -> None:
        self.scene = scene
        self.kinematics = kinematics

    @property
    def description(self) -> RobotDescription:
        """Of the robot that is planned for."""
        return self.scene.description

    def plan(
        self, group: str, start: FloatArray, goal: Goal, options: PlanningOptions
    ) -> MotionPlan:
        """Plan a collision-free motion to a goal; `start` in description order."""
        task = self._task(group, start, options)
        found = find_goals(self.kinematics, task.checker, np.asarray(start), goal, options.seed)
        explanation = {**found.explanation, "lowered_margins": list(task.checker.lowered)}
        return find_motion(task, found.positions, explanation)

    def plan_joint_motion(
        self,
        group: str,
        start: FloatArray,
        positions: FloatArray,
        options: PlanningOptions,
        duration: float | None = None,
    ) -> MotionPlan:
        """Plan Pilz's PTP: all joints together, straight in joint space.

        A given duration is exact to the physics' time grid, as a cubic from rest to rest, under
        the joints' whole limits; without one it is the fastest under the scaled limits.
        """
        task = self._task(group, start, options)
        goal = JointGoal(np.asarray(positions, dtype=float))
        found = find_goals(self.kinematics, task.checker, np.asarray(start), goal, options.seed)
        end = found.positions[0]
        if duration is None:
            trajectory = time_straight(task.space.joint_names, task.start, end, task.limits)
        else:
            task = replace(task, limits=_whole_limits(task))
            trajectory = _timed_by_hand(task, end, duration)
        self._accept(task, trajectory, end, "the straight joint motion cannot be executed")
        explanation = {"lowered_margins": list(task.checker.lowered)}
        statistics = task.statistics("PTP", trajectory, [task.start, end])
        return MotionPlan(trajectory, statistics, explanation)

    def plan_linear(
        self, group: str, start: FloatArray, goal: PoseGoal, options: PlanningOptions
    ) -> MotionPlan:
        """Plan Pilz's LIN: the link on a straight line, turning at an even rate."""
        task = self._task(group, start, options)
        found = find_goals(self.kinematics, task.checker, np.asarray(start), goal, options.seed)
        here = self.kinematics.link_pose(start, goal.link)
        line = Line.between(goal.link, here, goal.pose)
        traced = trace(line, task.checker, task.start)
        if traced.reason != "end":
            raise self._line_failed(line, traced)
        end_pose = self.kinematics.link_pose(task.space.whole(traced.positions[-1]), goal.link)
        if not meets_tolerance(goal, end_pose):
            shift, angle = goal.pose.distance_to(end_pose)
            raise PlanningFailed(
                "NO_IK_SOLUTION",
                f"at the end of the line {goal.link} is {1000 * shift:.1f} mm and {angle:.4f} rad "
                "from the goal",
                {"position_error": shift, "orientation_error": angle},
            )
        explanation = {**found.explanation, "lowered_margins": list(task.checker.lowered)}
        return self._line_plan(task, line, traced, "LIN", explanation)

    def plan_relative(
        self,
        group: str,
        start: FloatArray,
        link: str,
        twist: FloatArray,
        distances: tuple[float, float],
        options: PlanningOptions,
    ) -> MotionPlan:
        """Move a link along a direction as far as goes between two distances."""
        task = self._task(group, start, options)
        least, most = distances
        twist = np.asarray(twist, dtype=float)
        here = self.kinematics.link_pose(start, link)
        line = Line(link, here, most * twist[:3], most * twist[3:])
        step = RELATIVE_STEP if least < most else STEP_LENGTH
        traced = trace(line, task.checker, task.start, step)
        reached = traced.share * most
        if traced.reason != "end" and reached < least:
            unit, scale = ("mm", 1000.0) if np.any(twist[:3]) else ("°", float(np.degrees(1.0)))
            raise PlanningFailed(
                "PLANNING_FAILED",
                f"{link} gets {scale * reached:.1f} of {scale * least:.1f} {unit} far: "
                f"{traced.stop}",
                {"reached": reached, "least": least, "reason": traced.reason, **traced.facts},
            )
        explanation = {
            "lowered_margins": list(task.checker.lowered),
            "distance": reached,
            "stopped_by": traced.stop,
        }
        if traced.reason != "end":
            line = line.part(traced.share)
            traced = trace(line, task.checker, task.start, step)
            if traced.reason != "end":
                raise self._line_failed(line, traced)
        return self._line_plan(task, line, traced, "move_relative", explanation)

    def check_goal(
        self, group: str, start: FloatArray, goal: Goal, options: PlanningOptions
    ) -> Mapping[str, Any]:
        """What can be said of a goal without planning to it: each IK solution's fate.

        `positions` are the group's at the free solution that would be tried first.
        """
        task = self._task(group, start, options)
        found = find_goals(self.kinematics, task.checker, np.asarray(start), goal, options.seed)
        return {**found.explanation, "positions": found.positions[0].tolist()}

    def _task(self, group: str, start: FloatArray, options: PlanningOptions) -> PlanningTask:
        return make_task(self.scene, self.kinematics.robot, group, start, options)

    def _line_plan(
        self, task: PlanningTask, line: Line, traced: Trace, kind: str, explanation: dict[str, Any]
    ) -> MotionPlan:
        names, end = task.space.joint_names, traced.positions[-1]
        if line.length < 1e-9 and line.angle < 1e-9:
            trajectory = resting(names, task.start)
        else:
            options = task.options
            scaling = (options.velocity_scaling, options.acceleration_scaling)
            try:
                trajectory = time_line(line, traced, task.checker, task.limits, scaling)
            except TimingError as problem:
                raise PlanningFailed("INVALID_MOTION_PLAN", str(problem)) from problem
        self._accept(task, trajectory, end, "the motion on the line cannot be executed")
        shift, turn = deviation(
            line,
            trajectory,
            lambda positions: self.kinematics.link_pose(task.space.whole(positions), line.link),
            pitch_only=task.space.dof < 6,
        )
        if shift > POSITION_DEVIATION or turn > ORIENTATION_DEVIATION:
            raise PlanningFailed(
                "INVALID_MOTION_PLAN",
                f"{line.link} would leave its line by {1000 * shift:.3f} mm and {turn:.5f} rad",
                {"position_deviation": shift, "orientation_deviation": turn},
            )
        statistics = task.statistics(kind, trajectory, traced.positions)
        statistics |= {"position_deviation": shift, "orientation_deviation": turn}
        return MotionPlan(trajectory, statistics, explanation)

    def _line_failed(self, line: Line, traced: Trace) -> PlanningFailed:
        codes: dict[str, ErrorCode] = {
            "unreachable": "NO_IK_SOLUTION",
            "limit": "NO_IK_SOLUTION",
            "jump": "PLANNING_FAILED",
            "collision": "INVALID_MOTION_PLAN",
        }
        return PlanningFailed(
            codes[traced.reason],
            f"{line.link} can follow the straight line for {100 * traced.share:.0f} % of its "
            f"{1000 * line.length:.1f} mm: {traced.stop}",
            {"free_share": traced.share, "reason": traced.reason, **traced.facts},
        )

    def _accept(
        self, task: PlanningTask, trajectory: JointTrajectory, end: FloatArray, what: str
    ) -> None:
        defect = task.defect(trajectory, end)
        if defect is not None:
            raise PlanningFailed(
                "INVALID_MOTION_PLAN", f"{what}: {defect.message}", dict(defect.facts)
            )


def _whole_limits(task: PlanningTask) -> Limits:
    return Limits.scaled(task.space.velocity, task.space.acceleration, 1.0, 1.0)


def _timed_by_hand(task: PlanningTask, end: FloatArray, duration: float) -> JointTrajectory:
    """A cubic from rest to rest in exactly the duration asked for.

    Raises:
        PlanningFailed: INVALID_MOTION_PLAN, when a joint cannot do it; says how long it needs.
    """
    total = on_grid(duration)
    span = np.abs(end - task.start)
    shortest = np.maximum(
        1.5 * span / task.limits.velocity, np.sqrt(6 * span / task.limits.acceleration)
    )
    slowest = int(np.argmax(shortest))
    if shortest[slowest] > total * (1 + 1e-9):
        name = task.space.joint_names[slowest]
        raise PlanningFailed(
            "INVALID_MOTION_PLAN",
            f"{name} cannot move {span[slowest]:.3f} in {duration:g} s: that takes "
            f"{1.5 * span[slowest] / total:.2f} of at most {task.limits.velocity[slowest]:.2f} per "
            f"second and {6 * span[slowest] / total**2:.2f} of at most "
            f"{task.limits.acceleration[slowest]:.2f} per second squared; "
            f"give it at least {shortest[slowest]:.3f} s",
            {"joint": name, "shortest_duration": float(shortest[slowest]), "duration": duration},
        )
    return sample(task.space.joint_names, cubic_curve(task.start, end, total), total)
