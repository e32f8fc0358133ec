"""The options of pipelines, for `harness run` and for results that are there already."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from harness.cli.arguments import output_file, share_of_one
from harness.cli.output import complain, output, say
from harness.core.files import is_file, replaced, writing
from harness.core.printable import counted
from harness.suite.discovery import UsageError
from harness.suite.folders import refuse_unwritable_file
from harness.suite.outcome import EXIT_CODES

if TYPE_CHECKING:  # the options of `harness run` need none of this
    from harness.plugins.ci.baseline import ShrunkMargin
    from harness.plugins.ci.results import SavedSuite

KEEP = 0.5  # Share of an earlier margin that has to remain: half may be lost unnoticed


def add_gate_options(command: argparse.ArgumentParser) -> None:
    """Add the baseline of margins, and the files that pipelines read."""
    add = command.add_argument_group("options for pipelines").add_argument
    text = "fail when a margin of this file shrank, before the expectation itself fails"
    add("--baseline", metavar="FILE", default="", help=text)
    text = "write the margins of the cases that passed into the file of --baseline, after a review"
    add("--update-baseline", action="store_true", help=text)
    text = f"the share of each earlier margin that has to remain (default: {KEEP})"
    add("--keep-margin", metavar="SHARE", type=share_of_one, default=KEEP, help=text)
    text = "write the results with their margins in the Common Test Report Format (CTRF)"
    add("--ctrf", metavar="FILE", type=output_file, default="", help=text)
    text = (
        "write a comment for a pull request, in Markdown: failures, margins that shrank, a picture"
    )
    add("--comment", metavar="FILE", type=output_file, default="", help=text)
    text = "the address at which the report folder is published, for the links of --comment"
    add("--page-url", metavar="URL", default="", help=text)


def is_requested(arguments: argparse.Namespace) -> bool:
    """Whether an option of pipelines has a value.

    Raises:
        UsageError: Options contradict each other, or the baseline cannot be read or written.
    """
    baseline = Path(arguments.baseline)
    if arguments.update_baseline and not arguments.baseline:
        raise UsageError("--update-baseline goes with --baseline FILE, the file to write")
    if arguments.baseline and not (arguments.update_baseline and not is_file(baseline)):
        from harness.plugins.ci.baseline import read_baseline

        read_baseline(baseline)
    if arguments.update_baseline:
        refuse_unwritable_file(baseline, "--baseline: ")
    return bool(arguments.baseline or arguments.ctrf or arguments.comment)


def gate(arguments: argparse.Namespace, folder: Path) -> int:
    """Write what the options request from the results in a folder.

    Returns:
        The exit code: 1 where a margin shrank or is gone.
    """
    from harness.plugins.ci.comment import comment_text, shrunk_table
    from harness.plugins.ci.ctrf import ctrf_text
    from harness.plugins.ci.results import read_results

    suite = read_results(folder)
    shrunk: Sequence[ShrunkMargin] = ()
    if arguments.baseline:
        shrunk = _compare(arguments, suite)
    if shrunk and (summary := os.environ.get("GITHUB_STEP_SUMMARY")):
        with writing(Path(summary).parent), Path(summary).open("a", encoding="utf-8") as file:
            file.write("\n".join([*shrunk_table(shrunk), "", ""]))
    if arguments.ctrf:
        _write(Path(arguments.ctrf), ctrf_text(suite, Path(arguments.ctrf).parent))
    if arguments.comment:
        text = comment_text(suite, shrunk, folder, arguments.page_url)
        _write(Path(arguments.comment), text)
    return EXIT_CODES["failed" if shrunk else "passed"]


def _compare(arguments: argparse.Namespace, suite: SavedSuite) -> Sequence[ShrunkMargin]:
    """Compare margins with the baseline, or write them into it."""
    from harness.plugins.ci.baseline import new_margins, read_baseline, shrunk_margins
    from harness.plugins.ci.github import annotation

    file = Path(arguments.baseline)
    if arguments.update_baseline:
        from harness.plugins.ci.baseline import updated, write_baseline

        margins = updated(suite.cases, read_baseline(file) if file.is_file() else {})
        write_baseline(file, margins)
        say(f"wrote {counted(sum(map(len, margins.values())), 'margin')} into {file}")
        return ()
    baseline = read_baseline(file)
    shrunk = shrunk_margins(suite.cases, baseline, arguments.keep_margin)
    for each in shrunk:
        place = f"{each.file}:{each.line}" if each.line else each.file
        complain(f"{place}: {each}")
        if os.environ.get("GITHUB_ACTIONS") == "true":
            output("stderr").command(annotation(each.file, each.line, each.case, str(each)))
    if shrunk:
        complain("after a review, the same command with --update-baseline accepts these margins")
    if new := new_margins(suite.cases, baseline):
        complain(f"note: {counted(new, 'margin')} not in {file} yet; --update-baseline adds them")
    return shrunk


def _write(file: Path, text: str) -> None:
    with writing(file.parent), replaced(file) as stream:
        stream.write(text.encode())
