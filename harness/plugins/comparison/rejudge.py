"""Judge a saved run again, by its own expectations or by another file's."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from itertools import repeat
from pathlib import Path

from harness.judging.judge import judge
from harness.judging.placed import PlacedExpectation
from harness.language.reading.load import LoadedScenario, load_scenario
from harness.language.step import Block
from harness.recording.stored_run import RESOLVED, StoredRun
from harness.recording.verdict import Verdict


def judge_stored(
    stored: StoredRun, run_dir: Path, with_file: Path | None = None
) -> tuple[Verdict, ...]:
    """Verdicts of a saved run; its own expectations keep their lines.

    Args:
        with_file: A scenario whose expectations are judged instead of the run's own.

    Raises:
        SpecError: The scenario cannot be read.
    """
    placed = expectations_of(load_scenario(with_file or run_dir / RESOLVED))
    if with_file is None:
        placed = _at_lines_of(stored.verdicts, placed)
    return judge(stored.run, placed)


def _at_lines_of(
    verdicts: Sequence[Verdict], placed: Sequence[PlacedExpectation]
) -> list[PlacedExpectation]:
    """Expectations of the resolved file, which is written out, at the lines of the file that ran.

    Those of a step, and those of the run, have the order of their verdicts; where their number
    differs, their lines are not known.
    """
    lines: dict[str, list[int]] = {}
    for verdict in verdicts:
        lines.setdefault(verdict.step, []).append(verdict.line)
    counts = Counter(each.step for each in placed)
    known = {step: iter(found) for step, found in lines.items() if len(found) == counts[step]}
    return [replace(each, line=next(known.get(each.step, repeat(0)))) for each in placed]


def expectations_of(loaded: LoadedScenario) -> list[PlacedExpectation]:
    """Every expectation of a file, those of steps first."""
    found: list[PlacedExpectation] = []

    def visit(block: Block) -> None:
        for index, step in enumerate(block.steps):
            loc, path = (*block.loc, index), f"{block.path}[{index}]"
            for inner in step.blocks(loc, path):
                visit(replace(inner, suffix=block.suffix + inner.suffix))
            step_id = f"{step.id}{block.suffix}" if step.id else path
            for number, spec in enumerate(step.expect):
                line, _ = loaded.lines.line_of((*loc, "expect", number))
                found.append(PlacedExpectation.of(spec, step_id, line))

    visit(Block(loaded.scenario.steps, ("steps",), "steps"))
    for number, spec in enumerate(loaded.scenario.expect):
        line, _ = loaded.lines.line_of(("expect", number))
        found.append(PlacedExpectation.of(spec, "", line))
    return found
