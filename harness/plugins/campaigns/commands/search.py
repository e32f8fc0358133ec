"""`harness search`."""

from __future__ import annotations

import argparse
import shlex
import sys
from contextlib import closing
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from harness.cli.arguments import whole_number, whole_number_from
from harness.cli.command import SEARCHES, Command
from harness.cli.files import one_scenario
from harness.cli.output import complain, output, say, say_json
from harness.cli.shared_options import (
    add_hard_cap,
    add_json,
    add_preparation,
    add_report_dir,
    add_seed,
)
from harness.cli.work_bar import WorkBar
from harness.suite.outcome import EXIT_CODES

if TYPE_CHECKING:
    from harness.plugins.campaigns.failure_search.search import SearchResult
    from harness.plugins.campaigns.failure_search.write import Written, WrittenFailure
    from harness.reporting.result import CaseResult


class SearchCommand(Command):
    """Search for conditions under which a scenario fails."""

    name: ClassVar[str] = "search"
    group: ClassVar[str] = SEARCHES
    collects_garbage: ClassVar[bool] = True

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness search`."""
        add = command.add_argument
        add("file", metavar="FILE", help="a scenario file with `randomize`, or a bundled name")
        add_preparation(command)
        add_seed(command, "use this seed for every run and for the search,")
        text = "search this parametrised case, where the file has several"
        add("--case", metavar="NAME", default="", help=text)
        text = "make N runs, besides those that shrink a failure (default: the file's, or 100)"
        add("--runs", metavar="N", type=whole_number, default=None, help=text)
        text = "begin with N low-discrepancy samples (default: the file's, or 32)"
        add("--start", metavar="N", type=whole_number, default=None, help=text)
        text = "propose N runs at a time (default: the file's, or 4 + 3 ln(number of parameters))"
        add("--batch", metavar="N", type=whole_number_from(2, 1000), default=None, help=text)
        text = "minimise the margin of this expectation (default: the file's, or the worst margin)"
        add("--minimise", metavar="NAME", default=None, help=text)
        add(
            "-j", metavar="N", dest="workers", type=whole_number, default=1, help="make N at a time"
        )
        text = "continue where the same command was interrupted, and keep the results that exist"
        add("--resume", action="store_true", help=text)
        add_hard_cap(command, "run")
        add_report_dir(command, "write files into DIR/search")
        add_json(command)

    def run(self, arguments: argparse.Namespace) -> int:
        """Search for conditions under which a scenario fails; exit code 1 when there are some."""
        from harness.plugins.campaigns.failure_search.write import search_document

        import_module("cmaes")  # refused here where it is not installed
        found, written, code = _search(arguments)
        if arguments.json:
            say_json({**search_document(found, written), "exit_code": code})
        else:
            _show(arguments, found, written)
        return code


def _search(arguments: argparse.Namespace) -> tuple[SearchResult, Written, int]:
    file = one_scenario(arguments.file)
    from harness.suite.warm import WarmServer

    with WarmServer() as server:
        from harness.plugins.campaigns.failure_search.search import SearchRequest, search
        from harness.plugins.campaigns.failure_search.write import (
            is_failing,
            search_folder,
            write_failures,
            write_search,
        )
        from harness.suite.stream import Stream

        names = ("runs", "start", "seed", "batch", "minimise")
        request = SearchRequest.of(
            file,
            dict(arguments.overrides),
            arguments.case,
            {name: getattr(arguments, name) for name in names},
            workers=arguments.workers,
            hard_cap=arguments.hard_cap,
        )
        folder = search_folder(Path(arguments.report_dir), file)
        progress = _Progress(request.settings.runs)
        with closing(Stream(folder, resume=arguments.resume)) as stream:
            try:
                found = search(
                    request, server, stream=stream, on_run=progress.run, on_stage=progress.stage
                )
                progress.stage("writing the failures")
                written = write_failures(found, folder, server)
            except KeyboardInterrupt:
                complain("interrupted: the same command with --resume continues")
                raise
        write_search(found, written, folder)
    output().status(None)
    return found, written, EXIT_CODES["failed" if is_failing(found) else "passed"]


class _Progress:
    """The status line of a search: what it does, and how many runs it has made.

    In a pipe or a file, stages and runs that fail are lines on standard error: a search takes long.
    """

    def __init__(self, runs: int) -> None:
        self._runs = runs
        self._done = 0
        self._failed = 0
        self._stage = "starting"
        self._bar = WorkBar()

    def stage(self, text: str) -> None:
        """Show what the search does next."""
        if text != self._stage:
            self._log(f"{text}: {self._done} runs so far, {self._failed} failed")
        self._stage = text
        self._show()

    def run(self, number: int, result: CaseResult) -> None:
        """Count a run, in the order in which they end; its name has the order of the search."""
        self._done = number
        from harness.reporting.suite.cause import cause_of

        self._failed += result.outcome != "passed"
        if (cause := cause_of(result)) is not None:
            self._log(f"{result.case} {result.outcome}: {cause.text}")
        self._show()

    def _log(self, text: str) -> None:
        if not sys.stdout.isatty():
            complain(text)

    def _show(self) -> None:
        failed = f"; {self._failed} failed" if self._failed else ""
        self._bar(self._stage, self._done, max(self._runs, self._done), failed)


def _show(arguments: argparse.Namespace, found: SearchResult, written: Written) -> None:
    from harness.plugins.campaigns.failure_search.write import search_folder
    from harness.reporting.suite.cause import cause_of
    from harness.reporting.suite.write import PAGE
    from harness.reporting.terminal import Style, report_link

    style = Style.of(sys.stdout)
    exploration = found.exploration
    if found.nominal.result.outcome != "passed":
        cause = cause_of(found.nominal.result)
        say(f"{style.mark(False)} the scenario fails unchanged: {cause and cause.text}")
        say(f"  again:  {shlex.join(['harness', 'run', str(found.request.file)])}")
        return
    names = ", ".join(each.path for each in found.space.parameters)
    say(f"{found.request.file}: {len(exploration.samples)} runs over {names}")
    if exploration.rate is not None:
        say(exploration.rate.sentence)
    runs = found.request.settings.runs
    if len(exploration.samples) < runs:
        say(f"the search ended before {runs} runs: no margin varies of what has not failed")
    if found.uncounted:
        say(f"{found.uncounted} runs are invalid or begin with an overlap, and do not count")
    if not written.failures:
        say(f"{style.mark(True)} no failure was found")
    elif exploration.first_failure:
        say(f"the first failure was run {exploration.first_failure}")
    for each in written.failures:
        _show_failure(each, found, report_link(each.result, style))
    page = search_folder(Path(arguments.report_dir), found.request.file) / PAGE
    say("", f"all runs: {style.link(str(page), page.resolve().as_uri())}")


def _show_failure(each: WrittenFailure, found: SearchResult, report: str) -> None:
    from harness.plugins.campaigns.failure_search.write import changes
    from harness.reporting.suite.cause import cause_of

    failure = each.failure
    count = len(failure.samples)
    say("", f"FAILED in {count} run{'s' if count > 1 else ''}: {failure.text}")
    changed = changes(found, failure.nearest)
    of = f"{len(changed)} of {len(found.space.parameters)} parameters"
    say(f"  smallest change that fails in this way ({of}, {failure.shrink_runs} runs to shrink):")
    for line in changed:
        say(f"    {line}")
    cause = cause_of(each.result)
    if cause is not None:
        say(f"  {cause.text}")
    say(f"  report: {report}")
    say(f"  again:  {shlex.join(['harness', 'run', str(each.file)])}")
    if not each.is_same:
        say(
            f"  the file's run has the digest {each.result.digest[:12]}, and not"
            f" {failure.nearest.result.digest[:12]} as the run that was found"
        )
