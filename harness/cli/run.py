"""`harness run`."""

from __future__ import annotations

import argparse
import shlex
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from harness.cli.output import complain, guarded, only_json_on_stdout, say
from harness.suite.discovery import UsageError, discover
from harness.suite.outcome import EXIT_CODES, INTERRUPTED_EXIT_CODE, exit_code
from harness.suite.warm import WarmServer

if TYPE_CHECKING:
    from harness.reporting.result import CaseResult
    from harness.suite.cases import CaseJob, Watcher


def run(arguments: argparse.Namespace) -> int:
    """Run scenarios; steps and outcomes as they come, failures last."""
    return guarded(lambda: _run(arguments))


def _run(arguments: argparse.Namespace) -> int:
    files = discover(arguments.paths)
    start = time.monotonic()
    with WarmServer() as server:
        if not arguments.in_process:
            server.open()  # it imports for as long as this process takes to get ready
        jobs = _jobs(arguments, _selected(files, arguments.expression))
        if arguments.json:
            with only_json_on_stdout() as write_json:
                results, is_interrupted = _collect(arguments, jobs, server)
                code = _code(arguments, results, is_interrupted)
                write_json(_document(results, code, is_interrupted))
            return code
        results, is_interrupted = _collect(arguments, jobs, server)
    _tell(arguments, jobs, results, time.monotonic() - start)
    if is_interrupted:
        complain(f"interrupted: {len(jobs) - len(results)} of {len(jobs)} runs did not finish")
    return _code(arguments, results, is_interrupted)


def _selected(files: Sequence[Path], expression: str) -> list[Path]:
    if not expression:
        return list(files)
    from harness.suite.header import read_header
    from harness.suite.selection import selects

    chosen = [file for file in files if selects(expression, file, read_header(file))]
    if not chosen:
        raise UsageError(f"-k '{expression}' selects none of {len(files)} scenarios")
    return chosen


def _jobs(arguments: argparse.Namespace, files: Sequence[Path]) -> list[CaseJob]:
    """Every file as often as asked; only its first run is reported."""
    from harness.suite.cases import CaseJob
    from harness.suite.folders import report_folders

    overrides = dict(arguments.overrides)
    jobs: list[CaseJob] = []
    for file, folder in zip(files, report_folders(files, Path(arguments.report_dir)), strict=True):
        reported = None if arguments.no_report else folder
        is_reported, page = reported is not None, not arguments.no_page
        jobs.append(
            CaseJob(file, overrides, arguments.seed, reported, is_reported, page, arguments.bag)
        )
        again = CaseJob(file, overrides, arguments.seed, None, stills=False)
        jobs.extend([again] * (arguments.repeat - 1))
    return jobs


def _collect(
    arguments: argparse.Namespace, jobs: Sequence[CaseJob], server: WarmServer
) -> tuple[dict[int, CaseResult], bool]:
    """Results by index in `jobs`, and whether Ctrl-C ended it early."""
    from harness.cli.progress import ProgressLines
    from harness.reporting.terminal import Style
    from harness.suite.cases import nobody_watches

    watch, told = nobody_watches, None
    if not arguments.json:
        told = ProgressLines(
            sys.stdout,
            _case_names(arguments, jobs),
            is_side_by_side=arguments.workers > 1 and not arguments.in_process,
            style=Style.of(sys.stdout),
        )
        watch = told.step
    results: dict[int, CaseResult] = {}
    try:
        for index, result in _results(arguments, jobs, server, watch):
            results[index] = result
            if told:
                told.result(index, result)
    except KeyboardInterrupt:
        return dict(sorted(results.items())), True
    return dict(sorted(results.items())), False


def _case_names(arguments: argparse.Namespace, jobs: Sequence[CaseJob]) -> list[str]:
    is_alone = arguments.workers == 1
    names = [str(job.file) if is_alone else job.file.name.split(".")[0] for job in jobs]
    if arguments.repeat == 1:
        return names
    return [f"{name} #{number % arguments.repeat + 1}" for number, name in enumerate(names)]


def _results(
    arguments: argparse.Namespace, jobs: Sequence[CaseJob], server: WarmServer, watch: Watcher
) -> Iterator[tuple[int, CaseResult]]:
    from harness.suite.cases import run_here, run_isolated

    if arguments.in_process:
        return run_here(jobs, watch=watch)
    cap, workers = arguments.hard_cap, arguments.workers
    return run_isolated(jobs, server, workers=workers, hard_cap=cap, watch=watch)


def _code(
    arguments: argparse.Namespace, results: Mapping[int, CaseResult], is_interrupted: bool
) -> int:
    if is_interrupted:
        return INTERRUPTED_EXIT_CODE
    code = exit_code(result.outcome for result in results.values())
    is_same = all(
        len({(result.outcome, result.digest) for result in runs}) == 1
        for runs in _repeats(arguments, results)
    )
    return code if is_same else max(code, EXIT_CODES["failed"])


def _repeats(
    arguments: argparse.Namespace, results: Mapping[int, CaseResult]
) -> list[list[CaseResult]]:
    """Results of the same file together, in file order."""
    together: dict[int, list[CaseResult]] = {}
    for index, result in results.items():
        together.setdefault(index // arguments.repeat, []).append(result)
    return list(together.values())


def _tell(
    arguments: argparse.Namespace,
    jobs: Sequence[CaseJob],
    results: Mapping[int, CaseResult],
    seconds: float,
) -> None:
    from harness.reporting.terminal import Style, failure, repeats, report_link, summary
    from harness.suite.header import source_lines

    style = Style.of(sys.stdout)
    for index, result in results.items():
        is_repetition = index % arguments.repeat > 0 and result.outcome != "error"
        if result.outcome != "passed" and not is_repetition:
            again, source = _command(arguments, jobs[index]), source_lines(jobs[index].file)
            say(f"\n{failure(result, style, again=again, source=source)}")
            folder = jobs[index].report_dir
            if folder and not result.report_dir and (folder / "run.json").is_file():
                say(f"  no report was written; {folder} is of an earlier run")
    say("")
    if arguments.repeat > 1:
        for runs in _repeats(arguments, results):
            say(f"{runs[0].file}: {repeats(runs, style)}")
    say(summary(list(results.values()), seconds, style))
    written = [result for result in results.values() if result.report_dir]
    if written:
        one = report_link(written[0], style)
        say(f"report: {one}" if len(written) == 1 else f"reports: {arguments.report_dir}")


def _command(arguments: argparse.Namespace, job: CaseJob) -> str:
    """The command that runs one case again as it was run."""
    words = ["harness", "run", str(job.file)]
    for path, value in arguments.overrides:
        words += ["--set", f"{path}={value}"]
    if job.seed is not None:
        words += ["--seed", str(job.seed)]
    if arguments.report_dir != "reports":
        words += ["--report-dir", arguments.report_dir]
    return shlex.join(words)


def _document(results: Mapping[int, CaseResult], code: int, is_interrupted: bool) -> object:
    return {
        "format": "armharness-results/1",
        "exit_code": code,
        "interrupted": is_interrupted,
        "cases": list(results.values()),
    }
