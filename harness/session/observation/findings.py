"""Findings: what users should know of a run besides its verdicts."""

from __future__ import annotations

from collections.abc import Sequence

from harness.cell.program import Program
from harness.cell.program_part import ProgramPart
from harness.core.errors import Problem
from harness.core.registry import registry
from harness.ports.scene import Touch
from harness.recording.run import Finding

NOTHING_EXPECTED = (
    "the scenario expects nothing, so it passes whatever happens, as long as no step fails;"
    " write what must hold below `expect:`"
)


def about_file(program: Program, notes: Sequence[Problem]) -> tuple[Finding, ...]:
    """What the scenario file allows and probably does not intend."""
    found = [Finding("note", noted(problem)) for problem in notes]
    for part in registry(ProgramPart.plugin_kind).values():
        found += [Finding("note", remark) for remark in part().remarks(program)]
    expects_errors = any(step.spec.expect_error for step in program.all_steps())
    if not program.expectations and not expects_errors:
        found.append(Finding("nothing_expected", NOTHING_EXPECTED))
    return tuple(found)


def noted(problem: Problem) -> str:
    """A remark about a place in a file, on one line."""
    return f"{problem.path}:{problem.line}:{problem.column}: {problem.message}; {problem.hint}"


def notes_of_files(notes: Sequence[str]) -> tuple[Finding, ...]:
    """What was left out of the robot's and the world's files, or assumed."""
    return tuple(Finding(kind="note", message=note) for note in notes)


def overlap_text(touch: Touch) -> str:
    """Which two bodies overlap at the start, and how deep."""
    return (
        f"at the start {touch.first} and {touch.second} overlap by {-1e3 * touch.distance:.3g} mm;"
        " the physics pushes them apart"
    )


def overlap_findings(touches: Sequence[Touch]) -> tuple[Finding, ...]:
    """Objects that are inside something when the run begins."""
    return tuple(
        Finding(
            kind="overlap",
            message=overlap_text(touch),
            time=0.0,
            values={"pair": [touch.first, touch.second], "depth": -touch.distance},
        )
        for touch in touches
    )
