"""The robot cell while a program runs: what steps see and can do."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field, replace

from harness.cell.holding import Holding
from harness.cell.program import ProgramStep, step_seed, with_arm
from harness.cell.runner import Runner
from harness.cell.step import Step
from harness.core.camera import Camera
from harness.core.errors import StepFailed
from harness.core.trajectory import JointTrajectory
from harness.ports.external import ExternalSession
from harness.ports.motion_planning import MotionPlan, MotionPlanner, MotionRequest, PlanningOptions
from harness.ports.motions import PlannedMotion
from harness.recording.execution_failures import TimeoutFailure


@dataclass(kw_only=True)
class Cell(Holding):
    """Everything that steps work with: robot, planning, physics, and the state of the scene.

    Attributes:
        allowed: Pairs of bodies that `allow_collisions` around the step allows, outermost first.
    """

    planner: MotionPlanner
    runner: Runner
    allowed: list[Sequence[tuple[str, str]]] = field(
        default_factory=list[Sequence[tuple[str, str]]]
    )
    cameras: Mapping[str, Camera] = field(default_factory=dict[str, Camera])
    external: ExternalSession | None = None
    faults: dict[str, int] = field(default_factory=dict[str, int])

    @property
    def current(self) -> ProgramStep:
        """The step being executed."""
        if self.step is None:
            raise RuntimeError("no step is being executed")
        return self.step

    # -- nested steps -------------------------------------------------------------------------

    def child(self, name: str, spec: Step, summary: str) -> ProgramStep:
        """A step that the current one is made of, with a seed of its own."""
        parent = self.current
        path = f"{parent.path}.{name}"
        options = replace(parent.options, seed=step_seed(parent.options.root_seed, path))
        return ProgramStep(
            f"{parent.id}.{name}",
            path,
            spec,
            with_arm(parent.arm, summary),
            parent.line,
            options,
            arm=parent.arm,
        )

    @contextmanager
    def inside(self, step: ProgramStep) -> Generator[None]:
        """Select the arm of a step that the current one is made of."""
        current, self.step = self.step, step
        try:
            yield
        finally:
            self.step = current

    def run_children(self, children: Sequence[ProgramStep] | None = None) -> None:
        """Run the steps that the current one is made of; its own notes go on after them."""
        current, notes = self.current, self.notes
        try:
            self.runner.run(current.children if children is None else children)
        finally:
            self.step, self.notes = current, notes

    def run_parts(self, parts: Generator[ProgramStep]) -> None:
        """Run the steps that the current one is made of, each before the next is made."""
        with closing(parts):
            for part in parts:
                self.run_children([part])

    # -- motion -------------------------------------------------------------------------------

    def motion(
        self, group: str, motion: PlannedMotion, options: PlanningOptions | None = None
    ) -> MotionRequest:
        """The request of a motion from where the arm is now; the step's options by default.

        Raises:
            StepFailed: START_STATE_INVALID, when an arm that it moves holds an object together with
                another one.
        """
        self.refuse_joint_hold(self.robot.group_joints(group))
        return MotionRequest(group, self.planning_start(), motion, options or self.current.options)

    def move(
        self, group: str, motion: PlannedMotion, options: PlanningOptions | None = None
    ) -> None:
        """Plan a motion from where the arm is now and follow it; the step's options by default.

        Raises:
            PlanningFailed: There is no such motion.
            StepFailed: The motion takes longer than the step may, or the arm cannot follow it.
        """
        self.carry_out(self.planner.plan(self.motion(group, motion, options)))

    def carry_out(
        self,
        plan: MotionPlan,
        follow: Callable[[JointTrajectory], JointTrajectory] | None = None,
    ) -> None:
        """Note a plan, check it against the step's timeout, then follow it.

        Args:
            plan: A plan that starts where the arm is.
            follow: Follows the trajectory in its own way and returns what it commanded; by default
                the simulator tracks the whole.

        Raises:
            StepFailed: START_STATE_INVALID, as of `motion`; TIMED_OUT, when it takes longer than
                the step may; or the arm cannot follow it.
        """
        self.refuse_joint_hold(plan.trajectory.joint_names)
        self.notes.trajectory = plan.trajectory
        self.notes.planner += plan.statistics
        self.notes.explanation = plan.explanation
        for part in plan.result:
            self.report(part)
        timeout = self.current.spec.timeout
        if timeout is not None and plan.trajectory.duration > timeout:
            raise StepFailed(
                "TIMED_OUT",
                f"the motion takes {plan.trajectory.duration:.2f} s, the step's timeout is"
                f" {timeout:g} s; raise the timeout or the velocity scaling",
                TimeoutFailure(plan.trajectory.duration, timeout),
            )
        if self.waiting is not None:
            if follow is not None:
                raise StepFailed(
                    "INVALID_MOTION_PLAN",
                    f"`{self.current.spec.verb}` ends by what it meets, so it cannot be timed with"
                    " another motion",
                )
            self.waiting.append(plan.trajectory)
        elif follow is None:
            self.simulator.track(plan.trajectory)
        else:
            self.notes.trajectory = follow(plan.trajectory)
