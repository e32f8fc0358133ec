"""Takes the motions out of a scenario, and lets every planner try each of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Literal

from harness.bench.trial import Trial, try_plan
from harness.cell.program import ProgramStep, step_seed
from harness.core.errors import HarnessError
from harness.core.types import FloatArray
from harness.engine.dry_run import DryPlanner, DrySimulator
from harness.engine.execute import execute_program
from harness.planning.scene import CoalScene
from harness.ports import AnyGoal, Goal, MotionPlan, PathConstraints, PlanningOptions
from harness.recording.run import StepRecord
from harness.session.prepare import Prepared, prepare

Tell = Callable[["Motion"], None]


@dataclass(frozen=True)
class Motion:
    """A motion of a scenario, and what came of planning it.

    Attributes:
        file: As the user named it.
        step: Its id, else its path.
        summary: In one line.
        line: In the file, from 1.
        trials: One for each planner and seed, planners outermost; only one where the straight way
            is free.
    """

    file: str
    step: str
    summary: str
    line: int
    trials: tuple[Trial, ...]

    @property
    def is_searched(self) -> bool:
        """Whether a planner had to search: not when the straight way is free."""
        return any(trial.error_code or not trial.is_straight for trial in self.trials)


def collect(
    path: Path,
    planners: Sequence[str],
    seeds: Sequence[int],
    tell: Tell,
    *,
    overrides: Mapping[str, str] | None = None,
) -> list[Motion]:
    """Plan every free motion (`move_to`) of a scenario with every planner and seed.

    No physics: each motion starts where the one before it ends, at the goal's nearest solution,
    whatever the planners made of it. Lines, arcs and joint motions are followed, not compared, and
    so are motions with path constraints, which have a planner of their own.

    Args:
        path: The scenario.
        planners: `planner_id`s.
        seeds: Of the scenario; `harness run --seed` plans the same motions.
        tell: Told of each motion when it is done.
        overrides: Dotted path in the file -> new value, as YAML text.

    Raises:
        SpecError: With every problem of the file.
    """
    prepared = prepare(path, overrides)
    bench = _BenchPlanner(prepared, str(path), planners, seeds, tell)
    simulator = DrySimulator(prepared.program)

    def watch(
        kind: Literal["step_started", "step_finished"],
        step: ProgramStep,
        record: StepRecord | None,
    ) -> None:
        simulator.watch(kind, step, record)
        bench.on_step(kind, step)

    execute_program(
        prepared.program,
        prepared.scene,
        prepared.kinematics,
        bench,
        simulator,
        watch,
        keep_going=True,
    )
    return bench.motions


class _BenchPlanner(DryPlanner):
    """Tries all planners on a motion, then jumps to its goal as a dry run does."""

    def __init__(
        self,
        prepared: Prepared,
        file: str,
        planners: Sequence[str],
        seeds: Sequence[int],
        tell: Tell,
    ) -> None:
        super().__init__(prepared.planner, prepared.program.description)
        if not isinstance(prepared.scene, CoalScene):
            raise HarnessError("clearances are measured in Coal's planning scene alone")
        self.motions: list[Motion] = []
        self._real = prepared.planner
        self._scene = prepared.scene
        self._file, self._planners, self._seeds, self._tell = file, planners, seeds, tell
        self._step: ProgramStep | None = None

    def on_step(self, kind: str, step: ProgramStep) -> None:
        """Remember which step is planned for."""
        if kind == "step_started":
            self._step = step

    def plan(
        self,
        group: str,
        start: FloatArray,
        goal: Goal | AnyGoal,
        options: PlanningOptions,
        constraints: PathConstraints | None = None,
    ) -> MotionPlan:
        # first the goal, so that one that cannot be had counts against no planner
        jump = super().plan(group, start, goal, options, constraints)
        step = self._step
        if step is None or step.spec.verb != "move_to" or constraints is not None:
            return jump
        trials: list[Trial] = []
        for planner, seed in product(self._planners, self._seeds):
            asked = replace(options, planner_id=planner, seed=step_seed(seed, step.path))
            trial = try_plan(self._real, self._scene, group, start, goal, asked, seed)
            trials.append(trial)
            if trial.is_straight:
                break  # no planner is asked, whichever it is
        motion = Motion(self._file, step.id, step.summary, step.line, tuple(trials))
        self.motions.append(motion)
        self._tell(motion)
        return jump
