"""Extract the motions of a scenario and plan each of them with every planner."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

from harness.cell.program import ProgramStep, step_seed
from harness.core.activity import Activity, unobserved
from harness.core.errors import HarnessError
from harness.planning.collision.scene import CoalScene
from harness.plugins.campaigns.bench.planner_choice import with_planner
from harness.plugins.campaigns.bench.trial import Trial, try_plan
from harness.ports.motion_planning import MotionPlan, MotionRequest
from harness.ports.motions import FreeMotion
from harness.recording.step_record import StepRecord
from harness.session.dry_run import DryPlanner, DrySimulator
from harness.session.execute import ProgramExecution
from harness.session.prepare import Prepared, prepare

OnMotion = Callable[["MotionTrials"], None]


@dataclass(frozen=True)
class MotionTrials:
    """A motion of a scenario with its planning trials.

    Attributes:
        step: The step's id, or its path if it has no id.
        trials: One trial for each planner and seed, planners outermost; a single trial when the
            direct joint motion is free.
    """

    file: str
    step: str
    summary: str
    line: int
    trials: tuple[Trial, ...]

    @property
    def is_searched(self) -> bool:
        """Whether a planner had to search, because the straight line is not free."""
        return any(trial.error_code or not trial.is_straight for trial in self.trials)


def collect(
    path: Path,
    planners: Sequence[str],
    seeds: Sequence[int],
    on_motion: OnMotion,
    *,
    overrides: Mapping[str, str] | None = None,
    on_trial: Activity = unobserved,
) -> list[MotionTrials]:
    """Plan every free motion (`move_to`) of a scenario with every planner and seed.

    There is no physics: each motion starts where the previous one ends, at the goal's nearest
    solution, independent of the planners' results. Lines, arcs and joint motions are followed but
    not compared; so are motions with path constraints, which have their own planner.

    Args:
        planners: Planners of `ompl`, names of pipelines, or `PIPELINE/PLANNER`.
        seeds: Scenario seeds; `harness run --seed` plans the same motions.
        on_motion: Called with each motion when its trials are complete.
        overrides: Dotted path in the file -> new value, as YAML text.
        on_trial: Called before each trial.

    Raises:
        SpecError: The file has problems; the error holds all of them.
    """
    prepared = prepare(path, overrides)
    bench = _BenchPlanner(prepared, str(path), planners, seeds, on_motion, on_trial)
    simulator = DrySimulator(prepared.program, prepared.ports.scene)

    def watch(step: ProgramStep, record: StepRecord | None) -> None:
        simulator.watch(step, record)
        bench.step = step if record is None else bench.step

    program, ports = prepared.program, prepared.ports._replace(planner=bench)
    ProgramExecution(program, ports, simulator, watch, keep_going=True).run(program.steps)
    return bench.motions


class _BenchPlanner(DryPlanner):
    """Plans a motion with all planners, then jumps to its goal as a dry run does."""

    def __init__(
        self,
        prepared: Prepared,
        file: str,
        planners: Sequence[str],
        seeds: Sequence[int],
        on_motion: OnMotion,
        on_trial: Activity,
    ) -> None:
        super().__init__(prepared.ports.planner, prepared.program.description)
        if not isinstance(prepared.ports.scene, CoalScene):
            raise HarnessError("clearances can be measured only in Coal's planning scene")
        self.motions: list[MotionTrials] = []
        self._real = prepared.ports.planner
        self._scene = prepared.ports.scene
        self._file, self._planners, self._seeds = file, planners, seeds
        self._on_motion, self._on_trial = on_motion, on_trial
        self.step: ProgramStep | None = None  # the one that began last

    def plan(self, request: MotionRequest) -> MotionPlan:
        # the goal comes first, so that an unreachable one counts against no planner
        jump, motion, step = super().plan(request), request.motion, self.step
        if step is None or not isinstance(motion, FreeMotion) or motion.constraints is not None:
            return jump
        trials: list[Trial] = []
        total = len(self._planners) * len(self._seeds)
        for planner, seed in product(self._planners, self._seeds):
            self._on_trial(f"planning {step.id}", len(trials), total)
            chosen = with_planner(request.options, planner)
            chosen = replace(chosen, seed=step_seed(seed, step.path))
            one = replace(request, options=chosen)
            trial = try_plan(self._real, self._scene, one, planner, seed)
            trials.append(trial)
            if trial.is_straight:
                break  # a free straight line needs no search, with any planner
        motion = MotionTrials(self._file, step.id, step.summary, step.line, tuple(trials))
        self.motions.append(motion)
        self._on_motion(motion)
        return jump
