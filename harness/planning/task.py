"""One planning call's robot, scene, start and limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.details import Details
from harness.core.errors import PlanningFailed
from harness.core.registry import registry
from harness.core.trajectory import JointTrajectory, path_length
from harness.core.types import FloatArray
from harness.planning.collision.checker import HOLD_RESOLUTION, MotionChecker
from harness.planning.collision.sampled_motion import SampledMotion
from harness.planning.collision.scene import CoalScene
from harness.planning.efforts import InverseDynamics
from harness.planning.model.robot_model import GroupSpace, RobotModel
from harness.planning.timing.limits import Limits, TimingError
from harness.planning.timing.profiles import SAMPLE_PERIOD, resting
from harness.planning.verification.path_constraints import HeldConstraints
from harness.planning.verification.verify import Defect, find_defect
from harness.ports.goals import PathConstraints
from harness.ports.motion_planning import MotionPlan, PlanningOptions
from harness.recording.explanation import LoweredMargins
from harness.recording.goal_failures import StartLimitFailure
from harness.recording.plan_statistics import PlanStatistics

START_SLACK = 0.01
"""How far outside its limit a joint may start; a motion never extends that distance [rad or m]."""


@dataclass(frozen=True, eq=False)
class PlanningTask:
    """What a planning call is about.

    Attributes:
        space: The group, the rest of the robot where it is.
        checker: The checker of states and edges, with this motion's margins.
        held: Path constraints; None where there are none.
    """

    space: GroupSpace
    checker: MotionChecker
    start: FloatArray
    limits: Limits
    options: PlanningOptions
    held: HeldConstraints | None = None

    def defect(self, trajectory: JointTrajectory, end: FloatArray) -> Defect | None:
        """What forbids a trajectory to be executed, or None."""
        return find_defect(trajectory, self.checker, self.start, end, self.limits, self.held)

    def accept(self, trajectory: JointTrajectory, end: FloatArray, what: str) -> None:
        """Let a trajectory pass that may be executed.

        Raises:
            PlanningFailed: INVALID_MOTION_PLAN, any other; `what` says of which motion.
        """
        defect = self.defect(trajectory, end)
        if defect is not None:
            raise PlanningFailed(
                "INVALID_MOTION_PLAN",
                f"{what} cannot be executed: {defect.message}",
                *defect.details,
            )

    def overload(self, path: FloatArray) -> Defect | None:
        """Where the arm cannot stand still on a path (N, dof), or None.

        After the first such path, all edges are checked for that too.
        """
        dynamics = self.limits.dynamics
        if dynamics is None or dynamics.holds_anywhere:
            return None
        states = SampledMotion.of(path, self.space.metric, HOLD_RESOLUTION).states()
        if dynamics.can_hold(states):
            return None
        self.checker.can_hold = dynamics.can_hold
        return Defect(*dynamics.standing_overload(states))

    def can_stand(self, goals: Sequence[FloatArray]) -> list[FloatArray]:
        """The goals at which the arm can stand still.

        Raises:
            TimingError: It cannot at the start, or at none of the goals.
        """
        dynamics = self.limits.dynamics
        if dynamics is None:
            return list(goals)
        if not dynamics.can_hold(self.start[None]):
            raise TimingError(*dynamics.standing_overload(self.start[None], "at the start"))
        kept = [goal for goal in goals if dynamics.can_hold(goal[None])]
        if not kept:
            raise TimingError(*dynamics.standing_overload(goals[0][None], "at the goal"))
        return kept

    @property
    def lowered_margins(self) -> Details:
        """The pairs that start nearer than their margin, for the record."""
        return Details.of(LoweredMargins(tuple(self.checker.lowered)))

    def jump(self, end: FloatArray, explanation: Details, result: Details) -> MotionPlan:
        """The plan of a motion of which only the path is requested: its start and its end."""
        ends = np.vstack([self.start, end])
        still = np.zeros_like(ends)
        times = np.array([0.0, SAMPLE_PERIOD])
        trajectory = JointTrajectory(self.space.joint_names, times, ends, still, still)
        return MotionPlan(trajectory, Details(), explanation, result)

    def stay(self, planner_id: str, explanation: Details, result: Details) -> MotionPlan:
        """The plan of a motion that ends where it starts."""
        trajectory = resting(self.space.joint_names, self.start)
        self.accept(trajectory, self.start, "standing still")
        statistics = self.statistics(planner_id, trajectory, trajectory.positions)
        return MotionPlan(trajectory, Details.of(statistics), explanation, result)

    def statistics(
        self,
        planner_id: str,
        trajectory: JointTrajectory,
        waypoints: Sequence[FloatArray] | FloatArray,
        raw: FloatArray | None = None,
    ) -> PlanStatistics:
        """Numbers of a plan for the record; `raw` has the waypoints before shortening."""
        length = path_length(np.asarray(waypoints))
        return PlanStatistics(
            planner_id,
            self.checker.checks,
            len(waypoints),
            length,
            length if raw is None else path_length(raw),
            trajectory.duration,
            None if raw is None else tuple(map(tuple, np.asarray(raw).tolist())),
        )


def make_task(
    scene: CoalScene,
    robot: RobotModel,
    group: str,
    start: FloatArray,
    options: PlanningOptions,
    constraints: PathConstraints | None = None,
) -> PlanningTask:
    """Prepare a call: `start` in description order.

    Raises:
        PlanningFailed: INVALID_GROUP_NAME, START_STATE_INVALID, START_STATE_IN_COLLISION,
            START_STATE_VIOLATES_PATH_CONSTRAINTS, INVALID_LINK_NAME.
    """
    if group not in scene.description.groups:
        known = ", ".join(scene.description.groups)
        raise PlanningFailed(
            "INVALID_GROUP_NAME", f"the robot has no group '{group}' (it has: {known})"
        )
    start = np.asarray(start, dtype=float)
    space = GroupSpace(robot, group, start)
    positions = space.part(start)
    _widen_for_start(space, positions)
    checker = MotionChecker(scene, space, positions, options.padding)
    limits = Limits.scaled(
        space.velocity, space.acceleration, options.velocity_scaling, options.acceleration_scaling
    )
    dynamics = InverseDynamics.of(space, scene.payloads())
    limits = replace(limits, jerk=options.max_jerk, dynamics=dynamics)
    held = None if constraints is None else _held(constraints, scene, space, positions)
    return PlanningTask(space, checker, positions, limits, options, held)


def _held(
    constraints: PathConstraints, scene: CoalScene, space: GroupSpace, positions: FloatArray
) -> HeldConstraints:
    """Path constraints that hold at the start.

    Raises:
        PlanningFailed: START_STATE_VIOLATES_PATH_CONSTRAINTS, when they do not; INVALID_LINK_NAME.
    """
    kind = registry("motion").find("constrained")
    held: HeldConstraints = kind.bands(constraints, space, scene.frame)
    broken = held.violation(positions)
    if broken is not None:
        raise PlanningFailed(
            "START_STATE_VIOLATES_PATH_CONSTRAINTS",
            f"the path constraints do not hold at the start: {broken.what}",
            broken.record,
        )
    return held


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
            StartLimitFailure(name, float(positions[worst]), float(outside[worst])),
        )
    space.lower = np.minimum(space.lower, positions)
    space.upper = np.maximum(space.upper, positions)
