"""Judge a saved run again, by its own expectations or by another file's."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from harness.assertions.judge import judge
from harness.assertions.placed import PlacedExpectation
from harness.recording.run import Run, Verdict
from harness.recording.store import RESOLVED, read_run
from harness.spec.load import LoadedScenario, load_scenario
from harness.spec.step import Block


def judge_run(run_dir: Path, with_file: Path | None = None) -> tuple[Verdict, ...]:
    """Verdicts of a saved run; needs neither planner nor physics.

    Args:
        run_dir: A report folder.
        with_file: A scenario file whose expectations are judged instead of the run's own.

    Raises:
        HarnessError: The folder holds no run.
        SpecError: The scenario cannot be read.
    """
    return judge_again(read_run(run_dir).run, with_file or run_dir / RESOLVED)


def judge_again(run: Run, scenario: Path) -> tuple[Verdict, ...]:
    """Verdicts of a run by the expectations of a scenario file.

    Raises:
        SpecError: The scenario cannot be read.
    """
    return judge(run, expectations_of(load_scenario(scenario)))


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
