"""Compiles a scenario: looks up every name, and finds all problems of the file at once."""

from __future__ import annotations

import math
from collections.abc import Generator, Iterable, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.cell.program import Program, ProgramExpectation, ProgramStep, with_arm
from harness.cell.program_part import resolved_parts
from harness.cell.scope import At, Problems, Scope
from harness.cell.step import Step, as_step
from harness.core.errors import RobotError
from harness.core.geometry import Mesh
from harness.core.spatial import SE3
from harness.core.world import MOST_OBJECTS, WorldObject
from harness.judging.placed import as_expectation, check_expectation
from harness.language.expectation import ExpectationFields
from harness.language.files.source import Loc
from harness.language.planning import Planning
from harness.language.reading.load import LoadedScenario
from harness.language.reading.partial import Prerequisite
from harness.language.step import Block, StepFields
from harness.language.world import ObjectSpec
from harness.planning.motion_planner import STATE_CHECKS_PER_SECOND
from harness.planning.search.find_pipeline import check_planner
from harness.ports.kinematics import Kinematics
from harness.ports.motion_planning import PlanningOptions
from harness.robot.description import RobotDescription
from harness.session.cameras import all_cameras
from harness.session.options import check_planning, merged_options
from harness.world.imported import ImportedWorld
from harness.world.objects import ObjectUnusableError, resolve_object, resolve_world

MOST_STEPS = 10_000  # a file of more is a mistake, and would fill the memory
RESERVED = {
    "robot": "every link",
    "gripper": "its fingers and palm",
    "any": "every link and object",
    "tcp": "the tool centre point",
}
"""Names that no object may have, and what expectations mean by them."""


@dataclass(frozen=True, eq=False)
class Sources:
    """What compile works on, all of it loaded.

    Attributes:
        missing: What could not be loaded; something stands in for it, and problems that it decides
            are not reported.
        doubtful: Names in what could not be read; problems with them may follow from that.
        is_broken: Whether parts of the file cannot be read, so that models lack fields.
    """

    loaded: LoadedScenario
    world: ImportedWorld
    description: RobotDescription
    kinematics: Kinematics
    missing: frozenset[Prerequisite] = frozenset()
    doubtful: frozenset[str] = frozenset()
    is_broken: bool = False


def compile_scenario(sources: Sources) -> Program:
    """Resolve everything a scenario names.

    Raises:
        SpecError: With every problem found, each at its place in the file.
    """
    return _Compiler(sources).compile()


class _Compiler:
    def __init__(self, sources: Sources) -> None:
        self.sources = sources
        self.problems = Problems(sources.loaded.lines, sources.missing, sources.doubtful)
        self.scope = Scope(sources.description, self.problems, sources.kinematics.link_pose)
        self.later: dict[str, WorldObject] = {}
        self.object_specs: dict[str, ObjectSpec] = {}  # of the start and of steps, without poses
        self.step_locs: dict[str, Loc] = {}
        self.object_locs: dict[str, Loc] = {}
        self.expectations: list[ProgramExpectation] = []
        self.pending: list[tuple[ExpectationFields, Loc, str]] = []

    def compile(self) -> Program:
        sources, scenario = self.sources, self.sources.loaded.scenario
        objects = self._objects_at_start()
        for obj in objects:
            self.scope.add_object(obj, present=True)
        self.scope.gravity = math.hypot(*sources.world.world.physics.gravity)
        self.scope.cameras = all_cameras(
            sources.description.cameras,
            sources.world.world.cameras,
            scenario.cameras,
            self.problems,
        )
        check_planning(scenario.planning, ("planning",), self.problems, check_planner)
        steps = self._steps(scenario.steps, ("steps",), "steps")
        for index, expectation in enumerate(scenario.expect):
            self._expectation(expectation, ("expect", index), "")
        for expectation, loc, step in self.pending:
            with self._gaps_allowed():
                check_expectation(as_expectation(expectation), loc, self.scope, step)
        parts = resolved_parts(scenario, self.scope)
        if len(objects) + len(self.later) > MOST_OBJECTS:
            self.problems.add(
                ("objects",) if scenario.objects else ("world",),
                f"there are {len(objects) + len(self.later)} objects; a scene may have"
                f" {MOST_OBJECTS}",
            )
        self.problems.raise_if_any()
        return Program(
            title=scenario.scenario,
            description=sources.description,
            world=resolve_world(sources.world.world, objects),
            later_objects=self.later,
            steps=steps,
            expectations=tuple(self.expectations),
            seed=scenario.seed,
            step_locs=self.step_locs,
            object_locs=self.object_locs,
            cameras=self.scope.cameras,
            parts=parts,
        )

    @contextmanager
    def _gaps_allowed(self, name: str = "") -> Generator[None]:
        """Skip the rest of what uses a model that lacks what cannot be read of the file.

        Args:
            name: The name of an object; problems with it may follow from that.
        """
        try:
            yield
        except Exception:  # a class relies on its validators, which have not run
            if not self.sources.is_broken:
                raise
            self.problems.add_unusable(name)

    # -- objects ------------------------------------------------------------------------------

    def _objects_at_start(self) -> tuple[WorldObject, ...]:
        world, scenario = self.sources.world.world, self.sources.loaded.scenario
        resolved = self._world_objects()
        here: set[str] = set()
        for index, spec in enumerate(scenario.objects):
            loc: Loc = ("objects", index)
            if spec.name in here:
                self.problems.add(
                    (*loc, "name"),
                    f"another object is called '{spec.name}'",
                    "every object has a name of its own",
                    needs=(),
                )
            elif spec.name in resolved and not spec.replace:
                self.problems.add(
                    (*loc, "name"),
                    f"the world '{world.world}' has an object '{spec.name}' already",
                    "say `replace: true` to put this one in its place",
                    needs=("world",),
                )
            elif spec.name not in resolved and spec.replace:
                self.problems.unknown(
                    (*loc, "name"), "object of the world", spec.name, resolved, needs=("world",)
                )
            here.add(spec.name)
            self.object_specs.setdefault(spec.name, _without_pose(spec))
            with self._gaps_allowed(spec.name):
                objects = self._resolve(spec, loc, self._start_pose(spec, loc, resolved))
                if objects and spec.replace:
                    _remove_parts(resolved, spec.name)
                resolved |= {obj.name: obj for obj in objects}
        return tuple(resolved.values())

    def _world_objects(self) -> dict[str, WorldObject]:
        """The world's own objects; what is wrong with one is reported at the scenario's `world`."""
        resolved: dict[str, WorldObject] = {}
        world, problems, hint = self.sources.world.world, list[str](), ""
        replaced = {spec.name for spec in self.sources.loaded.scenario.objects if spec.replace}
        for spec in world.objects:
            self.object_locs[spec.name] = ("world",)
            if spec.name in resolved:
                problems.append(f"two objects are called '{spec.name}'")
            if taken := self._other_meaning(spec.name):
                problems.append(f"'{spec.name}' cannot be an object's name: it is {taken}")
            frame, base = spec.pose.frame, SE3.identity()
            if frame in resolved:
                base = resolved[frame].pose
            elif frame != "world":
                problems.append(
                    f"'{spec.name}' has a pose in '{frame}', which is neither `world` nor an object"
                    " before it"
                )
            pose = base @ spec.pose.se3()
            try:
                objects = self._objects(spec, pose, self.sources.world.path.parent)
                resolved |= {obj.name: obj for obj in objects}
            except ObjectUnusableError as unusable:
                if spec.name in replaced:
                    resolved[spec.name] = _unusable(spec.name, pose)
                    continue
                problems.append(f"object '{spec.name}': {unusable}")
                hint = (
                    "an object of the same name with `replace: true` in `objects` takes its place"
                )
                self.problems.add_unusable(spec.name)
        if problems:
            self.problems.add(
                ("world",), f"world '{world.world}': " + "; ".join(problems), hint, needs=("world",)
            )
        return resolved

    def _start_pose(self, spec: ObjectSpec, loc: Loc, objects: Mapping[str, WorldObject]) -> SE3:
        """T_world_object of a pose in the world, a link, or an object that stands there before."""
        description = self.sources.description
        frame = spec.pose.frame
        if frame in objects and frame != spec.name:
            return objects[frame].pose @ spec.pose.se3()
        if frame in ("world", *description.link_names):
            start = description.start_positions()
            placed = SE3.identity()
            if frame != "world":
                placed = self.sources.kinematics.link_pose(start, frame)
            return placed @ spec.pose.se3()
        self.problems.unknown(
            (*loc, "pose", "frame"), "frame", frame, ("world", *objects, *description.link_names)
        )
        return spec.pose.se3()

    def _resolve(self, spec: ObjectSpec, loc: Loc, pose: SE3) -> tuple[WorldObject, ...]:
        """The object and its moving parts; none where it cannot be used, which is reported."""
        self.object_locs[spec.name] = loc
        if taken := self._other_meaning(spec.name):
            self.problems.add(
                (*loc, "name"), f"'{spec.name}' is {taken}", "choose another", needs=("robot",)
            )
        try:
            return self._objects(spec, pose, self.sources.loaded.path.parent)
        except ObjectUnusableError as unusable:
            if spec.name not in self.sources.doubtful:
                self.problems.add(loc, f"object '{spec.name}': {unusable}", needs=())
            self.problems.add_unusable(spec.name)
            return ()

    def _other_meaning(self, name: str) -> str:
        """What else a name of an object stands for; empty where it is free."""
        if name in RESERVED:
            return f"a word of expectations: {RESERVED[name]}"
        description = self.sources.description
        if name in ("world", *description.link_names):
            return "a robot link's name"
        if name in description.of_arm:
            return "the name of an arm"
        return "a robot joint's name" if name in description.joint_names else ""

    def _objects(self, spec: ObjectSpec, pose: SE3, folder: Path) -> tuple[WorldObject, ...]:
        """The object and its moving parts, mesh files looked into; raises ObjectUnusableError."""
        collision = self.sources.loaded.scenario.collision
        obj = resolve_object(spec, pose, folder, collision)
        parts = (each.part(spec, obj, folder, collision) for each in spec.joints)
        objects = (obj, *parts)
        for shape in (shape for each in objects for shape in each.shapes):
            if isinstance(shape.geometry, Mesh):
                try:
                    from harness.simulation.mesh_check import check_mesh  # loads the physics

                    check_mesh(shape.geometry)
                except RobotError as error:
                    raise ObjectUnusableError(str(error)) from error
        return objects

    def _later_object(self, spec: ObjectSpec, loc: Loc) -> None:
        """Prepare an object that a step adds; the same object may come and go, another may not."""
        if spec.replace:
            self.problems.add(loc, "`replace` is for the scenario's `objects`", needs=())
        if spec.joints:
            self.problems.add(
                (*loc, "joints"),
                "an object with `joints` stands in the scene from the start",
                "list it in the scenario's `objects`, or in the world's",
                needs=(),
            )
            return
        resolved = self._resolve(spec, loc, spec.pose.se3())
        if not resolved:
            return
        (obj,) = resolved
        if spec.name not in self.scope.objects:
            self.later[spec.name] = obj
            self.scope.add_object(obj)
        elif self.object_specs.get(spec.name) != _without_pose(spec):
            self.problems.add(
                (*loc, "name"),
                f"another object is called '{spec.name}'",
                "a name stands for one object: only what was removed may come back, with the same"
                " keys but for `pose`",
                needs=("world",),
            )
        self.object_specs.setdefault(spec.name, _without_pose(spec))

    # -- steps --------------------------------------------------------------------------------

    def _steps(
        self, specs: Sequence[StepFields], loc: Loc, path: str, suffix: str = "", arm: str = ""
    ) -> tuple[ProgramStep, ...]:
        return tuple(
            self._step(as_step(spec), (*loc, index), f"{path}[{index}]", suffix, arm)
            for index, spec in enumerate(specs)
        )

    def _step(self, spec: Step, loc: Loc, path: str, suffix: str, arm: str) -> ProgramStep:
        sources = self.sources
        self.step_locs[path] = loc
        step_id = f"{spec.id}{suffix}" if spec.id else path
        with self._gaps_allowed():
            for keys, obj in spec.new_objects():
                with self._gaps_allowed(obj.name):
                    self._later_object(obj, (*loc, *keys))
        if spec.planning is not None and not spec.plans:
            self.problems.add(
                (*loc, "planning"),
                f"`planning` has no effect on `{spec.verb}`, which plans nothing itself",
                "write it at a step that moves the arm, or at the top of the file for all of them",
                needs=(),
            )
        if spec.group is not None:
            self.scope.check_group(spec.group, (*loc, "group"))
        stated = self.scope.arm_of(spec.robot, spec.group, loc)
        arm = arm if spec.robot is None and spec.group is None and arm else stated
        if not self.scope.claim_step_id(step_id, arm):
            self.problems.add((*loc, "id"), f"another step has the id '{step_id}'", needs=())
        with self._gaps_allowed(), self.scope.with_arm(arm):
            spec.check(At(self.scope, loc))
        title, options = spec.verb, self._options(None, loc, path)
        with self._gaps_allowed(), self.scope.with_arm(arm):
            title = with_arm(arm, spec.title(self.scope.description.joint_units))
        with self._gaps_allowed():
            options = self._options(spec.planning, loc, path)
        line, _ = sources.loaded.lines.line_of(loc)
        step = ProgramStep(
            id=step_id,
            path=path,
            spec=spec,
            summary=title,
            line=line,
            options=options,
            children=self._children(spec, loc, path, suffix, arm),
            arm=arm,
        )
        for index, expectation in enumerate(spec.expect):
            self._expectation(expectation, (*loc, "expect", index), step_id)
        return step

    def _children(
        self, spec: Step, loc: Loc, path: str, suffix: str, arm: str
    ) -> tuple[ProgramStep, ...]:
        children: list[ProgramStep] = []
        blocks: Iterable[Block] = ()
        with self._gaps_allowed():
            blocks = [*spec.blocks(loc, path)]
        for block in blocks:
            if len(self.step_locs) > MOST_STEPS:
                self.problems.add(
                    loc,
                    f"the file contains more than {MOST_STEPS} steps, repeated ones counted",
                    needs=(),
                )
                break
            inner = suffix + block.suffix
            children += self._steps(block.steps, block.loc, block.path, inner, arm)
        return tuple(children)

    def _options(self, planning: Planning | None, loc: Loc, path: str) -> PlanningOptions:
        sources = self.sources
        if planning is not None:
            check_planning(
                planning,
                (*loc, "planning"),
                self.problems,
                check_planner,
                sources.loaded.scenario.planning,
            )
        return merged_options(
            sources.loaded.scenario.planning,
            planning,
            sources.loaded.scenario.seed,
            path,
            STATE_CHECKS_PER_SECOND,
            self._planner_name,
        )

    def _planner_name(self, pipeline: str, name: str) -> str:
        try:
            return check_planner(pipeline, name, {})
        except ValueError:  # reported where it is said
            return name

    def _expectation(self, spec: ExpectationFields, loc: Loc, step: str) -> None:
        self.pending.append((spec, loc, step))
        line, _ = self.sources.loaded.lines.line_of(loc)
        self.expectations.append(ProgramExpectation(spec, step, line))


def _remove_parts(objects: dict[str, WorldObject], fixture: str) -> None:
    """Remove the moving parts of an object that another one replaces."""
    for name in [
        name for name, obj in objects.items() if obj.joint and obj.joint.fixture == fixture
    ]:
        del objects[name]


def _unusable(name: str, pose: SE3) -> WorldObject:
    """A frame for an object that cannot be used and is replaced."""
    return WorldObject(name, (), pose, True, 0.0, np.zeros(3), np.zeros((3, 3)))


def _without_pose(spec: ObjectSpec) -> ObjectSpec:
    return spec.model_copy(update={"pose": type(spec.pose)(), "replace": False})
