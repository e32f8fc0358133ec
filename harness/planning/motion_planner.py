"""The planner's front door: free motions, joint motions and straight lines, verified."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.core.details import Details
from harness.core.errors import PlanningFailed
from harness.core.registry import registry
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.cartesian.link_motion import LinkMotions
from harness.planning.cartesian.motion_kind import ConstrainedMotion, MotionKind
from harness.planning.collision.scene import CoalScene
from harness.planning.diagnosis import explained
from harness.planning.free_motion import find_motion
from harness.planning.goals.goal_choice import choose_goals
from harness.planning.goals.goals import find_goals
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.planning.task import PlanningTask, make_task
from harness.planning.timing.limits import Limits, TimingError
from harness.planning.timing.profiles import cubic, on_grid, quintic, sample, straight_curve
from harness.planning.timing.timing import time_straight
from harness.ports.goals import PathConstraints
from harness.ports.motion_planning import CheckedGoal, MotionPlan, MotionRequest
from harness.ports.motions import (
    FreeMotion,
    JointMotion,
    LinearMotion,
    RelativeMotion,
    TimedMotion,
)
from harness.recording.motion_failures import DurationFailure

STATE_CHECKS_PER_SECOND = 200_000
"""What a second of `planning_time` is worth in state checks, on every machine.

In the scenes of MotionBenchMaker a check takes 1 to 2 microseconds on the project's machines, as
most states are certified by their neighbours: a second there buys at least twice as much.
"""


class VerifiedPlanner:
    """The port `MotionPlanner` over a scene."""

    def __init__(self, scene: CoalScene, kinematics: PinocchioKinematics) -> None:
        self.scene = scene
        self.kinematics = kinematics

    def plan(self, request: MotionRequest) -> MotionPlan:
        """Plan a motion without collision, timed and verified."""
        with explained(request, self.scene, self.kinematics):
            return self._planned(request)

    def _planned(self, request: MotionRequest) -> MotionPlan:
        match request.motion:
            case FreeMotion() as motion:
                return self._free(request, motion)
            case JointMotion() as motion:
                return self._joint(request, motion)
            case LinearMotion(goal):
                return self._links(request).linear(goal)
            case RelativeMotion(link, twist, distances):
                return self._links(request).relative(link, twist, distances)
            case TimedMotion(trajectory):
                return self._timed(request, trajectory)
            case motion:
                kind: MotionKind = registry(MotionKind.plugin_kind).find(motion.kind)()
                return kind.plan(motion, self._links(request))

    def check_goal(self, request: MotionRequest) -> CheckedGoal:
        """Explain the goal of a free motion without planning to it: each IK solution."""
        if not isinstance(request.motion, FreeMotion):
            raise TypeError("only the goal of a free motion can be checked alone")
        motion = request.motion
        with explained(request, self.scene, self.kinematics):
            task, start = self._task(request, motion.constraints), np.asarray(request.start)
            found = choose_goals(self.kinematics, task, start, motion.goal)
            return CheckedGoal(found.positions[0], found.explanation)

    def _free(self, request: MotionRequest, motion: FreeMotion) -> MotionPlan:
        task = self._task(request, motion.constraints)
        found = choose_goals(self.kinematics, task, np.asarray(request.start), motion.goal)
        explanation = found.explanation + task.lowered_margins
        try:
            if task.held is not None:
                kind: MotionKind = registry(MotionKind.plugin_kind).find("constrained")()
                constrained = ConstrainedMotion(found.positions, explanation)
                return kind.plan(constrained, LinkMotions(self.kinematics, task))
            return find_motion(task, found.positions, explanation)
        except TimingError as problem:
            raise _untimed(problem) from problem

    def _timed(self, request: MotionRequest, trajectory: JointTrajectory) -> MotionPlan:
        """Verify a motion that has its times, under the joints' whole limits."""
        task = self._task(request)
        task = replace(task, limits=_unscaled_limits(task))
        task.accept(trajectory, trajectory.positions[-1], "the motions at once")
        return MotionPlan(trajectory, Details(), task.lowered_margins)

    def _joint(self, request: MotionRequest, motion: JointMotion) -> MotionPlan:
        """Plan PTP.

        A given duration is exact to the physics' time grid, as a cubic from rest to rest, under
        the joints' whole limits; without one it is the fastest under the scaled limits.
        """
        task = self._task(request)
        start, seed = np.asarray(request.start), request.options.seed
        end = find_goals(self.kinematics, task.checker, start, motion.goal, seed).positions[0]
        if motion.duration is None:
            try:
                trajectory = time_straight(task.space.joint_names, task.start, end, task.limits)
            except TimingError as problem:
                raise _untimed(problem) from problem
        else:
            task = replace(task, limits=_unscaled_limits(task))
            trajectory = _timed_to_duration(task, end, motion.duration)
        task.accept(trajectory, end, "the direct joint motion")
        statistics = task.statistics("PTP", trajectory, [task.start, end])
        return MotionPlan(trajectory, Details.of(statistics), task.lowered_margins)

    def _task(
        self, request: MotionRequest, constraints: PathConstraints | None = None
    ) -> PlanningTask:
        return make_task(
            self.scene,
            self.kinematics.robot,
            request.group,
            request.start,
            request.options,
            constraints,
        )

    def _links(self, request: MotionRequest) -> LinkMotions:
        return LinkMotions(self.kinematics, self._task(request))


def _unscaled_limits(task: PlanningTask) -> Limits:
    whole = Limits.scaled(task.space.velocity, task.space.acceleration, 1.0, 1.0)
    return replace(whole, dynamics=task.limits.dynamics, jerk=task.limits.jerk)


def _untimed(problem: TimingError) -> PlanningFailed:
    return PlanningFailed("INVALID_MOTION_PLAN", str(problem), *problem.details)


def _timed_to_duration(task: PlanningTask, end: FloatArray, duration: float) -> JointTrajectory:
    """A cubic from rest to rest in exactly the requested duration; a quintic under a jerk limit.

    Raises:
        PlanningFailed: INVALID_MOTION_PLAN, when a joint cannot do it; names the shortest duration.
    """
    limits, total = task.limits, on_grid(duration)
    span = np.abs(end - task.start)
    is_smooth = bool(np.isfinite(limits.jerk))
    # largest rate, change and change of that of either curve from 0 to 1 in 1 s
    peaks = (15 / 8, 10 / np.sqrt(3), 60.0) if is_smooth else (1.5, 6.0, 0.0)
    shortest = np.max(
        [
            peaks[0] * span / limits.velocity,
            np.sqrt(peaks[1] * span / limits.acceleration),
            np.cbrt(peaks[2] * span / limits.jerk),
        ],
        axis=0,
    )
    slowest = int(np.argmax(shortest))
    if shortest[slowest] > total * (1 + 1e-9):
        name, way = task.space.joint_names[slowest], span[slowest]
        unit = "rad" if task.space.wraps[slowest] else "m"
        jerk = f", a jerk of {peaks[2] * way / total**3:.2f} of at most {limits.jerk:.2f} {unit}/s³"
        raise PlanningFailed(
            "INVALID_MOTION_PLAN",
            f"{name} cannot move {way:.3f} {unit} in {duration:g} s: that takes "
            f"{peaks[0] * way / total:.2f} of at most {limits.velocity[slowest]:.2f} {unit}/s"
            f" and {peaks[1] * way / total**2:.2f} of at most "
            f"{limits.acceleration[slowest]:.2f} {unit}/s²{jerk if is_smooth else ''}; "
            f"give it at least {shortest[slowest]:.3f} s",
            DurationFailure(name, float(shortest[slowest]), duration),
        )
    curve = straight_curve(task.start, end, (quintic if is_smooth else cubic)(total))
    return sample(task.space.joint_names, curve, total)
