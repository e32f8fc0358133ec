"""What can be said of a scenario without stepping the physics: its problems, what will fail."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from harness.cell.program import Program
from harness.core.errors import Problem, SpecError
from harness.core.geometry import bounding_radius
from harness.core.world import WorldObject
from harness.language.files.source import Loc
from harness.language.reading.load import LoadedScenario
from harness.language.reading.varied_paths import as_json, choices
from harness.ports.scene import Touch
from harness.recording.execution_failures import NotHeldFailure
from harness.reporting.explanation import explanation_lines
from harness.session.predict import predict, touches_at_start, unexpected
from harness.session.prepare import prepare
from harness.session.start import overlap_note, start_physics
from harness.steps.grasp import Grasp
from harness.steps.pick import Pick

MOST_CHOICES = 20  # words of one `randomize` that are tried in turn; each takes half a second


@dataclass(frozen=True)
class CheckResult:
    """What a check found.

    Attributes:
        title: The scenario's; its file name when it cannot be read.
        predicted: Steps that will fail though the file does not expect it, each at its line.
        explanations: The explanations of each of them, a line a stage; empty where there is nothing
            to add.
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
    from harness.simulation.mujoco_simulator import MujocoSimulator  # loads MuJoCo

    try:
        prepared = prepare(path, overrides, seed)
        overlaps = start_physics(prepared, MujocoSimulator).overlaps_at_start
    except SpecError as error:
        return CheckResult(path.name, problems=tuple(error.problems))
    problems = _problems_of_choices(prepared.loaded, path, overrides, seed)
    program = prepared.program
    touches = touches_at_start(program, prepared.ports.scene)
    records, _ = predict(program, prepared.ports)
    predicted: dict[Problem, tuple[str, ...]] = {}
    specs = {step.path: step.spec for step in program.all_steps()}
    not_taken, brought = set[str](), _brought(program.world.objects)
    known = [{each.first, each.second} for each in overlaps]
    for record in unexpected(records):
        spec = specs.get(record.path)
        if isinstance(spec, Pick | Grasp):
            not_taken.add(spec.object)
            if spec.object in brought and not getattr(spec, "track", False):
                continue
        missing = record.explanation.find(NotHeldFailure)
        if missing is not None and missing.not_held in not_taken:
            continue  # it follows from the pick that is reported
        said = f"{record.error_code}: {record.message}"
        problem = prepared.loaded.lines.problem(_loc(program, record.path), said)
        predicted.setdefault(problem, explanation_lines(record.explanation, record.message))
    return CheckResult(
        program.title,
        problems=problems,
        predicted=tuple(predicted),
        explanations=tuple(predicted.values()),
        steps=len(program.steps),
        notes=(
            *(finding.message for finding in prepared.about_file),
            *prepared.notes,
            *(overlap_note(prepared, touch) for touch in overlaps),
            *(_touch_note(each) for each in touches if {each.first, each.second} not in known),
        ),
    )


def _brought(objects: Sequence[WorldObject]) -> set[str]:
    """The objects on or near a belt or a turntable, which may bring them elsewhere."""
    return {
        each.name
        for belt in objects
        for each in objects
        if belt.surface_motion is not None
        and each.pose.distance_to(belt.pose)[0] < max(map(bounding_radius, belt.shapes))
    }


def _problems_of_choices(
    loaded: LoadedScenario, path: Path, overrides: Mapping[str, str] | None, seed: int | None
) -> tuple[Problem, ...]:
    """Mistakes of the words that `randomize` chooses among: names that nothing has."""
    found: dict[Problem, None] = {}
    for values in choices(loaded.written)[:MOST_CHOICES]:
        chosen = {each.path: as_json(each.value.plain()) for each in values}
        try:
            prepare(path, {**chosen, **(overrides or {})}, seed)
        except SpecError as error:
            found.update(dict.fromkeys(error.problems))
    return tuple(found)


def _touch_note(touch: Touch) -> str:
    depth = f"{-1000 * touch.distance:.1f} mm deep"
    return f"where the robot starts, {touch.first} and {touch.second} touch ({depth})"


def _loc(program: Program, path: str) -> Loc:
    """Where a step stands in the file; what a composite step expands to stands where that does."""
    while path not in program.step_locs and "." in path:
        path = path.rpartition(".")[0]
    return program.step_locs.get(path, ("steps",))
