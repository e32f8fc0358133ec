"""`harness bridge`: external programs command a scenario's robot."""

from __future__ import annotations

import argparse
import signal
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from harness.cli.arguments import seconds
from harness.cli.command import EXCHANGE, Command
from harness.cli.files import one_scenario
from harness.cli.output import complain
from harness.cli.shared_options import (
    add_overrides,
    add_package_path,
    add_plugin,
    add_report_options,
)
from harness.cli.suite_output import show_case
from harness.plugins.ros.options import add_served_robot
from harness.suite.environment import prepare_process
from harness.suite.outcome import EXIT_CODES

if TYPE_CHECKING:
    from harness.plugins.ros.bridge import BridgeRequest, BridgeResult


class BridgeCommand(Command):
    """Let ROS 2 nodes command a scenario's robot."""

    name: ClassVar[str] = "bridge"
    group: ClassVar[str] = EXCHANGE

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness bridge`."""
        command.add_argument(
            "scenario", metavar="SCENARIO", help="a scenario file, or a bundled name"
        )
        add_served_robot(command)
        add_report_options(command)
        text = "end after this simulated time where no step is `external` (default: 600)"
        command.add_argument("--duration", metavar="SECONDS", type=seconds, default=None, help=text)
        add_overrides(command)
        add_package_path(command)
        add_plugin(command)
        command.set_defaults(ticks=False)

    def run(self, arguments: argparse.Namespace) -> int:
        """Serve a scenario's cell until its steps have ended."""
        prepare_process()
        from harness.plugins.ros.bridge import run_bridge
        from harness.plugins.ros.domain import domain_of_user

        domain = domain_of_user(arguments.domain)
        request = bridge_request(arguments, domain, arguments.duration)
        if arguments.duration and "steps" not in request.run.overrides:
            complain("note: --duration ends no step `external`; each ends with its own `timeout`")
        where = "this machine" if request.is_local else "the network"
        complain(f"serving {request.run.file} in ROS domain {domain} on {where}; Ctrl-C ends it")
        before = signal.getsignal(signal.SIGINT)

        def end(*_: object) -> None:
            """End the session at the first Ctrl-C, and the command at the second."""
            request.stop.set()
            signal.signal(signal.SIGINT, before)

        signal.signal(signal.SIGINT, end)
        try:
            result = run_bridge(request)
        finally:
            signal.signal(signal.SIGINT, before)
        show_case(result.case, request.run.file)
        show_remarks(result)
        return EXIT_CODES[result.case.outcome]


def bridge_request(
    arguments: argparse.Namespace, domain: int, timeout: float | None
) -> BridgeRequest:
    """What the arguments request; the steps are replaced where none hands the robot over."""
    from harness.language.reading.load import read_scenario
    from harness.plugins.ros.bridge import BridgeRequest, handed_over
    from harness.plugins.ros.steps.external import External
    from harness.session.run_request import RunRequest, named_commands
    from harness.suite.folders import report_folders

    file = one_scenario(arguments.scenario)
    folder = None
    if not arguments.no_report:
        folder = report_folders([file], Path(arguments.report_dir))[0]
    request = RunRequest(
        file,
        overrides=dict(arguments.overrides),
        seed=arguments.seed,
        report_dir=folder,
        page=not arguments.no_page,
        nodes=named_commands(arguments.nodes),
    )
    loaded = read_scenario(file, request.overrides, request.seed).loaded
    if loaded is not None and not any(isinstance(s, External) for s in loaded.scenario.steps):
        request = handed_over(request, *([timeout] if timeout else []))
        count = sum(len(step.expect) for step in loaded.scenario.steps)
        if count:
            complain(
                f"note: no step of {file} is `external`, so all of its steps are left to the nodes,"
                f" and the {count} expectations of these steps are not judged"
            )
    return BridgeRequest(
        request, domain=domain, is_local=not arguments.network, factor=arguments.pace, say=note
    )


def show_remarks(result: BridgeResult) -> None:
    """Print the remarks on wall time, names and the launched program."""
    for remark in result.remarks:
        note(remark)


def note(text: str) -> None:
    """Print a note that no result depends on."""
    complain(f"note: {text}")
