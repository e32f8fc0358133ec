"""`harness judge`: the expectations again, on a saved run."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from harness.cli.command import RESULTS, Command
from harness.cli.files import run_folder
from harness.cli.output import say, say_json
from harness.cli.shared_options import add_json, add_plugin
from harness.session.run_request import STRICT
from harness.suite.discovery import UsageError
from harness.suite.outcome import EXIT_CODES

if TYPE_CHECKING:
    from harness.recording.signals import ContactRecord
    from harness.recording.verdict import Verdict
    from harness.reporting.terminal import Style


class JudgeCommand(Command):
    """Judge a saved run again."""

    name: ClassVar[str] = "judge"
    group: ClassVar[str] = RESULTS
    reads_geometry: ClassVar[bool] = True

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness judge`."""
        add = command.add_argument
        add("folder", metavar="RUN", help="the run's report folder")
        text = "judge by the expectations of this scenario instead"
        add("--with", metavar="FILE", dest="with_file", help=text)
        add_plugin(command)
        text = "list all contacts: bodies, first time, duration, peak force"
        add("--contacts", action="store_true", help=text)
        add("--strict", action="store_true", help=STRICT)
        add_json(command)

    def run(self, arguments: argparse.Namespace) -> int:
        """Judge a run's folder and print every verdict."""
        folder = run_folder(arguments.folder)
        from harness.plugins.comparison.rejudge import judge_stored
        from harness.recording.read_run import read_run
        from harness.recording.stored_run import blames_changes
        from harness.session.observation.contacts import contact_records

        with_file = Path(arguments.with_file) if arguments.with_file else None
        if with_file and not with_file.is_file():
            raise UsageError(f"no such file: '{with_file}'")
        stored = read_run(folder)
        run, ended_early, changes = stored.run, stored.run.ended_early, stored.changes()
        with blames_changes(folder, stored):
            verdicts = judge_stored(stored, folder, with_file)
            contacts = contact_records(run)
        has_passed = bool(verdicts) and all(verdict.status == "passed" for verdict in verdicts)
        # half a run, and a run that is not as it was recorded, is no run that passed
        has_passed = has_passed and not ended_early and not changes
        if arguments.strict:
            has_passed = has_passed and not any(verdict.warnings for verdict in verdicts)
        code = 0 if has_passed else EXIT_CODES["failed"]
        if arguments.json:
            found = {"verdicts": verdicts, "contacts": contacts, "changes": changes}
            say_json({"format": "armharness-verdicts/1", "exit_code": code, **found})
            return code
        from harness.reporting.terminal import Style

        style = Style.of(sys.stdout)
        for verdict in verdicts:
            say(*_verdict_lines(verdict, style))
        if arguments.contacts:
            say(*contact_lines(contacts, style))
        held = sum(verdict.status == "passed" for verdict in verdicts)
        say(f"{held} of {len(verdicts)} expectations hold" if verdicts else "nothing is expected")
        for change in changes:
            say(f"{style.bad('changed')}  {change}")
        if ended_early:
            say(f"the run ended early with {ended_early}: it has failed, whatever holds until then")
        return code


def _verdict_lines(verdict: Verdict, style: Style) -> Iterator[str]:
    """A verdict with its warnings, and the measures of one that did not pass."""
    from harness.reporting.terminal import measure_text, verdict_line

    place = f"line {verdict.line}: " if verdict.line else ""
    mark = style.mark(verdict.status == "passed")
    yield f"{mark} {place}{verdict.expectation}: {verdict_line(verdict)}"
    yield from (f"    warning: {warning}" for warning in verdict.warnings)
    if verdict.status != "passed":
        yield from (f"    {measure_text(measure)}" for measure in verdict.measures)


def contact_lines(contacts: Sequence[ContactRecord], style: Style) -> Iterator[str]:
    """Lines of a table of contacts by their first time; collisions are marked."""
    if not contacts:
        yield "contacts: none"
        return
    names = [" and ".join(contact.pair) for contact in contacts]
    width = max(map(len, names))
    yield style.strong(f"{'contacts':<{width}}  {'first':>9}  {'for':>9}  {'at most':>10}")
    for name, contact in zip(names, contacts, strict=True):
        times = f"{contact.first_time:>7.3f} s  {contact.duration:>7.3f} s"
        mark = style.bad("  collision") if contact.is_collision else ""
        yield f"{name:<{width}}  {times}  {contact.peak_force:>8.2f} N{mark}"
