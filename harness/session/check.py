"""What can be said of a scenario without physics: its problems, and what will fail."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from harness.assertions.wording import describe
from harness.cell.program import Program
from harness.core.errors import Problem, SpecError
from harness.engine.explain import explain
from harness.engine.predict import predict, predict_with_poses, touches_at_start, unexpected
from harness.ports import Touch
from harness.reporting.explanation import explanation_lines
from harness.session.prepare import prepare
from harness.spec.source import Loc


@dataclass(frozen=True)
class CheckResult:
    """What a check found.

    Attributes:
        title: The scenario's; its file name when it cannot be read.
        problems: Mistakes of the file.
        predicted: Steps that will fail though the file does not expect it, each at its line.
        explanations: Of each of them, a line a stage; empty where there is nothing to add.
        steps: How many steps there are.
        notes: What of the robot's and the world's files was left out or assumed.
    """

    title: str
    problems: tuple[Problem, ...] = ()
    predicted: tuple[Problem, ...] = ()
    explanations: tuple[tuple[str, ...], ...] = ()
    steps: int = 0
    notes: tuple[str, ...] = ()


def check_file(
    path: Path, *, overrides: Mapping[str, str] | None = None, seed: int | None = None
) -> CheckResult:
    """Read, compile, and look for goals that are out of reach or in collision."""
    try:
        prepared = prepare(path, overrides, seed)
    except SpecError as error:
        return CheckResult(path.name, problems=tuple(error.problems))
    program = prepared.program
    touches = touches_at_start(program, prepared.scene)
    records = predict(program, prepared.scene, prepared.kinematics, prepared.planner)
    predicted: dict[Problem, tuple[str, ...]] = {}
    for record in unexpected(records):
        said = f"{record.error_code}: {record.message}"
        problem = prepared.loaded.lines.problem(_loc(program, record.path), said)
        predicted.setdefault(problem, explanation_lines(record.explanation, record.message))
    return CheckResult(
        program.title,
        predicted=tuple(predicted),
        explanations=tuple(predicted.values()),
        steps=len(program.steps),
        notes=(*prepared.notes, *map(_told, touches)),
    )


def _told(touch: Touch) -> str:
    depth = -1000 * touch.distance
    return f"where the robot starts, {touch.first} and {touch.second} touch ({depth:.1f} mm deep)"


def _loc(program: Program, path: str) -> Loc:
    """Where a step stands in the file; what a composite step expands to stands where that does."""
    while path not in program.step_locs and "." in path:
        path = path.rpartition(".")[0]
    return program.step_locs.get(path, ("steps",))


def explain_file(
    path: Path, *, overrides: Mapping[str, str] | None = None, seed: int | None = None
) -> str:
    """The program as text: every number resolved, composite steps expanded.

    Raises:
        SpecError: With every problem of the file.
    """
    prepared = prepare(path, overrides, seed)
    program = prepared.program
    records, poses = predict_with_poses(
        program, prepared.scene, prepared.kinematics, prepared.planner
    )
    return explain(program, records, poses, describe)
