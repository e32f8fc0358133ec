"""From a scenario's path to a compiled program and the adapters it runs on."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from harness.cell.program import Program
from harness.core.errors import Problem, RobotError, RobotOptionError, SpecError
from harness.judging.observations import Observations, merged
from harness.judging.placed import PlacedExpectation, as_expectation
from harness.language.files.source import Source
from harness.language.reading.load import (
    LoadedScenario,
    Reading,
    file_path,
    is_foreign_world,
    load_world,
    read_scenario,
    world_path,
)
from harness.language.reading.partial import STAND_IN_ROBOT, Prerequisite
from harness.language.scenario import RobotSpec
from harness.planning.backend import make_planning
from harness.ports.motion_planning import PlanningPorts
from harness.recording.run import Finding
from harness.robot.collision_shapes import parts_notes
from harness.robot.description import RobotDescription
from harness.robot.load import load_robot, load_scenario_robot
from harness.session.compile import Sources, compile_scenario
from harness.session.observation.findings import about_file
from harness.world.imported import ImportedWorld
from harness.world.world_format import read_foreign_world

ROBOT: frozenset[Prerequisite] = frozenset({"robot"})
WORLD: frozenset[Prerequisite] = frozenset({"world"})


@dataclass(frozen=True, eq=False)
class Prepared:
    """A scenario ready to be executed, checked or explained.

    Attributes:
        expectations: What will be judged, in file order.
        notes: What of the robot's and the world's files was left out or assumed.
        about_file: What the scenario file allows and probably does not intend.
    """

    loaded: LoadedScenario
    program: Program
    ports: PlanningPorts
    expectations: tuple[PlacedExpectation, ...] = ()
    notes: tuple[str, ...] = ()
    about_file: tuple[Finding, ...] = ()

    @cached_property
    def observations(self) -> Observations:
        """Everything that the expectations read of a run, the ends of steps included."""
        ends = (end for step in self.program.all_steps() for end in step.spec.ends())
        specs = (*(each.spec for each in self.expectations), *map(as_expectation, ends))
        return merged(spec.observations() for spec in specs)

    @property
    def observed_links(self) -> list[str]:
        """Links whose poses the expectations read, and the TCPs of all arms but the first."""
        robot = self.program.description
        tips = {arm.tcp_link for arm in robot.arms[1:]}
        links = set(robot.link_names)
        return [name for name in self.observations.frames | tips if name in links]


def prepare(
    path: Path,
    overrides: Mapping[str, str] | None = None,
    seed: int | None = None,
    text: str | Source | None = None,
    inspect: Callable[[LoadedScenario], None] | None = None,
) -> Prepared:
    """Load and compile a scenario; its text may be given instead of read.

    Args:
        inspect: Called with the scenario before its robot, world and meshes are read.

    Raises:
        SpecError: With every problem of the file, robot and world included.
    """
    reading = read_scenario(path, overrides, seed, text)
    if reading.loaded is None:
        raise SpecError(reading.problems)
    if inspect is not None:
        inspect(reading.loaded)
    try:
        prepared = _prepared(reading.loaded, reading)
    except SpecError as error:
        problems = _together(reading, error.problems)
        raise SpecError(_with_notes(problems, reading.loaded.notes)) from error
    return prepared


def _with_notes(problems: Sequence[Problem], notes: Sequence[Problem]) -> list[Problem]:
    """The problems, those in a place of which there is a note with the note's hint."""
    hints = {(note.path, note.line, note.column): note.hint for note in notes}
    return [
        replace(problem, hint="; ".join(filter(None, (hint, problem.hint))))
        if (hint := hints.get((problem.path, problem.line, problem.column)))
        else problem
        for problem in problems
    ]


def _together(reading: Reading, more: Sequence[Problem]) -> list[Problem]:
    """All problems; of those at one place only the first, from which others may follow."""
    places = {(problem.path, problem.line, problem.column) for problem in reading.problems}
    rest = (each for each in more if (each.path, each.line, each.column) not in places)
    return [*reading.problems, *rest]


def _prepared(loaded: LoadedScenario, reading: Reading) -> Prepared:
    problems: list[Problem] = []
    missing: frozenset[Prerequisite] = reading.missing
    try:
        description = _robot(loaded)
    except SpecError as error:
        problems += error.problems
        missing |= ROBOT
        description = load_robot(RobotSpec(model=STAND_IN_ROBOT), loaded.path.parent)
    try:
        world = _world(loaded)
    except SpecError as error:
        problems += error.problems
        missing |= WORLD
        empty = load_world("empty", loaded.path.parent)
        world = ImportedWorld(empty.model, empty.path)
    ports = make_planning(description)
    sources = Sources(
        loaded=loaded,
        world=world,
        description=description,
        kinematics=ports.kinematics,
        missing=missing,
        doubtful=reading.doubtful,
        is_broken=bool(reading.problems),
    )
    notes = (*description.notes, *map(str, world.notes))
    try:
        program = compile_scenario(sources)
    except SpecError as error:
        raise SpecError([*problems, *error.problems]) from error
    if problems or reading.problems:
        raise SpecError(problems)
    added = (*program.world.objects, *program.later_objects.values())
    notes += parts_notes({obj.name: obj.shapes for obj in added})
    placed = tuple(
        PlacedExpectation.of(item.spec, item.step, item.line) for item in program.expectations
    )
    about = about_file(program, loaded.notes)
    return Prepared(loaded, program, ports, placed, notes, about)


def _robot(loaded: LoadedScenario) -> RobotDescription:
    try:
        return load_scenario_robot(loaded.scenario, loaded.path.parent)
    except RobotOptionError as error:
        loc = (error.below, *error.key.split(".")[: 1 if error.below == "robot" else 2])
        raise SpecError([loaded.lines.problem(loc, str(error))]) from error
    except RobotError as error:
        loc = (loaded.scenario.robot_key,)
        raise SpecError([loaded.lines.problem(loc, str(error))]) from error


def _world(loaded: LoadedScenario) -> ImportedWorld:
    """The world; one that cannot be found is a mistake of the scenario's line."""
    choice, folder = loaded.scenario.world, loaded.path.parent
    try:
        if is_foreign_world(choice.name):
            searched = [file_path(each, folder) for each in choice.model_path]
            foreign = read_foreign_world(world_path(choice.name, folder), searched)
            if foreign is not None:
                objects = loaded.scenario.objects
                foreign.refuse_unusable({spec.name for spec in objects if spec.replace})
                return foreign
        world = load_world(choice.name, folder)
    except SpecError as error:
        raise SpecError(
            problem
            if problem.line
            else loaded.lines.problem(("world",), problem.message, problem.hint)
            for problem in error.problems
        ) from error
    return ImportedWorld(world.model, world.path)
