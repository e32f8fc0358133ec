"""The results of a suite: its files, and what the terminal shows of them."""

from __future__ import annotations

import argparse
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from harness.cli.output import complain, output, say, say_text
from harness.core.printable import counted
from harness.core.registry import registry
from harness.reporting.suite.result_format import ResultFormat, result_formats
from harness.suite.hooks import NO_HOOKS, SuiteHooks

if TYPE_CHECKING:
    from harness.reporting.result import CaseResult
    from harness.reporting.suite.columns import Columns
    from harness.reporting.terminal import Style
    from harness.session.run_request import RunRequest
    from harness.suite.suite_run import SuiteRun

MOST_FAILURES = 20  # failures that are shown in full; the rest is counted


def write_suite_files(
    arguments: argparse.Namespace, suite: SuiteRun, hooks: SuiteHooks = NO_HOOKS
) -> tuple[Path | None, Columns | None]:
    """Write the files of a suite, and the summary of the service that runs the command.

    Returns:
        The page, and what varies in the cases; None where no files are written.
    """
    for each in result_formats():
        each.write_summary(suite.record)
    if not has_page(arguments, suite, hooks):
        return None, None
    from harness.reporting.suite.history import history_of
    from harness.reporting.suite.write import write_suite

    history = history_of(Path(arguments.history)) if arguments.history else {}
    folder = Path(arguments.report_dir)
    if hooks.write is not None:
        return hooks.write(suite, folder, history)
    return write_suite(folder, suite.record, suite.exit_code, history)


def has_page(arguments: argparse.Namespace, suite: SuiteRun, hooks: SuiteHooks = NO_HOOKS) -> bool:
    """Whether a suite writes files of its own, next to the reports of its cases."""
    is_alone = len(suite.plan) == 1 and not suite.is_part and not hooks.writes_single_case
    return not (arguments.no_report or is_alone or arguments.repeat > 1)


def show_json(suite: SuiteRun) -> int:
    """Print all results as one JSON document."""
    from harness.reporting.suite.record import results_json

    for part in results_json(suite.record, suite.exit_code):
        output().document(part)
    return suite.exit_code


def show_lines(arguments: argparse.Namespace, suite: SuiteRun) -> int:
    """Print a line for each problem: for editors, or for another program."""
    from harness.reporting.sampled import missed
    from harness.reporting.suite.cause import short_lines

    if arguments.format != "short":
        chosen: ResultFormat = registry("result_format")[arguments.format]()
        for line in chosen.failures(suite.failures()):
            output().command(line)
    else:
        say(*short_lines(suite.failures()))
        if rates := missed(suite.rates):
            say(rates)
        elif not suite.exit_code and not suite.is_interrupted:
            say(f"{counted(len(suite.results), 'case')} passed")
    return suite.exit_code


def show_results(
    arguments: argparse.Namespace,
    suite: SuiteRun,
    seconds: float,
    page: Path | None,
    columns: Columns | None,
) -> None:
    """Print failures, rates, tables and the last lines.

    Args:
        page: The page of the suite; None where there is none.
        columns: What varies in the cases; None where this is not known yet.
    """
    from harness.reporting.sampled import missed
    from harness.reporting.terminal import Style, report_link, summary

    style = Style.of(sys.stdout)
    _print_failures(arguments, suite, style)
    say("")
    if arguments.repeat > 1:
        _print_repetitions(suite, style)
    else:
        _print_rates(suite, columns, style)
    if suite.results:
        rates = missed(suite.rates)
        rate_text = f"; {style.outcome('failed', rates)}" if rates else ""
        outcomes = (outcome for _, outcome in suite.results.outcomes())
        say(f"{summary(outcomes, seconds, style)}{rate_text}")
    if len(suite.files) > 1:
        say(suite.files_text)
    if suite.resumed:
        say(f"{suite.resumed} of them were known from before")
    if page is not None:
        say(f"reports: {style.link(str(page), page.resolve().as_uri())}")
    elif written := [result for result in suite.results.values() if result.report_dir]:
        one = report_link(written[0], style)
        say(f"report: {one}" if len(written) == 1 else f"reports: {arguments.report_dir}")
    for each in result_formats():
        for line in each.remarks(suite.failures()):
            output().command(line)
    show_interruption(arguments, suite, seconds)


def _print_repetitions(suite: SuiteRun, style: Style) -> None:
    """Print whether the runs of each case have one digest."""
    from harness.reporting.terminal import repeats

    for runs in suite.repetitions():
        name = f"{runs[0].file} [{runs[0].case}]" if runs[0].case else runs[0].file
        say(f"{name}: {repeats(runs, style)}")


def show_interruption(arguments: argparse.Namespace, suite: SuiteRun, seconds: float) -> None:
    """Print what an interruption left undone, and how to resume; nothing without one."""
    if not suite.is_interrupted:
        return
    from harness.suite.cases import progress_text

    after = f"interrupted after {seconds:.1f} s"
    if len(suite.jobs) == 1:
        where = "".join(f", {progress_text(event)}" for event in suite.unfinished.values())
        complain(f"{after}{where}: the run did not finish, and no report was written")
        return
    complain(f"{after}: {suite.missing} of {len(suite.jobs)} runs did not finish")
    for index, event in suite.unfinished.items():
        complain(f"  {suite.jobs[index].file}: {progress_text(event)}")
    if arguments.repeat == 1 and not arguments.no_report:
        complain("the same command with --resume runs the rest")


def _print_failures(arguments: argparse.Namespace, suite: SuiteRun, style: Style) -> None:
    from harness.reporting.terminal import failure
    from harness.suite.header import source_lines

    failed = [
        index
        for index, outcome in suite.results.outcomes()
        if outcome != "passed" and (index % arguments.repeat == 0 or outcome == "error")
    ]
    for index in failed[:MOST_FAILURES]:
        result = suite.results[index]
        job = suite.jobs[index]
        again, source = _command(arguments, job), source_lines(job.file)
        say("")
        say_text(failure(result, style, again=again, source=source))
        folder = job.report_dir
        if folder and not result.report_dir and (folder / "run.json").is_file():
            say(f"  no report was written; {folder} is of an earlier run")
    if len(failed) > MOST_FAILURES:
        say("", f"... and {len(failed) - MOST_FAILURES} more that did not pass")


def _print_rates(suite: SuiteRun, columns: Columns | None, style: Style) -> None:
    from harness.reporting.sampled import rate_line

    for group in suite.rates:
        name = f"{group.file} [{group.group}]" if group.group else group.file
        say(rate_line(name, group.rate, style))
    if not any(each.header.varied for each in suite.plan.files):
        return
    from harness.reporting.suite.columns import Columns
    from harness.reporting.suite.tables import table_lines

    for line in table_lines(columns or Columns(suite.record.cases), style):
        say(line)


def _command(arguments: argparse.Namespace, job: RunRequest) -> str:
    """The command that runs one case again as it was run, and writes what was written."""
    words = ["harness", "run", str(job.file), *(["--case", job.case] if job.case else [])]
    words += [*job.options, *["--bag"] * arguments.bag]
    for name in arguments.reporters:
        words += ["--reporter", name]
    if arguments.report_dir != "reports":
        words += ["--report-dir", arguments.report_dir]
    return shlex.join(words)


def show_case(case: CaseResult, file: Path) -> None:
    """Print the outcome of one run, with what failed."""
    from harness.reporting.terminal import Style, case_line, failure, report_link
    from harness.suite.header import source_lines

    style = Style.of(sys.stdout)
    output().status(None)
    for note in case.notes:
        say(f"note: {note}")
    say(case_line(case, style))
    if case.outcome != "passed":
        say_text(failure(case, style, source=source_lines(file)))
    elif case.report_dir:
        say(f"report: {report_link(case, style)}")
