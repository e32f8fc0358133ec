"""From a scenario's path to a compiled program and the adapters it runs on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from harness.assertions.judge import EXECUTED
from harness.core.errors import RobotError, SpecError
from harness.engine.compile import Sources, compile_scenario
from harness.engine.program import Program
from harness.planning.backend import make_planning
from harness.planning.motion_planner import STATE_CHECKS_PER_SECOND
from harness.planning.planner_names import resolve_planner_id
from harness.ports import Kinematics, MotionPlanner, PlanningScene
from harness.robot.description import RobotDescription
from harness.robot.load import load_robot
from harness.spec.load import LoadedScenario, LoadedWorld, load_scenario, load_world


@dataclass(frozen=True, eq=False)
class Prepared:
    """A scenario ready to be executed, checked or explained."""

    loaded: LoadedScenario
    program: Program
    scene: PlanningScene
    kinematics: Kinematics
    planner: MotionPlanner


def prepare(
    path: Path, overrides: Mapping[str, str] | None = None, seed: int | None = None
) -> Prepared:
    """Load and compile a scenario.

    Raises:
        SpecError: With every problem of the file, robot and world included.
    """
    loaded = load_scenario(path, overrides, seed)
    description = _robot(loaded)
    scene, kinematics, planner = make_planning(description)
    world = _world(loaded)
    sources = Sources(
        scenario=loaded.scenario,
        lines=loaded.lines,
        base_dir=loaded.path.parent,
        world=world.world,
        world_dir=world.path.parent,
        description=description,
        kinematics=kinematics,
        judged=EXECUTED,
        check_planner=resolve_planner_id,
        checks_per_second=STATE_CHECKS_PER_SECOND,
    )
    return Prepared(loaded, compile_scenario(sources), scene, kinematics, planner)


def _robot(loaded: LoadedScenario) -> RobotDescription:
    try:
        return load_robot(loaded.scenario.robot, loaded.path.parent)
    except RobotError as error:
        raise SpecError([loaded.lines.problem(("robot",), str(error))]) from error


def _world(loaded: LoadedScenario) -> LoadedWorld:
    """The world; one that cannot be found is a mistake of the scenario's line."""
    try:
        return load_world(loaded.scenario.world, loaded.path.parent)
    except SpecError as error:
        raise SpecError(
            problem
            if problem.line
            else loaded.lines.problem(("world",), problem.message, problem.hint)
            for problem in error.problems
        ) from error
