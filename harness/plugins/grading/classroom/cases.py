"""One case of one submission, run in the process that was forked for it."""

from __future__ import annotations

import os
import resource
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from harness.core.errors import HarnessError, SpecError
from harness.core.memory import limited_memory
from harness.core.untrusted_json import parse_json
from harness.plugins.grading.assignment import LoadedAssignment
from harness.plugins.grading.bag.content import BagTopics
from harness.plugins.grading.classroom.confined import Confinement, adopt_orphans, end_children
from harness.plugins.grading.credit import (
    GradedResult,
    credit_of_function,
    credit_of_run,
    property_verdicts,
)
from harness.plugins.grading.merge import merged_source, refuse_scene_verbs, steps_in
from harness.recording.stored_run import PAGE
from harness.reporting.progress_events import ProgressEvent
from harness.reporting.result import CaseResult
from harness.session.run_request import RunRequest
from harness.suite.cases import run_job

LARGEST_OUTPUT = 20_000_000  # [bytes], of `harness ik-test --json`
TAIL = 2000
"""Characters of a program's last output that are shown."""

Notify = Callable[[ProgressEvent], None]


@dataclass(frozen=True, kw_only=True)
class GradedCase(RunRequest):
    """A case of a submission.

    Attributes:
        assignment: The assignment; the public case is that of its files.
        owner: The folder name of the submission.
        main: The file or folder of the submission that is graded.
        scratch: The folder of this case's copy of the submission.
        number: 0 for the public case, from 1 for the hidden ones.
        user: The user that the student's program runs as; None keeps this process' user.
    """

    assignment: LoadedAssignment
    owner: str
    main: Path
    scratch: Path
    number: int
    user: int | None = None

    @property
    def confinement(self) -> Confinement:
        """The bounds of the student's program."""
        inside = self.main if self.main.is_dir() else self.main.parent
        return Confinement(self.scratch, inside, self.assignment.model.limits, self.user)


def run_graded_case(case: RunRequest, notify: Notify) -> CaseResult:
    """Run a `GradedCase` with bounded memory and files; what it started is ended afterwards."""
    assert isinstance(case, GradedCase)
    limits = case.assignment.model.limits
    adopt_orphans()
    most = limits.files * 10**6
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))
    try:
        with limited_memory(limits.memory * 10**6):
            case.confinement.own_folder()
            return _KINDS[case.assignment.model.kind](case, notify)
    except SpecError as error:
        place = f"{case.scratch}{os.sep}"  # a student knows the name of the file alone
        problems = [
            replace(each, path=Path(each.path).name) if each.path.startswith(place) else each
            for each in error.problems
        ]
        return replace(_blank(case, "invalid"), problems=tuple(problems))
    except HarnessError as error:
        return _blank(case, "error", str(error))
    finally:
        end_children()


def _blank(case: GradedCase, outcome: Any, message: str = "") -> GradedResult:
    title = case.assignment.model.assignment
    return GradedResult(case.main.name, case.case, title, outcome, message=message)


def _scenario(case: GradedCase, notify: Notify) -> CaseResult:
    """Run the student's steps in the exercise; places are those of the student's file."""
    from harness.language.reading.load import read_scenario

    name, takes = case.main.name, case.assignment.model.takes
    source = merged_source(case.main, case.file, takes, name)
    reading = read_scenario(case.file, case.overrides, case.seed, source)
    refuse_scene_verbs(reading, case.file)
    case = replace(case, source=source)
    result = run_job(case, notify)
    if result.outcome == "error" and case.report_dir is not None and not case.report_dir.exists():
        why = result.message  # a full disk, or a report that is too large: points need neither
        result = run_job(replace(case, report_dir=None), notify)
        result = replace(result, notes=(*result.notes, why))
    return _credited(result)


def _credited(result: CaseResult) -> CaseResult:
    """The result of a run with what its verdicts earn."""
    credit = credit_of_run(is_idle=result.is_idle, is_full=result.outcome == "passed")
    parts = {each.name: getattr(result, each.name) for each in fields(CaseResult)}
    return GradedResult(**parts, credit=credit)


def _node(case: GradedCase, notify: Notify) -> CaseResult:
    """Let the student's node move the arm; where no step is `external`, for the whole run."""
    from harness.language.reading.load import load_scenario

    model = case.assignment.model
    command = case.confinement.text(model.node or "")
    overrides = dict(case.overrides)
    scenario = load_scenario(case.file, overrides).scenario
    if all(step.verb != "external" for step in steps_in(scenario)):
        overrides["steps"] = f"[{{external: {{}}, timeout: {model.limits.simulated_time:g} s}}]"
    return _credited(run_job(replace(case, overrides=overrides, nodes={"node": command}), notify))


def _recording(case: GradedCase, _notify: Notify) -> CaseResult:
    """Judge a recording by the exercise's scenario."""
    from harness.plugins.grading.grade import grade_bag

    exercise = case.assignment.model.recording
    assert exercise is not None
    topics = BagTopics(
        exercise.joint_states,
        objects=exercise.objects,
        object_poses=exercise.object_poses,
        csv_period=exercise.csv_period,
    )
    folder = case.report_dir
    grade = grade_bag(case.file, case.main, topics, {}, exercise.allow, folder)
    verdicts = [
        replace(
            row.verdict,
            status="not observable",
            reason=f"its points are withheld: {', '.join(row.withheld)}",
        )
        if row.is_withheld
        else row.verdict
        for row in grade.rows
    ]
    return replace(
        _blank(case, "passed" if grade.is_full else "failed"),
        verdicts=tuple(verdicts),
        notes=grade.notes,
        report_dir=str(folder or ""),
        page=str(folder / PAGE) if folder else "",
        sim_time=grade.run.duration if grade.run is not None else 0.0,
    )


def _ik(case: GradedCase, _notify: Notify) -> CaseResult:
    """Test a function by `harness ik-test` in a confined process."""
    exercise = case.assignment.model.ik
    assert exercise is not None
    hidden = case.assignment.model.hidden[case.number - 1] if case.number else None
    name = (hidden.robot if hidden else None) or exercise.robot
    own, robot, report = case.assignment.folder / name, name, case.scratch / "report"
    if own.is_dir():  # a copy, as the folder of the assignment may be hidden from programs
        robot = str(shutil.copytree(own, case.scratch / "robot"))
        case.confinement.own_folder()
    words = [sys.executable, "-m", "harness.cli", "ik-test"]
    words += [f"{case.main.name}:{exercise.function}", "--robot", robot, "--json"]
    words += ["--seed", str(case.seed if case.seed is not None else exercise.seed)]
    words += ["--examples", str(exercise.examples), "--call-limit", f"{exercise.call_limit:g}"]
    words += ["--position-tolerance", f"{exercise.position_tolerance:g}"]
    words += ["--orientation-tolerance", f"{exercise.orientation_tolerance:g}"]
    words += [*(["--link", exercise.link] if exercise.link else [])]
    words += [*(["--branches"] if exercise.branches else [])]
    words += ["--report-dir", str(report)] if case.report_dir else ["--no-report"]
    said, errors, code = _output(case, words)
    document: Any = parse_json(said) if code in (0, 1) and said.startswith("{") else None
    if not isinstance(document, dict) or "properties" not in document:
        lines = (errors.strip() or said.strip() or f"it ended with code {code}")[-TAIL:]
        return _blank(case, "invalid" if code == 2 else "error", lines)
    verdicts = property_verdicts(document, exercise.weights)
    _keep_pictures(report, case.report_dir)
    outcome = "passed" if all(each.status == "passed" for each in verdicts) else "failed"
    return replace(
        _blank(case, outcome),
        verdicts=verdicts,
        report_dir=str(case.report_dir or ""),
        credit=credit_of_function(document),
    )


def _output(case: GradedCase, words: list[str]) -> tuple[str, str, int]:
    """Output, error output and exit code of a confined command."""
    paths = os.pathsep.join(each for each in sys.path if each)
    done = subprocess.Popen(
        case.confinement.command(words),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": paths},
    )
    try:
        said, errors = done.communicate(timeout=case.assignment.model.limits.wall_time)
    except subprocess.TimeoutExpired:
        end_children()
        return "", "it has no end within the wall time of a case", 3
    if len(said) > LARGEST_OUTPUT:
        return "", f"{shlex.join(words[3:5])} has printed {len(said)} bytes", 3
    return said.decode(errors="replace"), errors.decode(errors="replace"), done.returncode


def _keep_pictures(report: Path, target: Path | None) -> None:
    """Copy the pictures of findings into the report; a student's program may have written there.

    Raises:
        HarnessError: The folder cannot be written.
    """
    if target is None:
        return
    (target / "images").mkdir(parents=True, exist_ok=True)
    for file in sorted(report.rglob("finding-*.jpg"))[:20]:
        if file.is_file() and not file.is_symlink() and file.stat().st_size < 10**6:
            (target / "images" / file.name).write_bytes(file.read_bytes())


_KINDS: dict[str, Callable[[GradedCase, Notify], CaseResult]] = {
    "scenario": _scenario,
    "node": _node,
    "recording": _recording,
    "ik": _ik,
}
