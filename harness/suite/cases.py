"""Run many cases, each in its own process or all in this one, and yield their results."""

from __future__ import annotations

import os
import re
import signal
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from harness.core.error_text import error_text
from harness.core.errors import HarnessError, SpecError
from harness.core.interruption import is_interrupted
from harness.core.slow_work import reported_to
from harness.reporting.progress_events import (
    Compiled,
    Judged,
    ProgressEvent,
    StepFinished,
    StepProgress,
    Working,
)
from harness.reporting.result import CaseResult
from harness.session.run_request import RunRequest
from harness.suite.case_runner import case_runner
from harness.suite.discovery import SUFFIX
from harness.suite.environment import prepare_process
from harness.suite.header import read_header
from harness.suite.leftovers import clean_leftovers
from harness.suite.server import preload
from harness.suite.warm import REPORT_MODULES, Ended, Heard, WarmServer

HARD_CAP_SECONDS = 600.0  # wall time of a case, whatever it does; HARNESS_HARD_CAP sets it


SHORT, LONGEST_WAIT = 0.01, 60.0  # [s], then the time of cases is looked at again
MOST_READ = 1000  # cases in which names of steps and robots are looked for, approximately

_WORD = re.compile(r"\w+")


Function = Callable[[RunRequest, Callable[[ProgressEvent], None]], CaseResult]
Watcher = Callable[[int, ProgressEvent], None]
Chooser = Callable[[int], bool]


def never_needless(_index: int) -> bool:
    """Every case is needed."""
    return False


def ignore_progress(_index: int, _event: ProgressEvent) -> None:
    """Take no notice of progress."""


def run_job(job: RunRequest, notify: Callable[[ProgressEvent], None]) -> CaseResult:
    """Run a case in this process."""
    prepare_process()
    from harness.core.inputs import inputs_read

    def slow(text: str) -> None:
        notify(Working(text, is_slow=True))

    with reported_to(slow):
        result = _run_job(job, notify)
        if result.outcome == "invalid":
            result = replace(result, title=stated_title(job))
        return replace(result, inputs=inputs_read())


def _run_job(job: RunRequest, notify: Callable[[ProgressEvent], None]) -> CaseResult:
    name = "nodes" if job.nodes else "live" if job.live else ""
    if name:
        return case_runner(name).run(job, notify)
    from harness.session.run_case import run_case  # imports planners and physics

    return run_case(job, notify)


def read_ahead(words: Collection[str], some: Sequence[RunRequest] = ()) -> None:
    """Do once what every run does: import steps, read robots and worlds, look up versions.

    Args:
        words: The words of the scenarios.
        some: Cases whose bundled robots and worlds other cases have too.
    """
    from harness.core.inputs import forget_inputs
    from harness.core.registry import import_built_in
    from harness.core.versions import library_versions
    from harness.language.reading.load import is_foreign_world, load_world, read_scenario
    from harness.language.scenario import Scenario
    from harness.language.world import WorldSpec
    from harness.robot.load import load_ahead, read_bundled
    from harness.robot.robot_yaml import RobotYaml

    library_versions()
    named = import_built_in(("step", "expectation"), words)
    for model in (Scenario, WorldSpec, RobotYaml, *named):
        model.model_rebuild()
    read_bundled(words)
    for job in some:
        with suppress(HarnessError):  # the case itself reports the error
            read = read_scenario(job.file, job.overrides, job.seed, job.text).loaded
            if read is not None:
                load_ahead(read.scenario)
                if not is_foreign_world(read.scenario.world.name):
                    load_world(read.scenario.world.name, read.path.parent)
    forget_inputs()


def run_here(
    jobs: Sequence[RunRequest],
    *,
    watch: Watcher = ignore_progress,
    function: Function = run_job,
    is_needless: Chooser = never_needless,
) -> Iterator[tuple[int, CaseResult]]:
    """Run cases in this process, one after the other; for debuggers: nothing contains a crash."""
    for index, job in enumerate(jobs):
        if is_needless(index):
            continue
        _clean(job)
        try:
            result = function(job, lambda event, index=index: watch(index, event))
        except Exception as error:
            if is_interrupted():
                raise KeyboardInterrupt from error
            result = error_result(job, error_text(error))
        yield index, result


def run_isolated(
    jobs: Sequence[RunRequest],
    server: WarmServer,
    *,
    workers: int = 1,
    hard_cap: float | None = None,
    watch: Watcher = ignore_progress,
    function: Function = run_job,
    is_needless: Chooser = never_needless,
) -> Iterator[tuple[int, CaseResult]]:
    """Run every case in its own forked process, `workers` side by side.

    Args:
        hard_cap: Wall seconds a case may take, waits for a processor left out; then it is ended.
        watch: Hears (index, event) of running cases.
        function: What a child calls; importable there by its name.
        is_needless: Called with each index before its case begins; a needless case is skipped.

    Yields:
        (index into `jobs`, result) in the order in which cases end.

    Raises:
        ServerStartError: The modules of a run cannot be imported.
    """
    cap = hard_cap or float(os.environ.get("HARNESS_HARD_CAP", HARD_CAP_SECONDS))
    upcoming = iter(range(len(jobs)))
    running: dict[int, _Running] = {}
    if function is run_job:
        _prepare(server, jobs)
    try:
        while True:
            while len(running) < workers and (index := next(upcoming, None)) is not None:
                if is_needless(index):
                    continue
                job = jobs[index]
                _clean(job)
                number = server.start(function, job)
                running[number] = _Running(index, job)
            if not running:
                break
            left = [cap - server.time_of(each) for each in running if not running[each].is_over_cap]
            for event in server.wait(min([max(SHORT, each) for each in left] + [LONGEST_WAIT])):
                case = running[event.job]
                match event:
                    case Heard(message=message):
                        case.last = message
                        watch(case.index, message)
                    case Ended():
                        del running[event.job]
                        _clean(case.job)
                        yield case.index, _result(case, event, cap)
            for number, case in running.items():
                if not case.is_over_cap and server.time_of(number) >= cap:
                    case.is_over_cap = True
                    server.kill(number)
    except BaseException:  # Ctrl-C above all, perhaps in the middle of a message
        server.close()
        for case in running.values():
            _clean(case.job)
        raise


def _prepare(server: WarmServer, jobs: Sequence[RunRequest]) -> None:
    """Let the server import and read what the cases have in common."""
    server.prepare(read_ahead, _words(jobs), jobs[:1] if len(jobs) > 1 else [])
    if len(jobs) > 1:
        server.prepare(preload, REPORT_MODULES)


def _words(jobs: Sequence[RunRequest]) -> frozenset[str]:
    """Every word in the scenarios, names of robots among them; of many cases, in some of them."""
    from harness.language.files.yaml_file import read_text

    some = jobs[:: max(1, len(jobs) // MOST_READ)]
    texts = {job.text for job in some if job.text is not None}
    texts.update(value for job in some for value in job.overrides.values())
    for file in {job.file for job in some if job.text is None}:
        with suppress(SpecError):  # the case itself reports the error
            texts.add(read_text(file))
    return frozenset(word for text in texts for word in _WORD.findall(text))


def _clean(job: RunRequest) -> None:
    if job.report_dir is not None:
        clean_leftovers(job.report_dir)


@dataclass
class _Running:
    index: int
    job: RunRequest
    is_over_cap: bool = False
    last: ProgressEvent | None = None


def _result(case: _Running, ended: Ended, cap: float) -> CaseResult:
    if isinstance(ended.result, CaseResult) and ended.code == 0:
        return ended.result
    at = f" {progress_text(case.last)}" if case.last else ""
    printed = f"\nIt had printed:\n{ended.log.rstrip()}" if ended.log.strip() else ""
    if case.is_over_cap:
        why = f"no end after {cap:g} s of wall time{at}; stopped by the hard cap{printed}"
    elif ended.traceback:
        why = f"{ended.traceback.rstrip()}{printed}"
    elif ended.code is None:
        why = f"the fork server, or its connection to this case, ended{at}{printed}"
    elif ended.code < 0:
        number = -ended.code
        why = (
            f"its process was ended by {signal.Signals(number).name} (signal {number}){at}{printed}"
        )
    else:
        why = f"its process ended with code {ended.code} and no result{at}{printed}"
    return error_result(case.job, why)


def progress_text(event: ProgressEvent) -> str:
    """When in its course a case stands, in words."""
    match event:
        case StepProgress():
            number = f" {event.index + 1}/{event.total}" if event.index >= 0 else ""
            when = "after" if isinstance(event, StepFinished) else "during"
            return f"{when} step{number}: {event.step}"
        case Working():
            return f"during {event.what}"
        case Compiled():
            return "during the first step"
        case Judged():
            return "during the report"
        case _:
            return "during the end"


def error_result(job: RunRequest, message: str) -> CaseResult:
    """The outcome of a case in which the harness, or a native library, broke."""
    return CaseResult(
        job.shown_file,
        job.case,
        stated_title(job),
        "error",
        seed=job.seed or 0,
        message=message.rstrip(),
    )


def stated_title(job: RunRequest) -> str:
    """The title that a file states, whatever else is wrong with it; else its name."""
    title = read_header(job.file, job.overrides, job.text).title
    name = Path(job.shown_file).name
    return name if name == title + SUFFIX else title
