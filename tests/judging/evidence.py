"""Evidence that an expectation cannot pass wrongly, and where the tests find it.

The test module of an expectation states its evidence as `EVIDENCE`, and `test_three_runs`,
`test_mutations`, `test_metamorphic` and the pictures of the reference judge what these modules
state.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path

from harness.recording.run import Run

AT_ONCE, DRIFT = COURSES = ("at once", "as a drift")


@dataclass(frozen=True, eq=False)
class Three:
    """An expectation on three runs.

    Attributes:
        never: A run that it says nothing of; default one in which its step was not reached.
        by: Margin of the run that barely fails, in `unit`.
        during: The step it is judged over, in the first two runs.
    """

    spec: object
    satisfied: Run
    barely: Run
    by: float
    unit: str
    never: Run | None = None
    during: str = ""


@dataclass(frozen=True)
class Free:
    """Shifts of a signal that an expectation may not notice, by its definition.

    Attributes:
        reason: Why they make no difference.
        cases: Names of cases; a predicate's second case is `formula 2`.
        signals: Names of fields; of one key only: `presses right_finger`.
        directions: `+x`, or `+-x` for either way.
        courses: In which they are free.
    """

    reason: str
    cases: str
    signals: str
    directions: str
    courses: tuple[str, ...] = COURSES


@dataclass(frozen=True, eq=False)
class Evidence:
    """What the test module of an expectation states.

    Attributes:
        three_runs: Runs that pass, barely fail, and never reach the expectation.
        mutation_cases: Expectation, run and step: no corrupted signal of the run may pass.
        picture: A passing and a failing expectation, each with its scene in `picture_scenes`.
        free_shifts: Shifts of a signal that make no difference.
    """

    three_runs: tuple[Three, ...] = ()
    mutation_cases: tuple[tuple[object, Run, str], ...] = ()
    picture: tuple[tuple[str, str], ...] = ()
    free_shifts: tuple[Free, ...] = ()


@cache
def collected() -> tuple[Evidence, ...]:
    """The evidence of each test module that states some."""
    root = Path(__file__).parents[2]
    files = [
        file
        for folder in ("tests/judging/expectations", "tests/judging")
        for file in sorted((root / folder).glob("test_*.py"))
        if re.search(r"^EVIDENCE = ", file.read_text(encoding="utf-8"), re.MULTILINE)
    ]
    names = [".".join(file.relative_to(root).with_suffix("").parts) for file in files]
    return tuple(import_module(name).EVIDENCE for name in names)


def word_of(spec: object) -> str:
    """The word of an expectation, or of the one inside a temporal word."""
    return getattr(spec, "predicate", spec).word


def pictures() -> dict[str, tuple[tuple[str, str], ...]]:
    """A passing and a failing expectation with their scenes, by the word of the expectation."""
    return {
        word_of(evidence.three_runs[0].spec): evidence.picture
        for evidence in collected()
        if evidence.picture
    }
