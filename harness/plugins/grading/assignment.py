"""`assignment.yaml`: an exercise, what students hand in, its points, hidden cases and limits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, model_validator

from harness.core.errors import Problem, SpecError
from harness.core.files import is_file
from harness.language.base import (
    Angle,
    Count,
    Duration,
    Flag,
    Length,
    Name,
    Number,
    PositiveDuration,
    SpecModel,
)
from harness.language.files.mistakes import MistakeError
from harness.language.files.source import Loc, Source, SourceMap
from harness.language.files.yaml_file import parse_yaml, read_text
from harness.language.reading.short_forms import models_shape
from harness.language.reading.wording import problems_of
from harness.suite.discovery import SUFFIX, bundled_scenarios

FILE = "assignment.yaml"

Kind = Literal["scenario", "node", "ik", "recording"]
"""What students hand in: steps of a scenario, a ROS 2 node, a function, or a recording."""

PropertyName = Literal[
    "reaches", "answers", "limits", "refuses", "anywhere", "continuity", "determinism", "branches"
]
"""The properties that `harness ik-test` tests."""


class IkExercise(SpecModel):
    """A function that solves inverse kinematics, tested as `harness ik-test` does."""

    short = "robot"

    robot: Name = Field(description="The name of a bundled robot, or a robot's folder.")
    function: Name = Field(
        default="ik", description="The name of the function in the file that is handed in."
    )
    link: str = Field(default="", description="The link that is placed; the default is the TCP.")
    branches: Flag = Field(
        default=False, description="Whether the function must return every solution for a target."
    )
    examples: Annotated[Count, Field(ge=1)] = Field(
        default=100, description="The number of cases of each property."
    )
    seed: Count = Field(default=0, description="The seed of the cases that students see.")
    position_tolerance: Annotated[Length, Field(gt=0)] = Field(
        default=1e-4, description="The largest position error of an answer [m]."
    )
    orientation_tolerance: Annotated[Angle, Field(gt=0)] = Field(
        default=1e-3, description="The largest orientation error of an answer [rad]."
    )
    weights: dict[PropertyName, Annotated[Number, Field(ge=0)]] = Field(
        default_factory=dict,
        description="What a property is worth next to the others, by its name; 1 by default.",
    )
    call_limit: PositiveDuration = Field(
        default=5.0,
        description="The processor time after which one call counts as hanging [s]; by the clock"
        " it is ten times as much.",
    )


class RecordingExercise(SpecModel):
    """A rosbag2, a ROS 1 bag or a CSV of joint values, graded as `harness grade` does."""

    short = "scenario"

    scenario: str = Field(description="The scenario file that grades the recording.")
    joint_states: str = Field(
        default="/joint_states", description="The topic of the joint positions."
    )
    objects: tuple[str, ...] = Field(
        default=(), description="Topics with poses of objects by name, as Gazebo's bridge has them."
    )
    object_poses: dict[Name, str] = Field(
        default_factory=dict, description="The topic of the pose of one object, by its name."
    )
    allow: tuple[Name, ...] = Field(
        default=(), description="Doubts about the recording that withhold no points."
    )
    csv_period: PositiveDuration = Field(
        default=0.01, description="The time between rows of a CSV without a column of times [s]."
    )


class HiddenCase(SpecModel):
    """A case that students do not see; they see its margins."""

    seed: Count | None = Field(default=None, description="The seed in place of the public one.")
    robot: Name | None = Field(
        default=None, description="The robot in place of the public one, a bundled name."
    )
    set: dict[str, Any] = Field(
        default_factory=dict,
        description="Values of the scenario file by dotted path, as `--set` takes them:"
        " `{params.x: 0.31}`.",
    )

    @model_validator(mode="after")
    def _differs(self) -> HiddenCase:
        if self.seed is None and self.robot is None and not self.set:
            raise MistakeError("is the public case", "give `seed`, `robot` or `set`")
        return self


class Limits(SpecModel):
    """Bounds of one submission; what exceeds one costs that submission alone."""

    simulated_time: Annotated[Duration, Field(gt=0, le=600)] = Field(
        default=120.0, description="The longest run of a case in simulated time [s]."
    )
    processor_time: PositiveDuration = Field(
        default=120.0, description="Processor time of a student's program in a case [s]."
    )
    wall_time: PositiveDuration = Field(
        default=600.0,
        description="Wall time of a case [s], which only a program that hangs reaches.",
    )
    memory: Annotated[Count, Field(ge=64)] = Field(
        default=4000, description="Memory that a case may add [MB]."
    )
    processes: Annotated[Count, Field(ge=1)] = Field(
        default=128, description="Processes and threads of a student's program at the same time."
    )
    files: Annotated[Count, Field(ge=1)] = Field(
        default=200,
        description="Size of an unpacked submission, and of all that its program writes [MB].",
    )


class Assignment(SpecModel):
    """An exercise that a class hands in: exactly one of `scenario`, `ik` and `recording`."""

    assignment: Annotated[str, Field(min_length=1, max_length=200)] = Field(
        description="The title of the assignment."
    )
    description: str = Field(default="", description="A description for students.")
    minutes: Annotated[Count, Field(ge=1)] | None = Field(
        default=None, description="The time that the author expects a student to need [min]."
    )
    scenario: str | None = Field(
        default=None,
        description="The scenario file of the exercise, in this folder, or a bundled name.",
    )
    takes: tuple[Literal["steps", "objects", "world", "cameras", "planning"], ...] = Field(
        default=("steps",),
        description="The keys of a student's scenario that replace those of `scenario`.",
    )
    node: str | None = Field(
        default=None,
        description="The command that starts a student's ROS 2 node in the submission's folder,"
        " such as `python student.py`; without it students hand in scenarios.",
    )
    ik: IkExercise | None = Field(
        default=None, description="The test of a function that solves inverse kinematics."
    )
    recording: RecordingExercise | None = Field(
        default=None, description="The scenario that grades bags or CSV files of joint values."
    )
    points: Annotated[Number, Field(gt=0)] | None = Field(
        default=None,
        description="The points of the assignment; those of the expectations are scaled to this"
        " sum. By default the sum of theirs.",
    )
    hidden: tuple[HiddenCase, ...] = Field(
        default=(), description="Further cases, of which students see the margins alone."
    )
    limits: Limits = Field(default=Limits(), description="The bounds of each submission.")

    @property
    def kind(self) -> Kind:
        """What students hand in."""
        if self.ik is not None:
            return "ik"
        if self.recording is not None:
            return "recording"
        return "scenario" if self.node is None else "node"

    @model_validator(mode="after")
    def _one_exercise(self) -> Assignment:
        given = [self.scenario, self.ik, self.recording]
        if sum(each is not None for each in given) != 1:
            raise ValueError("an assignment needs exactly one of `scenario`, `ik` and `recording`")
        return self


@dataclass(frozen=True)
class LoadedAssignment:
    """An assignment with its files.

    Attributes:
        folder: The folder of its file.
        scenario: The scenario file that grades; None of a solver's test.
        lines: Where each value of its file stands.
    """

    model: Assignment
    folder: Path
    scenario: Path | None
    lines: SourceMap | None = None

    @property
    def name(self) -> str:
        """The name of the folder, which names the assignment in tables."""
        return self.folder.resolve().name


def read_assignment(path: Path) -> LoadedAssignment:
    """Read the assignment of a folder.

    Args:
        path: The folder, or its `assignment.yaml`.

    Raises:
        SpecError: There is none, or it has mistakes; all of them, each at its place.
    """
    file = path if path.name == FILE else path / FILE
    text = read_text(file, kind=FILE)
    problems: list[Problem] = []
    written = parse_yaml(text, Source.of_text(str(file), text), problems)
    lines = SourceMap(models_shape(written, Assignment, problems))
    try:
        model = Assignment.model_validate(lines.root.plain())
    except ValidationError as error:
        raise SpecError(problems + problems_of(error.errors(include_url=False), lines)) from None
    problems += _contradictions(model, lines)
    scenario = _scenario_file(model, file.parent, lines, problems)
    if problems:
        raise SpecError(problems)
    return LoadedAssignment(model, file.parent, scenario, lines)


def _contradictions(model: Assignment, lines: SourceMap) -> Iterator[Problem]:
    """Keys that are valid each, and not next to each other."""
    if model.kind != "node" and model.node is not None:
        yield lines.problem_at_key(("node",), "a node needs a `scenario` whose arm it moves")
    if model.kind == "recording" and model.hidden:
        message = "a recording shows one case; it has no hidden ones"
        yield lines.problem_at_key(("hidden",), message, "remove `hidden`")
    for index, case in enumerate(model.hidden):
        if model.kind == "ik" and case.set:
            message = "the test of a function has no values to set"
            yield lines.problem_at_key(("hidden", index, "set"), message, "use `seed` or `robot`")


def _scenario_file(
    model: Assignment, folder: Path, lines: SourceMap, problems: list[Problem]
) -> Path | None:
    """The scenario file that an assignment names: in its folder, or bundled."""
    loc: Loc = ("scenario",) if model.scenario is not None else ("recording", "scenario")
    name = model.scenario or (model.recording.scenario if model.recording is not None else "")
    if not name:
        return None
    file = folder / name
    is_inside = "\0" not in name and file.resolve().is_relative_to(folder.resolve())
    if is_inside and is_file(file):
        return file
    bundled: Mapping[str, Path] = bundled_scenarios()
    if name.removesuffix(SUFFIX) in bundled:
        return bundled[name.removesuffix(SUFFIX)]
    message = f"there is no scenario file '{name}' in the folder of the assignment"
    hint = "copy the file into it, or give a name of `harness list scenarios`"
    if not is_inside:
        message = f"'{name}' is outside the folder of the assignment"
    problems.append(lines.problem(loc, message, hint))
    return None
