"""A command: the expectations of a saved run that passed or failed most narrowly."""

import argparse

from harness.cli.command import Command, run_folder, say


class TightestCommand(Command):
    """Print the expectations of a saved run with the smallest margins."""

    name = "tightest"

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness tightest`."""
        command.add_argument("run", metavar="RUN", help="the run's report folder")
        command.add_argument("--count", metavar="N", type=int, default=3, help="how many")

    def run(self, arguments: argparse.Namespace) -> int:
        """Print a line for each; exit code 1 if one of them failed."""
        from harness.recording.read_run import read_run

        judged = list(read_run(run_folder(arguments.run)).verdicts)
        judged.sort(key=lambda each: (each.status == "passed", each.margin))
        for each in judged[: arguments.count]:
            say(f"{each.margin:g} {each.unit}  {each.expectation} ({each.status})")
        return int(any(each.status != "passed" for each in judged))
