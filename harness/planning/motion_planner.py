"""Plans motions that can be trusted: goal resolved, path searched, shortened, timed, verified."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from harness.core.errors import ErrorCode, PlanningFailed
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.checker import MotionChecker, describe_touches, touch_facts
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
from harness.planning.ompl_planner import search
from harness.planning.profiles import cubic_curve, on_grid, resting, sample
from harness.planning.robot_model import GroupSpace
from harness.planning.scene import CoalScene
from harness.planning.shortening import shorten
from harness.planning.timing import (
    Limits,
    TimingError,
    time_blended,
    time_stopping,
    time_straight,
)
from harness.planning.verify import FINAL_RESOLUTION, Defect, find_defect
from harness.ports import Goal, JointGoal, MotionPlan, PlanningOptions, PoseGoal
from harness.robot.description import RobotDescription

STATE_CHECKS_PER_SECOND = 20_000
"""What a second of `planning_time` is worth in state checks, on every machine.

One check of a UR with its gripper in the lesson's world takes 20 to 25 microseconds on the
project's machines, so that a second there buys twice as much.
"""

PLANNING_RESOLUTIONS = (1 / 32, 1 / 64, 1 / 128)
"""Joint-space distance between checked states while searching [rad]; finer when a path fails."""

BLEND_DEVIATIONS = (0.05, 0.01)
"""How far the timed path may leave a corner of the checked one [rad]; then it stops there."""

LONGEST_DETOUR = 2.0
"""A straight way to a farther solution is taken only up to this many times the nearest's length."""

RELATIVE_STEP = 0.002
"""Step of a motion that goes as far as it can [m]."""

START_SLACK = 0.01
"""How far outside its limit a joint may start; it is not asked to go farther [rad or m]."""


@dataclass(frozen=True, eq=False)
class _Task:
    """One call's robot, scene and limits."""

    space: GroupSpace
    checker: MotionChecker
    start: FloatArray
    limits: Limits
    options: PlanningOptions

    def defect(self, trajectory: JointTrajectory, end: FloatArray) -> Defect | None:
        return find_defect(trajectory, self.checker, self.start, end, self.limits)


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
        straight = self._straight(task, found.positions)
        if straight is not None:
            end, trajectory = straight
            statistics = _statistics(task, "straight line", trajectory, [task.start, end])
            return MotionPlan(trajectory, statistics, _chosen(explanation, end))
        return self._searched(task, found.positions, explanation)

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
            task = replace(task, limits=self._limits(task.space, 1.0, 1.0))
            trajectory = _timed_by_hand(task, end, duration)
        self._accept(task, trajectory, end, "the straight joint motion cannot be executed")
        explanation = {"lowered_margins": list(task.checker.lowered)}
        statistics = _statistics(task, "PTP", trajectory, [task.start, end])
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

    # Parts ---------------------------------------------------------------------------------

    def _task(self, group: str, start: FloatArray, options: PlanningOptions) -> _Task:
        if group not in self.description.groups:
            known = ", ".join(self.description.groups)
            raise PlanningFailed(
                "INVALID_GROUP_NAME", f"the robot has no group '{group}' (it has: {known})"
            )
        start = np.asarray(start, dtype=float)
        space = GroupSpace(self.kinematics.robot, group, start)
        positions = space.part(start)
        _widen_for_start(space, positions)
        checker = MotionChecker(self.scene, space, positions, options.padding)
        limits = self._limits(space, options.velocity_scaling, options.acceleration_scaling)
        return _Task(space, checker, positions, limits, options)

    def _limits(self, space: GroupSpace, velocity: float, acceleration: float) -> Limits:
        return Limits.scaled(space.velocity, space.acceleration, velocity, acceleration)

    def _straight(
        self, task: _Task, goals: Sequence[FloatArray]
    ) -> tuple[FloatArray, JointTrajectory] | None:
        """A verified straight motion to the first goal that has one, or None."""
        space, checker = task.space, task.checker
        nearest = space.effort(task.start, goals[0])
        for end in goals:
            if space.effort(task.start, end) > LONGEST_DETOUR * nearest + 1e-9:
                break
            if checker.edge_free(task.start, end, FINAL_RESOLUTION):
                trajectory = time_straight(space.joint_names, task.start, end, task.limits)
                if task.defect(trajectory, end) is None:
                    return end, trajectory
        return None

    def _searched(
        self, task: _Task, goals: Sequence[FloatArray], explanation: dict[str, Any]
    ) -> MotionPlan:
        """Search, shorten, time and verify; finer when verification finds something."""
        options, checker = task.options, task.checker
        gaps: list[float] = []
        used = 0
        defect: Defect | None = None
        for attempt in range(options.attempts):
            left = options.max_state_checks
            for level, resolution in enumerate(PLANNING_RESOLUTIONS):
                seed = _derived_seed(options.seed, attempt, level)
                try:
                    result = search(
                        options.planner_id,
                        checker,
                        task.start,
                        goals,
                        resolution=resolution,
                        max_state_checks=left,
                        seed=seed,
                        parameters=options.parameters,
                    )
                except ValueError as problem:
                    raise PlanningFailed("PLANNING_FAILED", str(problem)) from problem
                used += result.checks
                left -= result.checks
                if result.waypoints is None:
                    gaps.append(result.gap)
                    break
                if checker.path_free(result.waypoints, FINAL_RESOLUTION):
                    short = shorten(result.waypoints, checker, FINAL_RESOLUTION, seed)
                    timed = self._timed(task, short)
                    if isinstance(timed, JointTrajectory):
                        statistics = _statistics(
                            task, options.planner_id, timed, short, result.waypoints
                        )
                        statistics |= {
                            "attempts": attempt + 1,
                            "search_checks": used,
                            "vertices": result.vertices,
                            "resolution": resolution,
                        }
                        return MotionPlan(timed, statistics, _chosen(explanation, short[-1]))
                    defect = timed
                if left <= 0:
                    break
        raise self._not_found(task, goals, explanation, used, gaps, defect)

    def _timed(self, task: _Task, waypoints: FloatArray) -> JointTrajectory | Defect:
        """The fastest of three ways to time a path that passes verification."""
        names, end = task.space.joint_names, waypoints[-1]
        if len(waypoints) == 2:
            trajectory = time_straight(names, waypoints[0], end, task.limits)
            return task.defect(trajectory, end) or trajectory
        for blend in BLEND_DEVIATIONS:
            try:
                trajectory = time_blended(names, waypoints, task.limits, blend)
            except TimingError:
                continue
            if task.defect(trajectory, end) is None:
                return trajectory
        trajectory = time_stopping(names, waypoints, task.limits)
        return task.defect(trajectory, end) or trajectory

    def _not_found(
        self,
        task: _Task,
        goals: Sequence[FloatArray],
        explanation: dict[str, Any],
        used: int,
        gaps: list[float],
        defect: Defect | None,
    ) -> PlanningFailed:
        if defect is not None:
            return PlanningFailed(
                "INVALID_MOTION_PLAN",
                "paths were found, but none that holds when it is checked finely: "
                + defect.message,
                {**explanation, **defect.facts},
            )
        options = task.options
        message = (
            f"no free path to the goal was found with {used} state checks "
            f"({options.attempts} of at most {options.max_state_checks})"
        )
        facts: dict[str, Any] = {**explanation, "state_checks": used}
        if gaps:
            facts["gap"] = min(gaps)
            message += f"; the search came within {min(gaps):.2f} rad of it"
        blocked = task.checker.first_block(task.start, goals[0], FINAL_RESOLUTION)
        if blocked is not None:
            share, touches = blocked
            facts["straight_way"] = {"free_share": share, "touches": touch_facts(touches)}
            message += (
                f"; the straight way is blocked after {100 * share:.0f} % by "
                f"{describe_touches(touches)}"
            )
        return PlanningFailed("PLANNING_FAILED", message, facts)

    def _line_plan(
        self, task: _Task, line: Line, traced: Trace, kind: str, explanation: dict[str, Any]
    ) -> MotionPlan:
        names, end = task.space.joint_names, traced.positions[-1]
        if line.length < 1e-9 and line.angle < 1e-9:
            trajectory = resting(names, task.start)
        else:
            options = task.options
            scaling = (options.velocity_scaling, options.acceleration_scaling)
            trajectory = time_line(line, traced, task.checker, task.limits, scaling)
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
        statistics = _statistics(task, kind, trajectory, traced.positions)
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

    def _accept(self, task: _Task, trajectory: JointTrajectory, end: FloatArray, what: str) -> None:
        defect = task.defect(trajectory, end)
        if defect is not None:
            raise PlanningFailed(
                "INVALID_MOTION_PLAN", f"{what}: {defect.message}", dict(defect.facts)
            )


def _timed_by_hand(task: _Task, end: FloatArray, duration: float) -> JointTrajectory:
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


def _widen_for_start(space: GroupSpace, positions: FloatArray) -> None:
    """Let a joint that starts a little outside its limit be there.

    Raises:
        PlanningFailed: START_STATE_INVALID, farther outside than `START_SLACK`.
    """
    outside = np.maximum(space.lower - positions, positions - space.upper)
    worst = int(np.argmax(outside))
    if outside[worst] > START_SLACK:
        name = space.joint_names[worst]
        raise PlanningFailed(
            "START_STATE_INVALID",
            f"{name} starts at {positions[worst]:.4f}, {outside[worst]:.4f} outside its limits "
            f"{space.lower[worst]:.4f} to {space.upper[worst]:.4f}",
            {"joint": name, "value": float(positions[worst]), "excess": float(outside[worst])},
        )
    space.lower = np.minimum(space.lower, positions)
    space.upper = np.maximum(space.upper, positions)


def _derived_seed(seed: int, attempt: int, level: int) -> int:
    return int(np.random.SeedSequence([seed % 2**63, attempt, level]).generate_state(1)[0])


def _chosen(explanation: dict[str, Any], end: FloatArray) -> dict[str, Any]:
    """The explanation with the solution that was taken marked."""
    solutions = explanation.get("ik_solutions")
    if not solutions:
        return explanation
    marked = [
        {**solution, "status": "chosen"}
        if np.allclose(solution["joint_positions"], end, atol=1e-9)
        else solution
        for solution in solutions
    ]
    return {**explanation, "ik_solutions": marked}


def _statistics(
    task: _Task,
    planner_id: str,
    trajectory: JointTrajectory,
    waypoints: Sequence[FloatArray] | FloatArray,
    raw: FloatArray | None = None,
) -> dict[str, Any]:
    length = _length(np.asarray(waypoints))
    return {
        "planner_id": planner_id,
        "state_checks": task.checker.checks,
        "waypoints": len(waypoints),
        "path_length": length,
        "raw_path_length": length if raw is None else _length(raw),
        "duration": trajectory.duration,
    }


def _length(waypoints: FloatArray) -> float:
    return float(np.linalg.norm(np.diff(waypoints, axis=0), axis=1).sum())
