"""`harness check`: the problems of a file that can be found without physics."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import ClassVar

from harness.cli.command import SCENARIOS, Command
from harness.cli.output import output, say, say_json, say_text
from harness.cli.shared_options import add_format, add_paths, add_seed
from harness.cli.work_bar import WorkBar
from harness.core.errors import Problem
from harness.core.printable import counted
from harness.suite.discovery import discover
from harness.suite.header import read_header
from harness.suite.outcome import EXIT_CODES

MOST_CASES = 100  # parametrised cases of a file that are checked; running them checks the rest


class CheckCommand(Command):
    """Validate scenarios and the reach of their goals."""

    name: ClassVar[str] = "check"
    group: ClassVar[str] = SCENARIOS
    reads_geometry: ClassVar[bool] = True

    def add_options(self, command: argparse.ArgumentParser) -> None:
        add_paths(command)
        add_seed(command)
        add_format(command, sarif="one document for code scanning, SARIF 2.1.0")

    def run(self, arguments: argparse.Namespace) -> int:
        files = discover(arguments.paths)
        from harness.reporting.sarif import sarif_document
        from harness.reporting.suite.cause import short_problem
        from harness.reporting.suite.github import problem_annotation
        from harness.reporting.terminal import Style
        from harness.session.check import check_file

        style = Style.of(sys.stdout)
        code = 0
        documents: list[object] = []
        lines: list[str] = []
        problems: list[Problem] = []
        predicted: list[Problem] = []
        format_problem = problem_annotation if arguments.format == "github" else short_problem
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
                lines += [
                    format_problem(problem) for problem in (*found.problems, *found.predicted)
                ]
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
            return code
        if arguments.format == "sarif":
            say_json(sarif_document(problems, predicted))
            return code
        write = output().command if arguments.format == "github" else say
        for line in dict.fromkeys(lines):
            write(line)
        if arguments.format == "short" and not code:
            say(f"{counted(len(documents), 'case')} checked, no problem found")
        return code


def _cases(
    arguments: argparse.Namespace, files: Sequence[Path]
) -> Iterator[tuple[Path, str, dict[str, str]]]:
    """File, case and its values, of every parametrised case; random values are as the file says."""
    for file in files:
        overrides = dict(arguments.overrides)
        for case in islice(read_header(file, overrides).variation.parametrized(), MOST_CASES):
            yield file, case.name, {**case.overrides, **overrides}
