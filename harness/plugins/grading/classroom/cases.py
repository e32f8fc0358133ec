"""One case of one submission, run in the process that was forked for it."""

from __future__ import annotations

import os
import resource
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from harness.core.errors import HarnessError, SpecError
from harness.core.memory import limited_memory
from harness.core.untrusted_json import parse_json
from harness.plugins.grading.assignment import LoadedAssignment
from harness.plugins.grading.bag.content import BagTopics
from harness.plugins.grading.classroom.confined import Confinement, adopt_orphans, end_children
from harness.plugins.grading.merge import merged_text, placed, refuse_scene_verbs, steps_in
from harness.recording.stored_run import PAGE
from harness.recording.verdict import Verdict
from harness.reporting.progress_events import ProgressEvent
from harness.reporting.result import CaseResult
from harness.session.run_request import RunRequest
from harness.suite.cases import run_job

LARGEST_OUTPUT = 20_000_000  # [bytes], of `harness ik-test --json`
REACHES = "reaches"
"""The property of `ik-test` without which the others say nothing: to refuse everything is easy."""

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
        return replace(_blank(case, "invalid"), problems=tuple(error.problems))
    except HarnessError as error:
        return _blank(case, "error", str(error))
    finally:
        end_children()


def _blank(case: GradedCase, outcome: Any, message: str = "") -> CaseResult:
    title = case.assignment.model.assignment
    return CaseResult(case.main.name, case.case, title, outcome, message=message)


def _scenario(case: GradedCase, notify: Notify) -> CaseResult:
    """Run the student's steps in the exercise; places are those of the student's file."""
    from harness.language.reading.load import read_scenario

    own, takes = case.main, case.assignment.model.takes
    text = merged_text(own, case.file, takes)
    reading = read_scenario(case.file, case.overrides, case.seed, text)
    refuse_scene_verbs(reading, own, case.file)
    result = run_job(replace(case, text=text), notify)
    verdicts = (each if each.step else replace(each, line=0) for each in result.verdicts)
    problems = tuple(placed(each, own, case.file) for each in result.problems)
    return replace(result, file=own.name, verdicts=tuple(verdicts), problems=problems)


def _node(case: GradedCase, notify: Notify) -> CaseResult:
    """Let the student's node move the arm; where no step is `external`, for the whole run."""
    from harness.language.reading.load import load_scenario

    model = case.assignment.model
    command = case.confinement.text(model.node or "")
    overrides = dict(case.overrides)
    scenario = load_scenario(case.file, overrides).scenario
    if all(step.verb != "external" for step in steps_in(scenario)):
        overrides["steps"] = f"[{{external: {{}}, timeout: {model.limits.simulated_time:g} s}}]"
    return run_job(replace(case, overrides=overrides, nodes={"node": command}), notify)


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
    properties, findings = document["properties"], document["findings"]
    reaches = any(each["name"] == REACHES and each["observed"] for each in properties)
    verdicts = tuple(_property_verdict(each, findings, is_worth=reaches) for each in properties)
    _keep_pictures(report, case.report_dir)
    outcome = "passed" if all(each.status == "passed" for each in verdicts) else "failed"
    return replace(_blank(case, outcome), verdicts=verdicts, report_dir=str(case.report_dir or ""))


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


def _property_verdict(each: Any, findings: Any, *, is_worth: bool) -> Verdict:
    """A property of `ik_test.json` as a verdict; it holds where the function reaches targets."""
    shown = [finding for finding in findings if finding["number"] in each["findings"]]
    if is_worth and not shown and each["observed"]:
        return Verdict(each["says"], "passed")
    reason = each["note"]
    if not is_worth:
        reason = ": it ".join(
            ["the function reaches no target", *(f["kind"] for f in findings[:1])]
        )
    if shown:
        first = shown[0]
        what = ": ".join(filter(None, (first["kind"], first["detail"])))
        reason = f"{what}; in {each['flawed']} of {each['tried']} cases, as {first['call']}"
    return Verdict(each["says"], "failed", reason=reason or "no case showed it")


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
