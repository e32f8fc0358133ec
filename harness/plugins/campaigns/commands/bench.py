"""`harness bench`: planners compared on the motions of scenarios."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import ClassVar

from harness.cli.arguments import whole_number
from harness.cli.command import SEARCHES, Command
from harness.cli.output import complain, say, say_json, say_text
from harness.cli.shared_options import add_json, add_paths, add_report_dir
from harness.cli.work_bar import WorkBar
from harness.core.errors import SpecError
from harness.suite.discovery import UsageError, discover
from harness.suite.outcome import EXIT_CODES


class BenchCommand(Command):
    """Compare planners on the motions of scenarios."""

    name: ClassVar[str] = "bench"
    group: ClassVar[str] = SEARCHES

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness bench`."""
        add_paths(command)
        add = command.add_argument
        text = "planners and pipelines to compare (default: all that `harness list planners` names)"
        add("--planners", metavar="A,B", type=_planner_names, default=[], help=text)
        text = "plan with seeds 1 to N (default: 5)"
        add("--seeds", metavar="N", type=whole_number, default=5, help=text)
        add_report_dir(command, "write files into DIR/bench")
        add("--no-report", action="store_true", help="write no files")
        add_json(command)

    def run(self, arguments: argparse.Namespace) -> int:
        """Plan every free motion with every planner and seed; print, plot, and keep the numbers."""
        from harness.planning.search.find_pipeline import planner_names
        from harness.plugins.campaigns.bench.planner_choice import with_planner
        from harness.ports.motion_planning import PlanningOptions

        planners = arguments.planners or list(planner_names())
        for planner in planners:
            try:
                with_planner(PlanningOptions(), planner)
            except ValueError as error:
                raise UsageError(f"--planners: {error}") from error
        files = discover(arguments.paths)
        code, found = _bench(arguments, files, planners)
        if arguments.json:
            say_json(found)
        return code


def _planner_names(text: str) -> list[str]:
    names = [name.strip() for name in text.split(",") if name.strip()]
    if not names:
        raise argparse.ArgumentTypeError("no planner is named")
    return list(dict.fromkeys(names))


def _bench(
    arguments: argparse.Namespace, files: list[Path], planners: list[str]
) -> tuple[int, object]:
    from harness.plugins.campaigns.bench.collect import MotionTrials, collect
    from harness.plugins.campaigns.bench.results import PICTURE, document, write_bench
    from harness.plugins.campaigns.bench.summary import failure_lines, motion_line, planner_table

    seeds = list(range(1, arguments.seeds + 1))
    motions: list[MotionTrials] = []
    code, work_bar = 0, WorkBar()
    for file in files:
        try:
            motions += collect(
                file,
                planners,
                seeds,
                lambda motion: say(motion_line(motion)),
                overrides=dict(arguments.overrides),
                on_trial=work_bar,
            )
        except SpecError as error:
            complain(str(error))
            code = EXIT_CODES["invalid"]
    searched = sum(motion.is_searched for motion in motions)
    if not searched:
        say(f"nothing to compare: {len(motions)} motions by `move_to`, none of them searched")
        return code, document(motions, planners, seeds)
    say("", f"{searched} of {len(motions)} motions are searched, {len(seeds)} seeds; medians:")
    say_text(planner_table(motions, planners))
    say(*failure_lines(motions, planners))
    if not arguments.no_report:
        folder = Path(arguments.report_dir) / "bench"
        write_bench(folder, motions, planners, seeds)
        say(f"picture: {folder / PICTURE}", f"numbers: {folder / 'results.json'}")
    return code, document(motions, planners, seeds)
