"""The motion planner: finds motions that are timed and verified."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

from harness.core.details import Details
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.ports.goals import AnyGoal, Goal
from harness.ports.kinematics import Kinematics
from harness.ports.motions import PILZ_LIMITS, CartesianLimits, PlannedMotion
from harness.ports.scene import PlanningScene

DEFAULT_PIPELINE = "ompl"


@dataclass(frozen=True)
class PlanningOptions:
    """How to plan; every number known.

    Attributes:
        pipeline: The planning pipeline, a plug-in of the kind `planner`.
        planner_id: A planner of the pipeline; of `ompl`: `auto`, or OMPL's or MoveIt's name.
        max_state_checks: Budget of state validity checks for one attempt.
        attempts: Plans tried, each with a seed of its own.
        velocity_scaling: The share of the joint velocity limits, (0, 1].
        acceleration_scaling: The share of the joint acceleration limits, (0, 1].
        padding: Distance kept between robot (and what it holds) and every object, and between arms
            [m].
        seed: The seed of this step.
        root_seed: The seed that the seeds of nested steps follow from.
        parameters: The parameters of the planner: `range`, `goal_bias` ...
        max_jerk: The max jerk of every joint [rad/s^3 or m/s^3]; inf for none.
        cartesian_limits: The cartesian limits of the link, on lines and arcs.
        path_only: Leave out the times: the plan jumps from its start to its end.
        is_explained: Explain a failure, which takes longer than many plans.
    """

    pipeline: str = DEFAULT_PIPELINE
    planner_id: str = "auto"
    max_state_checks: int = 2_000_000
    attempts: int = 1
    velocity_scaling: float = 1.0
    acceleration_scaling: float = 1.0
    padding: float = 0.0
    seed: int = 0
    root_seed: int = 0
    parameters: Mapping[str, float] = field(default_factory=dict[str, float])
    max_jerk: float = float("inf")
    cartesian_limits: CartesianLimits = PILZ_LIMITS
    path_only: bool = False
    is_explained: bool = True


@dataclass(frozen=True, eq=False)
class MotionPlan:
    """A motion that was found, timed and verified.

    Attributes:
        trajectory: The trajectory to be commanded.
        statistics: Its numbers; `harness.recording.plan_statistics` has the parts.
        explanation: IK solutions and their results, pairs whose margin was lowered ...
        result: What the step reports of it: the fraction reached, a distance ...
    """

    trajectory: JointTrajectory
    statistics: Details
    explanation: Details
    result: Details = field(default_factory=Details)


@dataclass(frozen=True, eq=False)
class CheckedGoal:
    """A goal that can be reached.

    Attributes:
        positions: The group positions of the free solution that is tried first, shape (dof,).
        explanation: The solutions of inverse kinematics, and what rules each of them out.
    """

    positions: FloatArray
    explanation: Details


@dataclass(frozen=True, eq=False)
class MotionRequest:
    """What a motion planner must plan.

    Attributes:
        start: The start positions of all movable joints, in description order.
        motion: The kind of motion, and where it goes.
    """

    group: str
    start: FloatArray
    motion: PlannedMotion
    options: PlanningOptions

    @property
    def goal(self) -> Goal | AnyGoal | None:
        """Where the motion ends; None for one that has no goal of its own."""
        return getattr(self.motion, "goal", None)


class MotionPlanner(Protocol):
    """Finds motions of a group that can be trusted, or raises PlanningFailed and says why."""

    def plan(self, request: MotionRequest, /) -> MotionPlan:
        """Plan a motion without collision, timed and verified."""
        ...

    def check_goal(self, request: MotionRequest, /) -> CheckedGoal:
        """Explain the goal of a free motion without planning to it: each IK solution.

        Raises:
            PlanningFailed: NO_IK_SOLUTION, GOAL_IN_COLLISION ...
        """
        ...


class PlanningPorts(NamedTuple):
    """A planning scene, and the kinematics and the motion planner that work with it."""

    scene: PlanningScene
    kinematics: Kinematics
    planner: MotionPlanner
