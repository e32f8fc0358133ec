"""`harness replay`: the recorded commands of external programs, once more."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import ClassVar

from harness.cli.command import EXCHANGE, Command
from harness.cli.files import run_folder
from harness.cli.output import say, say_json
from harness.cli.shared_options import add_json, add_plugin
from harness.suite.discovery import UsageError
from harness.suite.environment import prepare_process
from harness.suite.outcome import EXIT_CODES


class ReplayCommand(Command):
    """Run the recorded commands of ROS 2 nodes again."""

    name: ClassVar[str] = "replay"
    group: ClassVar[str] = EXCHANGE

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness replay`."""
        command.add_argument("run", metavar="RUN", help="the run's report folder")
        text = "write the replayed run into this folder"
        command.add_argument("--report-dir", metavar="DIR", default="", help=text)
        add_json(command)
        add_plugin(command)
        command.set_defaults(ticks=False)

    def run(self, arguments: argparse.Namespace) -> int:
        """Run a recorded command stream again; exit code 1 when the digest differs.

        Raises:
            UsageError: No command is recorded.
        """
        folder = run_folder(arguments.run)
        prepare_process()
        from harness.plugins.ros.handover import replay
        from harness.recording.read_run import read_run
        from harness.recording.stored_run import RESOLVED

        target = Path(arguments.report_dir) if arguments.report_dir else None
        recorded = read_run(folder)
        if not recorded.run.commands:
            raise UsageError(
                f"'{folder}' has no recorded commands of ROS 2 nodes, which are what is replayed; a"
                f" scenario without nodes runs again with `harness run {folder / RESOLVED}`"
            )
        case = replay(folder, target)
        is_equal = case.digest == recorded.digest
        count = sum(command.kind != "end" for command in recorded.run.commands)
        if arguments.json:
            say_json(
                {
                    "format": "armharness-replay/1",
                    "outcome": case.outcome,
                    "commands": count,
                    "digest": case.digest,
                    "recorded_digest": recorded.digest,
                    "is_equal": is_equal,
                }
            )
        else:
            say(f"{count} commands replayed; {case.outcome}")
            if not case.digest:
                say(case.message)
            elif is_equal:
                say(f"digest {case.digest[:12]}, equal to the recorded one")
            else:
                say(f"digest {case.digest[:12]}, recorded was {recorded.digest[:12]}")
        return 0 if is_equal else EXIT_CODES["failed"]
