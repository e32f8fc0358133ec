"""The exercises of a course: folders with an assignment, a file to begin with and an answer."""

from __future__ import annotations

import argparse
import json
import re
from contextlib import chdir
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from harness.core.registry import registry
from harness.core.resources import data_folder
from harness.language.reading.load import read_scenario
from harness.plugins.grading.assignment import FILE, LoadedAssignment, read_assignment
from harness.plugins.grading.credit import Credit, credit_of_function, property_verdicts
from harness.plugins.grading.merge import merged_source, refuse_scene_verbs
from harness.suite.discovery import SUFFIX, UsageError

if TYPE_CHECKING:
    from harness.recording.verdict import Verdict
    from harness.reporting.result import CaseResult

START = "start"


@dataclass(frozen=True)
class Exercise:
    """An assignment with a file that a student begins with: `start.yaml` or `start.py`."""

    assignment: LoadedAssignment
    start: Path

    @property
    def folder_name(self) -> str:
        """The name of the folder: `03_grasp`."""
        return self.assignment.name

    @property
    def file_name(self) -> str:
        """The name of the student's file: `grasp.scenario.yaml`."""
        stem = re.sub(r"^\d+_(?=.)", "", self.folder_name)
        return f"{stem}{SUFFIX if self.start.suffix == '.yaml' else self.start.suffix}"


def exercises() -> dict[int, Exercise]:
    """The bundled exercises by number."""
    folders = sorted((data_folder("scenarios") / "course").glob(f"*/{FILE}"))
    return {number: read_exercise(file.parent) for number, file in enumerate(folders, 1)}


def read_exercise(folder: Path) -> Exercise:
    """The exercise in a folder.

    Raises:
        SpecError: The folder has no assignment, or the assignment has mistakes.
        UsageError: It has no file to begin with.
    """
    loaded = read_assignment(folder)
    found = [file for file in sorted(folder.glob(f"{START}.*")) if file.suffix in (".yaml", ".py")]
    if len(found) != 1:
        raise UsageError(f"'{folder}' needs one file {START}.yaml or {START}.py to begin with")
    if loaded.model.kind == "recording":
        raise UsageError(f"'{folder}' grades recordings, which `harness grade` does")
    return Exercise(loaded, found[0])


def find_exercise(name: str) -> Exercise:
    """The exercise of a number, of a bundled name or in a folder.

    Raises:
        UsageError: There is none.
    """
    known = exercises()
    for number, exercise in known.items():
        if name in (str(number), exercise.folder_name):
            return exercise
    if Path(name).is_dir():
        return read_exercise(Path(name))
    raise UsageError(
        f"there is no exercise '{name}': give a number from 1 to {len(known)}, or a folder with"
        f" {FILE}; `harness course` lists them"
    )


def find_work(place: Path, exercise: Exercise | None) -> tuple[Exercise, Path]:
    """The exercise of a student's folder or file, by the name of the file, and the file.

    Raises:
        UsageError: The folder holds none, or several.
    """
    known = [exercise] if exercise else [*exercises().values()]
    if place.is_file():
        found = [(each, place) for each in known if exercise or each.file_name == place.name]
    else:
        found = [(each, place / each.file_name) for each in known]
        found = [(each, file) for each, file in found if file.is_file()]
    if not found:
        names = known[0].file_name if exercise else "the file that `harness course start` writes"
        raise UsageError(f"'{place}' holds no exercise: expected {names}")
    if len(found) > 1:
        names = ", ".join(str(file) for _, file in found)
        raise UsageError(f"'{place}' holds several exercises; name one of the files: {names}")
    return found[0]


def run_work(exercise: Exercise, file: Path, report: Path) -> CaseResult:
    """Run a student's steps, or node, with the world and the expectations of the exercise.

    Raises:
        SpecError: The student's file is no scenario, or changes the scene.
    """
    from harness.session.run_request import RunRequest
    from harness.suite.api import run_in_process

    loaded = exercise.assignment
    assert loaded.scenario is not None  # the test of a solver has no run
    if loaded.model.node is None:
        source = merged_source(file, loaded.scenario, loaded.model.takes)
        refuse_scene_verbs(read_scenario(file, text=source), loaded.scenario)
        return run_in_process(RunRequest(file, source=source, report_dir=report))
    request = RunRequest(loaded.scenario.resolve(), report_dir=report.resolve())
    with chdir(file.parent):  # the command of the node names a file in the student's folder
        return run_in_process(replace(request, nodes={"node": loaded.model.node}))


def test_solver(exercise: Exercise, file: Path, report: Path) -> tuple[tuple[Verdict, ...], Credit]:
    """Test a student's function, and print what was found.

    Returns:
        The properties as verdicts with their points, and what those that hold earn.
    """
    ik = exercise.assignment.model.ik
    assert ik is not None
    words = [f"{file}:{ik.function}", "--robot", ik.robot, "--report-dir", str(report)]
    words += ["--examples", str(ik.examples), "--seed", str(ik.seed)]
    words += ["--branches"] * ik.branches + (["--link", ik.link] if ik.link else [])
    command, parser = registry("command").find("ik-test")(), argparse.ArgumentParser()
    command.add_options(parser)
    command.run(parser.parse_args(words))
    [result] = report.rglob("ik_test.json")
    document = json.loads(result.read_text(encoding="utf-8"))
    return property_verdicts(document, ik.weights), credit_of_function(document)
