"""Plans ways of a link: LIN, MoveRelative and those of plug-ins, each verified."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.core.amounts import amount
from harness.core.details import Details
from harness.core.errors import PlanningFailed
from harness.core.spatial import SE3
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.cartesian.line_goals import end_pose
from harness.planning.cartesian.linear_path import LinearPath, LinkPath
from harness.planning.cartesian.link_timing import (
    CARTESIAN_TOLERANCE,
    LinkRates,
    link_motion,
    time_on_path,
)
from harness.planning.cartesian.tracing import CODES, STEP_LENGTH, Trace, off_path, trace
from harness.planning.goals.goals import find_goals
from harness.planning.ik.kinematics import PinocchioKinematics, meets_tolerance
from harness.planning.task import PlanningTask
from harness.planning.timing.limits import TimingError
from harness.planning.timing.profiles import resting
from harness.ports.goals import Goal, PoseGoal
from harness.ports.motion_planning import MotionPlan
from harness.recording.explanation import Explanation, StraightResult
from harness.recording.goal_failures import IkFailure
from harness.recording.motion_failures import DeviationFailure, DistanceFailure, TraceFailure
from harness.recording.plan_statistics import RateStatistics, WayStatistics
from harness.recording.step_results import DistanceResult

RELATIVE_STEP = 0.002  # Step of a motion that goes as far as it can [m]
POSITION_DEVIATION = 1e-4  # How far the timed motion may leave its line or circle [m]
ORIENTATION_DEVIATION = 1e-3  # How far it may be turned away from where it should be [rad]


class LinkMotions:
    """Ways of a link for one planning call."""

    def __init__(self, kinematics: PinocchioKinematics, task: PlanningTask) -> None:
        self.kinematics = kinematics
        self.task = task

    def linear(self, goal: Goal) -> MotionPlan:
        """Pilz's LIN."""
        target = end_pose(self.kinematics, self.task, self.task.start, goal)
        line = LinearPath.between(target.link, self.pose(self.task.start, target.link), target.pose)
        return self.to_end(line, target, "LIN", Details())

    def to_end(
        self, path: LinkPath, target: PoseGoal, kind: str, explanation: Details
    ) -> MotionPlan:
        """The motion of a kind on a path, all the way.

        Raises:
            PlanningFailed: Something stops it, or the limits cannot be kept.
        """
        explanation = self.solutions(self.task.start, target) + explanation
        traced = self.followed(path, target, self.task.start)
        return self._timed(path, traced, kind, explanation, Details())

    def relative(self, link: str, twist: FloatArray, distances: tuple[float, float]) -> MotionPlan:
        """Task Constructor's MoveRelative: as far as possible between two distances."""
        task, (least, most) = self.task, distances
        twist = np.asarray(twist, dtype=float)
        line = LinearPath(link, self.pose(task.start, link), most * twist[:3], most * twist[3:])
        step = RELATIVE_STEP if least < most else STEP_LENGTH
        traced = trace(line, task.checker, task.start, step)
        reached = traced.share * most
        if traced.failure is not None and reached < least:
            unit, scale = ("mm", 1000.0) if np.any(twist[:3]) else ("°", float(np.degrees(1.0)))
            raise PlanningFailed(
                "PLANNING_FAILED",
                f"{link} gets {scale * reached:.1f} {unit} far, not {scale * least:.1f} {unit}: "
                f"{traced.stop}",
                DistanceFailure(reached, least),
                _stopped_at(traced, traced.failure),
            )
        explanation = task.lowered_margins + Details.of(StraightResult(traced.stop, reached))
        if not traced.reached_end:
            line = line.part(traced.share)
            traced = trace(line, task.checker, task.start, step)
            if traced.failure is not None:
                raise path_failed(line, traced, traced.failure)
        return self._timed(
            line, traced, "move_relative", explanation, Details.of(DistanceResult(reached))
        )

    def solutions(self, start: FloatArray, target: PoseGoal) -> Details:
        """The results of the inverse kinematics solutions for a path's end.

        Raises:
            PlanningFailed: Nothing free reaches it.
        """
        task = self.task
        whole = task.space.whole(start)
        found = find_goals(self.kinematics, task.checker, whole, target, task.options.seed)
        return found.explanation + task.lowered_margins

    def pose(self, positions: FloatArray, link: str) -> SE3:
        """T_world_link at group positions."""
        return self.kinematics.link_pose(self.task.space.whole(positions), link)

    def followed(self, path: LinkPath, target: PoseGoal, start: FloatArray) -> Trace:
        """A way traced to its end, which must be the target.

        Raises:
            PlanningFailed: Something stops it, or the arm's end pose is not the target's.
        """
        traced = trace(path, self.task.checker, start)
        if traced.failure is not None:
            raise path_failed(path, traced, traced.failure)
        end = self.pose(traced.positions[-1], target.link)
        if not meets_tolerance(target, end):
            shift, angle = target.pose.distance_to(end)
            space = self.task.space
            few = Explanation(
                advice=f"the {len(space.joint_names)} joints of '{space.group}' do not hold every"
                " rotation along a path: give the goal as a `position`, or turn with a `move_to`"
            )
            raise PlanningFailed(
                "NO_IK_SOLUTION",
                f"at the end of the {path.name} {target.link} is {amount(shift, 'm')} and "
                f"{amount(angle, 'rad')} from the goal",
                IkFailure(shift, angle),
                *(() if space.task_space.holds_pose else (few,)),
            )
        return traced

    def _timed(
        self,
        path: LinkPath,
        traced: Trace,
        kind: str,
        explanation: Details,
        result: Details,
    ) -> MotionPlan:
        task = self.task
        if task.options.path_only:
            return task.jump(traced.positions[-1], explanation, result)
        rates = LinkRates.of(task.options.cartesian_limits, task.options)
        trajectory = self.time(path, traced, rates)
        task.accept(trajectory, traced.positions[-1], f"the motion on the {path.name}")
        statistics = Details.of(
            task.statistics(kind, trajectory, traced.positions),
            self.check_path(path, trajectory),
            self.check_rates(path.link, trajectory, rates),
        )
        return MotionPlan(trajectory, statistics, explanation, result)

    def time(self, path: LinkPath, traced: Trace, rates: LinkRates) -> JointTrajectory:
        """A whole trace with its times.

        Raises:
            PlanningFailed: INVALID_MOTION_PLAN, when the limits cannot be kept.
        """
        names = self.task.space.joint_names
        if path.is_point:
            return resting(names, traced.positions[0])
        try:
            return time_on_path(path, traced, names, self.task.limits, rates)
        except TimingError as problem:
            raise PlanningFailed("INVALID_MOTION_PLAN", str(problem), *problem.details) from problem

    def check_path(self, path: LinkPath, trajectory: JointTrajectory) -> WayStatistics:
        """How far a trajectory's link leaves its way.

        Raises:
            PlanningFailed: INVALID_MOTION_PLAN, more than it may.
        """
        held = self.task.space.task_space
        poses = (self.pose(positions, path.link) for positions in trajectory.positions)
        shift, turn = np.max([off_path(path, pose, held) for pose in poses], axis=0).tolist()
        if shift > POSITION_DEVIATION or turn > ORIENTATION_DEVIATION:
            raise PlanningFailed(
                "INVALID_MOTION_PLAN",
                f"{path.link} would leave its {path.name} by {amount(shift, 'm')} and "
                f"{amount(turn, 'rad')}",
                DeviationFailure(shift, turn),
            )
        return WayStatistics(shift, turn)

    def check_rates(
        self, link: str, trajectory: JointTrajectory, rates: LinkRates
    ) -> RateStatistics:
        """The link's largest speeds and acceleration on a trajectory.

        Raises:
            PlanningFailed: INVALID_MOTION_PLAN, when they exceed the Cartesian limits.
        """
        motion = link_motion(trajectory, lambda positions: self.pose(positions, link))
        if (
            motion.excess(rates, turns=self.task.space.task_space.holds_pose)
            > 1 + CARTESIAN_TOLERANCE
        ):
            raise PlanningFailed(
                "INVALID_MOTION_PLAN",
                f"{link} would move at {motion.velocity:.4f} m/s (at most {rates.velocity:.4f}), "
                f"with {motion.acceleration:.4f} m/s^2 (at most {rates.acceleration:.4f}), turning "
                f"at {motion.turning:.4f} rad/s (at most {rates.turning:.4f})",
            )
        return RateStatistics(motion.velocity, motion.acceleration, motion.turning)


def path_failed(path: LinkPath, traced: Trace, failure: TraceFailure) -> PlanningFailed:
    """The failure of a way that was not followed to its end."""
    kind = {"line": "straight line", "arc": "arc"}.get(path.name, path.name)
    amount = (
        f"its {1000 * path.length:.1f} mm"
        if path.length > 1e-9
        else f"its {np.degrees(path.angle):.1f}°"
    )
    return PlanningFailed(
        CODES[failure.reason],
        f"{path.link} can follow the {kind} for {100 * traced.share:.0f} % of {amount}: "
        f"{traced.stop}",
        replace(_stopped_at(traced, failure), free_share=traced.share),
    )


def _stopped_at(traced: Trace, failure: TraceFailure) -> TraceFailure:
    """What stopped a trace, with the group's positions there."""
    return replace(failure, joint_positions=tuple(traced.positions[-1].tolist()))
