"""Scenarios from Python: run one, look at its verdicts and at what was recorded."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, TypeVar

from harness.recording.read_run import read_run
from harness.recording.run import Run
from harness.recording.step_record import StepRecord
from harness.recording.stored_run import RUN
from harness.recording.verdict import Verdict
from harness.reporting.result import CaseResult
from harness.reporting.terminal import causes
from harness.session.run_request import RunRequest
from harness.suite.cases import ignore_progress, run_here
from harness.suite.discovery import UsageError
from harness.suite.header import read_header, source_lines
from harness.suite.variation import Case, Variation, as_yaml

if TYPE_CHECKING:
    from harness.language.scenario import Scenario

MODEL = "<Scenario model>"  # what messages call a scenario that is a model in Python, and no file

T = TypeVar("T")
Runner = Callable[[RunRequest], CaseResult]


@dataclass(frozen=True, repr=False)
class ScenarioResult:
    """The result of a run; true when it passed.

    Attributes:
        case: Outcome, verdicts, problems, digest and times, as the terminal and reports show them.
        run: Everything recorded; None where nothing ran.
        text: The text of the scenario file; of a model, the file that says the same, whose lines
            messages count.
    """

    case: CaseResult
    run: Run | None
    text: str = ""

    @property
    def passed(self) -> bool:
        """Whether every step and every expectation is as it should be."""
        return self.case.outcome == "passed"

    def __bool__(self) -> bool:
        return self.passed

    def __repr__(self) -> str:
        return f"ScenarioResult({self.case.outcome}: {self.case.title})"

    def _repr_html_(self) -> str:
        """The outcome, its verdicts and a picture, as Jupyter shows a result."""
        from harness.reporting.notebook import result_html

        return result_html(self.case)

    def __str__(self) -> str:
        """Why it did not pass, as the terminal says it."""
        if self.passed:
            return f"passed: {self.case.title}"
        return "\n".join([self.case.outcome, *causes(self.case, self.text.splitlines())])

    def verdict(self, words: str) -> Verdict:
        """The one verdict whose expectation has these words in it.

        Raises:
            LookupError: None has them, or several.
        """
        found = [each for each in self.case.verdicts if _plain(words) in _plain(each.expectation)]
        return _one(found, words, [each.expectation for each in self.case.verdicts])

    def step(self, step_id: str) -> StepRecord:
        """The record of a step, by its id.

        Raises:
            LookupError: No step has it.
        """
        steps = self.run.steps if self.run is not None else ()
        found = [each for each in steps if each.id == step_id]
        return _one(found, step_id, [each.id for each in steps if each.id])


def _plain(text: str) -> str:
    """Words as they are compared: `named_target` is `named target`."""
    return text.replace("_", " ").lower()


def _one(found: list[T], words: str, known: list[str]) -> T:
    if len(found) != 1:
        listed = "; ".join(known) or "there are none"
        raise LookupError(f"{len(found)} have '{words}': {listed}")
    return found[0]


def run_scenario(
    scenario: str | Path | Scenario,
    *,
    overrides: Mapping[str, Any] | None = None,
    seed: int | None = None,
    case: str = "",
    report_dir: str | Path | None = None,
    runner: Runner | None = None,
) -> ScenarioResult:
    """Run one case of a scenario and read back what was recorded.

    Args:
        scenario: A file, or the model of one; relative names in a model are looked up from the
            working directory.
        overrides: Dotted path -> value, as `--set` has them: `{"robot.model": "ur5e"}`.
        seed: Instead of the scenario's.
        case: The name of the case, where the file is parametrised.
        report_dir: Where its report is written; None: nowhere.
        runner: Runs the job; by default in this process.

    Raises:
        UsageError: There is no such case, or one must be named.
    """
    job = _job(scenario, as_yaml(overrides or {}), seed, case)
    with ExitStack() as stack:
        if report_dir is None:
            folder = Path(stack.enter_context(TemporaryDirectory())) / "run"
            job = replace(job, report_dir=folder, stills=False, page=False)
        else:
            job = replace(job, report_dir=Path(report_dir))
        result = (runner or run_in_process)(job)
        folder = Path(result.report_dir) if result.report_dir else None
        run = read_run(folder).run if folder is not None and (folder / RUN).is_file() else None
        if report_dir is None:
            result = replace(result, report_dir="")
    if job.text is None:
        return ScenarioResult(result, run, "\n".join(source_lines(job.file)))
    return ScenarioResult(_without_folder(result), run, job.text)


def _without_folder(result: CaseResult) -> CaseResult:
    """A model's result under the model's name: there is no such file in any folder."""
    problems = tuple(
        replace(problem, path=MODEL if problem.path == result.file else problem.path)
        for problem in result.problems
    )
    return replace(result, file=MODEL, problems=problems)


def run_in_process(job: RunRequest) -> CaseResult:
    """Run a job here."""
    [(_index, result)] = run_here([job], watch=ignore_progress)
    return result


def _job(
    scenario: str | Path | Scenario, overrides: dict[str, str], seed: int | None, case: str
) -> RunRequest:
    if isinstance(scenario, str | Path):
        file, text = Path(scenario), None
    else:
        from harness.language.reading.written import scenario_text

        file, text = Path.cwd() / MODEL, scenario_text(scenario)
    variation = read_header(file, overrides, text).variation
    name = str(scenario) if isinstance(scenario, str | Path) else scenario.scenario
    chosen = _case(variation, seed, case, name).with_overrides(overrides)
    return RunRequest(
        file,
        chosen.overrides,
        seed if chosen.sample is None else None,
        case=chosen.name,
        text=text,
        redraw=chosen.redraw,
    )


def _case(variation: Variation, seed: int | None, name: str, scenario: str) -> Case:
    cases = variation.cases(seed)
    names = [cases.name(index) for index in range(len(cases))]
    if name in names:
        return cases[names.index(name)]
    known = ", ".join(names[:10])
    if not name:
        raise UsageError(f"'{scenario}' has {len(cases)} cases; name one of them: {known}")
    raise UsageError(f"'{scenario}' has no case '{name}'; cases: {known or 'one, without a name'}")
