"""From a scenario's path to a compiled program and the adapters it runs on."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from harness.cell.program import Program
from harness.core.errors import Problem, RobotError, SpecError
from harness.core.geometry import Mesh
from harness.engine.compile import Sources, compile_scenario
from harness.importers.imported import ImportedWorld
from harness.planning.backend import make_planning
from harness.planning.motion_planner import STATE_CHECKS_PER_SECOND
from harness.planning.planner_names import check_planner
from harness.ports import Kinematics, MotionPlanner, PlanningScene
from harness.robot.description import RobotDescription
from harness.robot.load import load_robot
from harness.spec.load import (
    SDF_SUFFIXES,
    LoadedScenario,
    Reading,
    file_path,
    load_world,
    read_scenario,
    world_path,
)
from harness.spec.source import Loc


@dataclass(frozen=True, eq=False)
class Prepared:
    """A scenario ready to be executed, checked or explained.

    Attributes:
        notes: What of the robot's and the world's files was left out or assumed.
    """

    loaded: LoadedScenario
    program: Program
    scene: PlanningScene
    kinematics: Kinematics
    planner: MotionPlanner
    notes: tuple[str, ...] = ()


def prepare(
    path: Path,
    overrides: Mapping[str, str] | None = None,
    seed: int | None = None,
    text: str | None = None,
) -> Prepared:
    """Load and compile a scenario; its text may be given instead of read.

    Raises:
        SpecError: With every problem of the file, robot and world included.
    """
    reading = read_scenario(path, overrides, seed, text)
    if reading.loaded is None:
        raise SpecError(reading.problems)
    try:
        prepared = _prepared(reading.loaded)
    except SpecError as error:
        raise SpecError(_together(reading, error.problems)) from error
    if reading.problems:
        raise SpecError(reading.problems)
    return prepared


def _together(reading: Reading, more: Sequence[Problem]) -> list[Problem]:
    """All problems, but those that may follow from another."""
    lines = {problem.line for problem in reading.problems}
    return [
        *reading.problems,
        *(
            problem
            for problem in more
            if problem.line not in lines
            and not any(f"'{word}'" in problem.message for word in reading.doubtful)
        ),
    ]


def _prepared(loaded: LoadedScenario) -> Prepared:
    problems: list[Problem] = []
    description = world = None
    try:
        description = _robot(loaded)
    except SpecError as error:
        problems += error.problems
    try:
        world = _world(loaded)
    except SpecError as error:
        problems += error.problems
    if description is None or world is None:
        raise SpecError(problems)
    scene, kinematics, planner = make_planning(description)
    sources = Sources(
        scenario=loaded.scenario,
        lines=loaded.lines,
        base_dir=loaded.path.parent,
        world=world.world,
        world_dir=world.path.parent,
        description=description,
        kinematics=kinematics,
        check_planner=check_planner,
        checks_per_second=STATE_CHECKS_PER_SECOND,
        check_mesh=_check_mesh,
    )
    notes = (*description.notes, *map(str, world.notes))
    return Prepared(loaded, compile_scenario(sources), scene, kinematics, planner, notes)


def _robot(loaded: LoadedScenario) -> RobotDescription:
    try:
        return load_robot(loaded.scenario.robot, loaded.path.parent)
    except RobotError as error:
        raise SpecError([loaded.lines.problem(_place(str(error)), str(error))]) from error


def _place(message: str) -> Loc:
    """Where the scenario says what a robot's error is about: `robot.gripper: ...`, or its robot."""
    key = re.match(r"robot\.(\w+)\b", message)
    return ("robot", key[1]) if key else ("robot",)


def _world(loaded: LoadedScenario) -> ImportedWorld:
    """The world; one that cannot be found is a mistake of the scenario's line."""
    choice, folder = loaded.scenario.world, loaded.path.parent
    try:
        if Path(choice.name).suffix.lower() in SDF_SUFFIXES:
            from harness.importers.sdf_world import load_sdf  # few scenarios have such a world

            searched = [file_path(each, folder) for each in choice.model_path]
            return load_sdf(world_path(choice.name, folder), searched)
        world = load_world(choice.name, folder)
    except SpecError as error:
        raise SpecError(
            problem
            if problem.line
            else loaded.lines.problem(("world",), problem.message, problem.hint)
            for problem in error.problems
        ) from error
    return ImportedWorld(world.model, world.path)


def _check_mesh(geometry: Mesh) -> None:
    from harness.simulation.mesh_check import check_mesh  # physics: few files have meshes

    check_mesh(geometry)
