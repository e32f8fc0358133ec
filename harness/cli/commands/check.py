"""`harness check`: the problems of a file that can be found without physics."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from harness.cli.command import SCENARIOS, Command
from harness.cli.output import say, say_document, say_json, say_text
from harness.cli.shared_options import add_format, add_paths, add_seed
from harness.cli.work_bar import WorkBar
from harness.core.errors import Problem
from harness.core.printable import counted
from harness.core.registry import registry
from harness.suite.discovery import discover
from harness.suite.header import read_header
from harness.suite.outcome import EXIT_CODES

if TYPE_CHECKING:
    from harness.reporting.suite.result_format import ResultFormat

MOST_CASES = 100  # parametrised cases of a file that are checked; running them checks the rest


class CheckCommand(Command):
    """Validate scenarios and the reach of their goals."""

    name: ClassVar[str] = "check"
    group: ClassVar[str] = SCENARIOS
    reads_geometry: ClassVar[bool] = True

    def add_options(self, command: argparse.ArgumentParser) -> None:
        add_paths(command)
        add_seed(command)
        add_format(command, is_of_runs=False)

    def run(self, arguments: argparse.Namespace) -> int:
        files = discover(arguments.paths)
        from harness.reporting.suite.cause import short_problem
        from harness.reporting.terminal import Style
        from harness.session.check import check_file

        style = Style.of(sys.stdout)
        code = 0
        documents: list[object] = []
        problems: list[Problem] = []
        predicted: list[Problem] = []
        work_bar = WorkBar()
        for number, (file, case, overrides) in enumerate(_cases(arguments, files)):
            if len(files) > 1:
                work_bar("checking", number, max(number + 1, len(files)))
            found = check_file(file, overrides=overrides, seed=arguments.seed)
            outcome = "invalid" if found.problems else "failed" if found.predicted else "passed"
            code = max(code, EXIT_CODES[outcome])
            documents.append({"file": str(file), "case": case, "outcome": outcome,
                              "problems": found.problems,
                              "predicted": found.predicted,
                              "explanations": found.explanations,
                              "notes": found.notes})  # fmt: skip
            problems += found.problems
            predicted += found.predicted
            if arguments.format != "full":
                continue
            for note in found.notes:
                say(f"note: {note}")
            for problem in found.problems:
                say_text(str(problem))
            for problem, explained in zip(found.predicted, found.explanations, strict=True):
                say_text(str(problem))
                say(*(f"    {line}" for line in explained))
            count = len(found.problems)
            summaries = {
                "invalid": counted(count, "problem"),
                "failed": "steps that will fail",
                "passed": "ok",
            }
            name = f"{file} [{case}]" if case else str(file)
            say(f"{name}: {style.outcome(outcome, summaries[outcome])}")
        if arguments.format == "json":
            say_json({"format": "armharness-check/1", "exit_code": code, "files": documents})
        elif arguments.format == "short":
            say(*dict.fromkeys(map(short_problem, (*problems, *predicted))))
            if not code:
                say(f"{counted(len(documents), 'case')} checked, no problem found")
        elif arguments.format != "full":
            chosen: ResultFormat = registry("result_format")[arguments.format]()
            say_document(chosen.problems(problems, predicted))
        return code


def _cases(
    arguments: argparse.Namespace, files: Sequence[Path]
) -> Iterator[tuple[Path, str, dict[str, str]]]:
    """File, case and its values, of every parametrised case; random values are as the file says."""
    for file in files:
        overrides = dict(arguments.overrides)
        for case in islice(read_header(file, overrides).variation.parametrized(), MOST_CASES):
            yield file, case.name, {**case.overrides, **overrides}
