"""What will happen, as far as it can be known without physics."""

from __future__ import annotations

from harness.engine.dry_run import DryPlanner, DrySimulator
from harness.engine.execute import execute_program
from harness.engine.program import Program, ProgramStep
from harness.ports import Kinematics, MotionPlanner, PlanningScene
from harness.recording.run import StepRecord


def predict(
    program: Program, scene: PlanningScene, kinematics: Kinematics, planner: MotionPlanner
) -> tuple[StepRecord, ...]:
    """Step records of a run in which every command comes true; a failed step does not end it."""
    execution = execute_program(
        program,
        scene,
        kinematics,
        DryPlanner(planner, kinematics, program.description),
        DrySimulator(program),
        _unwatched,
        keep_going=True,
    )
    return execution.steps


def _unwatched(kind: str, step: ProgramStep, record: StepRecord | None) -> None:
    del kind, step, record


def unexpected(record: StepRecord) -> bool:
    """Whether a predicted failure is one that the file does not expect."""
    return bool(record.error_code) and record.error_code != record.expected_error
