"""`harness run`: scenarios, with their progress and results."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from harness.cli.command import SCENARIOS, Command
from harness.cli.options import add_options, read_options
from harness.cli.output import only_json_on_stdout, output
from harness.cli.run_mode import RunCall, RunFiles, RunMode
from harness.cli.shared_options import (
    add_format,
    add_hard_cap,
    add_history,
    add_node,
    add_paths,
    add_report_dir,
    add_seed,
    add_verbose,
)
from harness.cli.suite_output import (
    show_interruption,
    show_json,
    show_lines,
    show_results,
    write_suite_files,
)
from harness.core.lazy import LazySequence
from harness.core.registry import registry
from harness.suite.case_runner import case_runner
from harness.suite.discovery import UsageError, discover
from harness.suite.request import SuiteRequest

if TYPE_CHECKING:
    from harness.reporting.result import CaseResult
    from harness.suite.suite_run import SuiteRun

BRIEF_FROM = 20  # with more runs than this a passed one is a line, without its steps


class RunCommand(Command):
    """Run scenarios and judge them."""

    name: ClassVar[str] = "run"
    group: ClassVar[str] = SCENARIOS
    writes_json_in_parts: ClassVar[bool] = True
    collects_garbage: ClassVar[bool] = True

    def __init__(self) -> None:
        self._modes: list[RunMode] = [mode() for mode in registry("run_mode").built_in()]

    def add_options(self, command: argparse.ArgumentParser) -> None:
        add_paths(command)
        add_seed(command)
        add_options(command, SuiteRequest)
        add_report_dir(command)
        command.add_argument("--no-report", action="store_true", help="write no report")
        text = "write the report without its page"
        command.add_argument("--no-page", action="store_true", help=text)
        add_history(command)
        add_format(command)
        add_verbose(command)
        add_hard_cap(command, "scenario")
        add_node(command, "the step `external` to start this command")
        for mode in self._modes:
            mode.add_options(command)

    def run(self, arguments: argparse.Namespace) -> int:
        """Run scenarios; print steps and outcomes as they come, and failures last."""
        run_files: RunFiles = _run_files
        for mode in self._modes:
            run_files = partial(mode.run, run_files)
        return run_files(RunCall(arguments, discover(arguments.paths)))


def _run_files(call: RunCall) -> int:
    start, arguments, hooks = time.monotonic(), call.arguments, call.hooks
    from harness.suite.warm import WarmServer

    with WarmServer() as server:
        if not arguments.in_process and hooks.execute is None:
            server.open()  # it imports for as long as this process takes to get ready
        suite = _suite(call)
        arrived = hooks.begun(suite) if hooks.begun is not None else lambda _index: None
        from harness.cli.progress import ProgressLines, slow_work_on_stderr

        if arguments.format != "full":
            is_json = arguments.format == "json"
            with only_json_on_stdout() if is_json else nullcontext():
                suite.collect(server, slow_work_on_stderr, lambda index, _result: arrived(index))
                write_suite_files(arguments, suite, hooks)
                show_interruption(arguments, suite, time.monotonic() - start)
            return show_json(suite) if is_json else show_lines(arguments, suite)
        from harness.reporting.terminal import Style

        names = _case_names(arguments, suite)
        has_rates = arguments.repeat == 1 and len(names) > 1 and not arguments.verbose
        progress = ProgressLines(
            output(),
            names,
            is_side_by_side=arguments.workers > 1 and not arguments.in_process,
            is_brief=len(names) > BRIEF_FROM,
            is_folded=lambda index: has_rates and suite.plan[index].rate_key is not None,
            style=Style.of(sys.stdout, is_verbose=arguments.verbose),
        )

        def on_result(index: int, result: CaseResult) -> None:
            progress.result(index, result)
            arrived(index)

        suite.collect(server, progress.step, on_result)
        output().status(lambda: "  writing the results")
    page, columns = write_suite_files(arguments, suite, hooks)
    output().status(None)
    show_results(arguments, suite, time.monotonic() - start, page, columns)
    return suite.exit_code


def _suite(call: RunCall) -> SuiteRun:
    from harness.core.errors import HarnessError
    from harness.reporting.reporter import check_reporters
    from harness.session.run_request import named_commands
    from harness.suite.plan import planned_cases
    from harness.suite.suite_run import SuiteRun

    arguments, files, hooks = call.arguments, call.files, call.hooks
    if arguments.nodes:
        case_runner("nodes")  # refuses where no plug-in runs them
    if arguments.history and not Path(arguments.history).is_dir():
        raise UsageError(f"--history '{arguments.history}' is no folder")
    root = None if arguments.no_report else Path(arguments.report_dir)
    try:
        check_reporters([*arguments.reporters, *["rosbag"] * arguments.bag], root)
    except HarnessError as error:
        raise UsageError(f"--reporter: {error}") from error
    request = read_options(
        arguments,
        SuiteRequest,
        overrides=dict(arguments.overrides),
        nodes=named_commands(arguments.nodes) if arguments.nodes else {},
        report_root=root,
        loading=(
            *(f"--package-path={folder}" for folder in arguments.package_folders),
            *(f"--plugin={module}" for module in arguments.plugins),
        ),
        page=not arguments.no_page,
        hooks=hooks,
    )
    plan = planned_cases(files, request)
    if hooks.planned is not None:
        hooks.planned(files, request)
    return SuiteRun(plan, request, files)


def _case_names(arguments: argparse.Namespace, suite: SuiteRun) -> Sequence[str]:
    repeat = arguments.repeat

    def name(index: int) -> str:
        planned = suite.plan[index // repeat]
        file = planned.file
        shown = str(file) if arguments.workers == 1 else file.name.split(".")[0]
        case = f" [{planned.name}]" if planned.name else ""
        return f"{shown}{case}" + (f" #{index % repeat + 1}" if repeat > 1 else "")

    return LazySequence(len(suite.jobs), name)
