"""`harness run`."""

from __future__ import annotations

import argparse
import shlex
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from harness.cli.output import complain, guarded, only_json_on_stdout, say
from harness.suite.discovery import discover
from harness.suite.warm import WarmServer

if TYPE_CHECKING:
    from harness.reporting.terminal import Style
    from harness.suite.cases import CaseJob
    from harness.suite.suite_run import SuiteRun

BRIEF_FROM = 20
"""With more runs than this a passed one is a line, without its steps."""

MOST_FAILURES = 20
"""Failures that are told in full; the rest is counted."""


def run(arguments: argparse.Namespace) -> int:
    """Run scenarios; steps and outcomes as they come, failures last."""
    return guarded(lambda: _run(arguments))


def _run(arguments: argparse.Namespace) -> int:
    files = discover(arguments.paths)
    start = time.monotonic()
    with WarmServer() as server:
        if not arguments.in_process:
            server.open()  # it imports for as long as this process takes to get ready
        suite = _suite(arguments, files)
        if arguments.json:
            with only_json_on_stdout() as write_json:
                suite.collect(server)
                write_json(_document(suite))
            return suite.exit_code
        from harness.cli.progress import ProgressLines
        from harness.reporting.terminal import Style

        names = _case_names(arguments, suite.jobs)
        progress = ProgressLines(
            sys.stdout,
            names,
            is_side_by_side=arguments.workers > 1 and not arguments.in_process,
            is_brief=len(names) > BRIEF_FROM,
            style=Style.of(sys.stdout),
        )
        suite.collect(server, progress.step, progress.result)
    _tell(arguments, suite, time.monotonic() - start)
    return suite.exit_code


def _suite(arguments: argparse.Namespace, files: Sequence[Path]) -> SuiteRun:
    from harness.suite.plan import Wanted, planned
    from harness.suite.suite_run import How, SuiteRun

    root = None if arguments.no_report else Path(arguments.report_dir)
    plan = planned(
        files,
        Wanted(
            expression=arguments.expression,
            cases=arguments.cases,
            overrides=dict(arguments.overrides),
            seed=arguments.seed,
            samples=arguments.samples,
            report_root=root,
            keep=arguments.keep,
            page=not arguments.no_page,
            bag=arguments.bag,
        ),
    )
    is_streamed = arguments.resume or (len(plan) > 1 and arguments.repeat == 1)
    how = How(
        workers=arguments.workers,
        repeat=arguments.repeat,
        in_process=arguments.in_process,
        hard_cap=arguments.hard_cap,
        stream=root if is_streamed else None,
        resume=arguments.resume,
    )
    return SuiteRun(plan, how)


def _document(suite: SuiteRun) -> object:
    """Everything, for machines."""
    return {
        "format": "armharness-results/1",
        "exit_code": suite.exit_code,
        "interrupted": suite.is_interrupted,
        "cases": list(suite.results.values()),
        "rates": suite.rates,
    }


def _case_names(arguments: argparse.Namespace, jobs: Sequence[CaseJob]) -> list[str]:
    is_alone = arguments.workers == 1
    names = [str(job.file) if is_alone else job.file.name.split(".")[0] for job in jobs]
    names = [
        f"{name} [{job.case}]" if job.case else name for name, job in zip(names, jobs, strict=True)
    ]
    if arguments.repeat == 1:
        return names
    return [f"{name} #{number % arguments.repeat + 1}" for number, name in enumerate(names)]


def _tell(arguments: argparse.Namespace, suite: SuiteRun, seconds: float) -> None:
    """Failures, rates, tables and the last lines."""
    from harness.reporting.terminal import Style, repeats, report_link, summary

    style = Style.of(sys.stdout)
    _tell_failures(arguments, suite, style)
    say("")
    if arguments.repeat > 1:
        for runs in suite.repetitions():
            name = f"{runs[0].file} [{runs[0].case}]" if runs[0].case else runs[0].file
            say(f"{name}: {repeats(runs, style)}")
    else:
        _tell_rates(suite, style)
    say(summary(list(suite.results.values()), seconds, style))
    if suite.resumed:
        say(f"{suite.resumed} of them were known from before")
    written = [result for result in suite.results.values() if result.report_dir]
    if written:
        one = report_link(written[0], style)
        say(f"report: {one}" if len(written) == 1 else f"reports: {arguments.report_dir}")
    if suite.is_interrupted:
        complain(f"interrupted: {suite.missing} of {len(suite.jobs)} runs did not finish")
        if len(suite.jobs) > 1 and arguments.repeat == 1 and not arguments.no_report:
            complain("go on with the same command and --resume")


def _tell_failures(arguments: argparse.Namespace, suite: SuiteRun, style: Style) -> None:
    from harness.reporting.terminal import failure
    from harness.suite.header import source_lines

    told = 0
    for index, result in suite.results.items():
        is_repetition = index % arguments.repeat > 0 and result.outcome != "error"
        if result.outcome == "passed" or is_repetition:
            continue
        told += 1
        if told > MOST_FAILURES:
            continue
        job = suite.jobs[index]
        again, source = _command(arguments, job), source_lines(job.file)
        say(f"\n{failure(result, style, again=again, source=source)}")
        folder = job.report_dir
        if folder and not result.report_dir and (folder / "run.json").is_file():
            say(f"  no report was written; {folder} is of an earlier run")
    if told > MOST_FAILURES:
        say(f"\n... and {told - MOST_FAILURES} more that did not pass")


def _tell_rates(suite: SuiteRun, style: Style) -> None:
    from harness.reporting.sampled import rate_line, table_lines

    for group in suite.rates:
        name = f"{group.file} [{group.group}]" if group.group else group.file
        say(rate_line(name, group.rate, style))
    cases = [
        (suite.plan[index].values, result.outcome == "passed")
        for index, result in suite.results.items()
        if suite.plan[index].values
    ]
    for line in table_lines(cases, style):
        say(line)


def _command(arguments: argparse.Namespace, job: CaseJob) -> str:
    """The command that runs one case again as it was run."""
    words = ["harness", "run", str(job.file)]
    if job.case:
        words += ["--case", job.case]
    for path, value in arguments.overrides:
        words += ["--set", f"{path}={value}"]
    if arguments.seed is not None:
        words += ["--seed", str(arguments.seed)]
    if arguments.samples is not None:
        words += ["--samples", str(arguments.samples)]
    if arguments.report_dir != "reports":
        words += ["--report-dir", arguments.report_dir]
    return shlex.join(words)
