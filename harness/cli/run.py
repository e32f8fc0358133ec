"""`harness run`."""

from __future__ import annotations

import argparse
import shlex
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from harness.cli.output import complain, guarded, only_json_on_stdout, output, say, say_text
from harness.core.lazy import LazySequence
from harness.core.registry import registry
from harness.suite.cases import progress_text
from harness.suite.discovery import UsageError, discover
from harness.suite.leftovers import clean_report_folder
from harness.suite.warm import WarmServer

if TYPE_CHECKING:
    from harness.reporting.result import CaseResult
    from harness.reporting.suite.columns import Columns
    from harness.reporting.terminal import Style
    from harness.session.run_request import RunRequest
    from harness.suite.conditions import Conditions
    from harness.suite.suite_run import SuiteRun

BRIEF_FROM = 20
"""With more runs than this a passed one is a line, without its steps."""

LONGEST_WAIT_FOR_PAGE = 10.0
"""Time after which a run with `--live` begins although its page is not open [s]."""

MOST_FAILURES = 20
"""Failures that are shown in full; the rest is counted."""


def run(arguments: argparse.Namespace) -> int:
    """Run scenarios; steps and outcomes as they come, failures last."""
    return guarded(lambda: _run(arguments), ticks=not arguments.in_process)


def _run(arguments: argparse.Namespace) -> int:
    files = discover(arguments.paths)
    if arguments.live:
        return _run_live(arguments, files)
    if arguments.robot == "ros2":
        from harness.cli.remote import run_on_ros2

        return run_on_ros2(arguments, files)
    return _run_files(arguments, files)


def _run_live(arguments: argparse.Namespace, files: Sequence[Path]) -> int:
    """Run scenarios while a page shows them."""
    excluded = {"--on": arguments.cluster, "--robot ros2": arguments.robot == "ros2"}
    for option, is_given in {**excluded, "--node": arguments.nodes}.items():
        if is_given:
            raise UsageError(f"--live and {option} exclude each other")
    from harness.cli.studio import open_browser, refuse_missing_extra

    refuse_missing_extra()
    from harness.studio.watch import Watch

    with Watch() as watch:
        complain(f"live: {watch.page}")
        if open_browser(watch.page):
            watch.wait_for_page(LONGEST_WAIT_FOR_PAGE)
        return _run_files(arguments, files, watch.address)


def _run_files(arguments: argparse.Namespace, files: Sequence[Path], live: str = "") -> int:
    start = time.monotonic()
    with WarmServer() as server:
        if not arguments.in_process and not arguments.cluster:
            server.open()  # it imports for as long as this process takes to get ready
        suite = _suite(arguments, files, live)
        update_page = _page_updates(arguments, suite)
        if arguments.format == "json":
            with only_json_on_stdout():
                suite.collect(server, on_result=update_page)
                write_files(arguments, suite)
                _show_interruption(arguments, suite, time.monotonic() - start)
            return show_json(suite)
        if arguments.format != "full":
            suite.collect(server, on_result=update_page)
            write_files(arguments, suite)
            _show_interruption(arguments, suite, time.monotonic() - start)
            return show_lines(arguments, suite)
        from harness.cli.progress import ProgressLines
        from harness.reporting.terminal import Style

        names = _case_names(arguments, suite)
        progress = ProgressLines(
            output(),
            names,
            is_side_by_side=arguments.workers > 1 and not arguments.in_process,
            is_brief=len(names) > BRIEF_FROM,
            style=Style.of(sys.stdout),
        )

        def on_result(index: int, result: CaseResult) -> None:
            progress.result(index, result)
            update_page(index, result)

        suite.collect(server, progress.step, on_result)
        output().status(lambda: "  writing the results")
    page, columns = write_files(arguments, suite)
    output().status(None)
    show_results(arguments, suite, time.monotonic() - start, page, columns)
    return suite.exit_code


def _suite(arguments: argparse.Namespace, files: Sequence[Path], live: str) -> SuiteRun:
    from harness.ros.launch import named_commands
    from harness.suite.plan import SuiteRequest, planned_cases, record_of
    from harness.suite.shards import shard_of, write_shard_record
    from harness.suite.suite_run import SuiteOptions, SuiteRun

    if arguments.yes or arguments.velocity_scaling != 1.0:
        raise UsageError(
            "--yes and --velocity-scaling need --robot ros2; in a file the speed is"
            " `planning: {max_velocity_scaling_factor: 0.5}`"
        )
    if arguments.history and not Path(arguments.history).is_dir():
        raise UsageError(f"--history '{arguments.history}' is no folder")
    for name in arguments.reporters:
        try:
            registry("reporter").find(name)
        except LookupError as error:
            raise UsageError(f"--reporter: {error.args[0]}") from None
    if arguments.cluster:
        from harness.suite.ray_cluster import check_cluster

        check_cluster(arguments.cluster)
        if arguments.in_process:
            raise UsageError("--on and --in-process exclude each other")
    root = None if arguments.no_report else Path(arguments.report_dir)
    if root is not None:
        clean_report_folder(root)
    shard = shard_of(arguments.shard) if arguments.shard else None
    conditions = _conditions(arguments)
    request = SuiteRequest(
        expression=arguments.expression,
        cases=arguments.cases,
        overrides=dict(arguments.overrides),
        seed=arguments.seed,
        samples=arguments.samples,
        report_root=root,
        keep=arguments.keep,
        page=not arguments.no_page,
        bag=arguments.bag,
        shard=shard,
        strict=arguments.strict,
        reporters=arguments.reporters,
        nodes=named_commands(arguments.nodes) if arguments.nodes else {},
        share=not arguments.no_sharing and arguments.repeat == 1,  # repetitions compare each other
        conditions=conditions,
        live=live,
    )
    plan = planned_cases(files, request)
    if shard is not None and root is not None:
        write_shard_record(record_of(files, request, shard, root))
        if conditions is not None:
            conditions.copy(root)  # a merge has neither the scenario files nor the conditions
    is_whole = arguments.repeat == 1 and (len(plan) > 1 or shard is not None)
    how = SuiteOptions(
        workers=arguments.workers,
        repeat=arguments.repeat,
        in_process=arguments.in_process,
        hard_cap=arguments.hard_cap,
        stream=root if arguments.resume or is_whole else None,
        resume=arguments.resume,
        is_part=shard is not None,
        cluster=arguments.cluster,
    )
    return SuiteRun(plan, how, files)


def _conditions(arguments: argparse.Namespace) -> Conditions | None:
    """The samples of `--conditions`."""
    if not arguments.conditions:
        return None
    from harness.suite.conditions import read_conditions

    given = {"--seed": arguments.seed, "--samples": arguments.samples}
    for option, value in given.items():
        if value is not None:
            raise UsageError(f"--conditions and {option} exclude each other")
    return read_conditions(Path(arguments.conditions))


def write_files(
    arguments: argparse.Namespace, suite: SuiteRun
) -> tuple[Path | None, Columns | None]:
    """The files of a suite; GitHub's summary of the job where there is one.

    Returns:
        The page, and what varies in the cases; None where no files are written.
    """
    from harness.reporting.suite.github import append_summary

    append_summary(suite.record)
    if not has_page(arguments, suite):
        return None, None
    from harness.reporting.suite.history import history_of
    from harness.suite.write import write_results

    history = history_of(Path(arguments.history)) if arguments.history else {}
    return write_results(suite, Path(arguments.report_dir), history)


def _page_updates(
    arguments: argparse.Namespace, suite: SuiteRun
) -> Callable[[int, CaseResult], None]:
    """What keeps the page of a running suite up to date with each result."""
    if not has_page(arguments, suite):
        return lambda *_: None
    from harness.cli.live_page import LivePage

    page = LivePage(suite, Path(arguments.report_dir))
    return lambda index, _result: page.result(index)


def has_page(arguments: argparse.Namespace, suite: SuiteRun) -> bool:
    """Whether a suite writes files of its own, next to the reports of its cases."""
    is_alone = len(suite.plan) == 1 and not suite.is_part
    return not (arguments.no_report or is_alone or arguments.repeat > 1)


def show_json(suite: SuiteRun) -> int:
    """Print all results as one JSON document."""
    from harness.reporting.suite.record import results_json

    for part in results_json(suite.record, suite.exit_code):
        output().document(part)
    return suite.exit_code


def show_lines(arguments: argparse.Namespace, suite: SuiteRun) -> int:
    """A line for each thing that went wrong: for editors, or as GitHub's annotations."""
    from harness.reporting.suite.cause import short_lines
    from harness.reporting.suite.github import error_annotations

    if arguments.format == "github":
        for line in error_annotations(suite.failures()):
            output().command(line)
    else:
        say(*short_lines(suite.failures()))
    return suite.exit_code


def _case_names(arguments: argparse.Namespace, suite: SuiteRun) -> Sequence[str]:
    repeat = arguments.repeat

    def name(index: int) -> str:
        planned = suite.plan[index // repeat]
        file = planned.file
        shown = str(file) if arguments.workers == 1 else file.name.split(".")[0]
        case = f" [{planned.name}]" if planned.name else ""
        return f"{shown}{case}" + (f" #{index % repeat + 1}" if repeat > 1 else "")

    return LazySequence(len(suite.jobs), name)


def show_results(
    arguments: argparse.Namespace,
    suite: SuiteRun,
    seconds: float,
    page: Path | None,
    columns: Columns | None,
) -> None:
    """Failures, rates, tables and the last lines.

    Args:
        page: The page of the suite; None where there is none.
        columns: What varies in the cases; None where this is not known yet.
    """
    from harness.reporting.sampled import missed
    from harness.reporting.suite.github import annotations_for_action
    from harness.reporting.terminal import Style, repeats, report_link, summary

    style = Style.of(sys.stdout)
    _print_failures(arguments, suite, style)
    say("")
    if arguments.repeat > 1:
        for runs in suite.repetitions():
            name = f"{runs[0].file} [{runs[0].case}]" if runs[0].case else runs[0].file
            say(f"{name}: {repeats(runs, style)}")
        for index, said in suite.differences.items():
            say(f"  run {index % arguments.repeat + 1} of {suite.jobs[index].file}: {said}")
    else:
        _print_rates(suite, columns, style)
    rates = missed(suite.rates)
    rate_text = f"; {style.outcome('failed', rates)}" if rates else ""
    if suite.results:
        outcomes = (outcome for _, outcome in suite.results.outcomes())
        say(f"{summary(outcomes, seconds, style)}{rate_text}")
    if len(suite.files) > 1:
        say(suite.files_text)
    if suite.resumed:
        say(f"{suite.resumed} of them were known from before")
    if columns is not None and (shared := columns.shared.sentence()):
        say(shared)
    if page is not None:
        say(f"reports: {style.link(str(page), page.resolve().as_uri())}")
    elif written := [result for result in suite.results.values() if result.report_dir]:
        one = report_link(written[0], style)
        say(f"report: {one}" if len(written) == 1 else f"reports: {arguments.report_dir}")
    for line in annotations_for_action(suite.failures()):
        output().command(line)
    if len(suite.processors) > 1:
        say(
            f"the cases ran on {len(suite.processors)} processor families"
            f" ({'; '.join(sorted(suite.processors))}): compare their verdicts, not their digests"
        )
    _show_interruption(arguments, suite, seconds)


def _show_interruption(arguments: argparse.Namespace, suite: SuiteRun, seconds: float) -> None:
    """What an interruption left undone, and how to go on; nothing where there was none."""
    if not suite.is_interrupted:
        return
    after = f"interrupted after {seconds:.1f} s"
    if len(suite.jobs) == 1:
        where = "".join(f", during {progress_text(event)}" for event in suite.unfinished.values())
        complain(f"{after}{where}: the run did not finish, and no report was written")
        return
    complain(f"{after}: {suite.missing} of {len(suite.jobs)} runs did not finish")
    for index, event in suite.unfinished.items():
        complain(f"  {suite.jobs[index].file}: during {progress_text(event)}")
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
    """The command that runs one case again as it was run."""
    words = ["harness", "run", str(job.file)]
    if job.case:
        words += ["--case", job.case]
    for path, value in arguments.overrides:
        words += ["--set", f"{path}={value}"]
    for folder in arguments.package_folders:
        words += ["--package-path", str(folder)]
    for module in arguments.plugins:
        words += ["--plugin", module]
    if arguments.seed is not None:
        words += ["--seed", str(arguments.seed)]
    if arguments.samples is not None:
        words += ["--samples", str(arguments.samples)]
    for node in arguments.nodes:
        words += ["--node", node]
    words += ["--strict"] if arguments.strict else []
    words += ["--bag"] if arguments.bag else []
    for name in arguments.reporters:
        words += ["--reporter", name]
    if arguments.report_dir != "reports":
        words += ["--report-dir", arguments.report_dir]
    return shlex.join(words)
