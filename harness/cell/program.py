"""The resolved program of a scenario: nothing left to look up."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from harness.cell.step import Step
from harness.core.camera import Camera
from harness.core.world import World, WorldObject
from harness.language.expectation import ExpectationFields
from harness.language.files.source import Loc
from harness.ports.motion_planning import PlanningOptions
from harness.robot.description import RobotDescription


def step_seed(seed: int, path: str) -> int:
    """A step's seed: a hash of the scenario's seed and the step's place in the expanded file."""
    digest = hashlib.sha256(f"{seed}:{path}".encode()).digest()
    return int.from_bytes(digest[:4], "big") & 0x7FFFFFFF


def with_arm(arm: str, summary: str) -> str:
    """The summary of a step of one of several arms: `left: pick box`."""
    return f"{arm}: {summary}" if arm else summary


@dataclass(frozen=True, eq=False)
class ProgramStep:
    """A step with everything around it known.

    Attributes:
        id: The file's, else `path`.
        path: Place in the expanded file: `steps[3]`, `steps[3].lift`.
        spec: What the file says.
        summary: One line for a person.
        line: The line in the file, from 1.
        options: How its motions are planned, seed included.
        children: Nested steps of the file.
        arm: The arm that carries it out, of a robot with several; empty where the step names none
            and none is the default.
    """

    id: str
    path: str
    spec: Step
    summary: str
    line: int
    options: PlanningOptions
    children: tuple[ProgramStep, ...] = ()
    arm: str = ""

    def flat(self) -> Iterator[ProgramStep]:
        """This step, then those nested in it."""
        yield self
        for child in self.children:
            yield from child.flat()


@dataclass(frozen=True, eq=False)
class ProgramExpectation:
    """An expectation and where it stands; `step` is empty for the whole run."""

    spec: ExpectationFields
    step: str
    line: int


@dataclass(frozen=True, eq=False)
class Program:
    """What will be executed.

    Attributes:
        title: The title of the scenario.
        description: The description of the robot.
        world: Objects that are there at the start, poses in the world.
        later_objects: Objects that steps add, by name; where they appear is the step's to say.
        steps: The steps of the file.
        expectations: The expectations of steps and run, in file order.
        seed: The seed of the run.
        cameras: The cameras of robot, world and scenario, by name.
        step_locs: Where each step is written, by its path.
        object_locs: Where each object is written, by name; the world's own are at `world`.
        parts: What plug-ins have resolved of the scenario, by their names.
    """

    title: str
    description: RobotDescription
    world: World
    later_objects: Mapping[str, WorldObject]
    steps: tuple[ProgramStep, ...]
    expectations: tuple[ProgramExpectation, ...]
    seed: int
    step_locs: Mapping[str, Loc] = field(default_factory=dict[str, Loc])
    object_locs: Mapping[str, Loc] = field(default_factory=dict[str, Loc])
    cameras: Mapping[str, Camera] = field(default_factory=dict[str, Camera])
    parts: Mapping[str, Any] = field(default_factory=dict[str, Any])

    def all_steps(self) -> Iterator[ProgramStep]:
        """Every step of the file, nested ones after the one they are nested in."""
        for step in self.steps:
            yield from step.flat()

    def all_objects(self) -> tuple[WorldObject, ...]:
        """Objects of the world, then those that steps add."""
        return (*self.world.objects, *self.later_objects.values())
