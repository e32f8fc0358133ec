"""An expectation with its place in the file."""

from __future__ import annotations

from dataclasses import dataclass

from harness.cell.scope import At, Scope
from harness.judging.expectation import Expectation
from harness.language.expectation import ExpectationFields
from harness.language.files.source import Loc


@dataclass(frozen=True)
class PlacedExpectation:
    """An expectation, the step that it is judged over, and its place in the file.

    Attributes:
        spec: The model of the expectation.
        step: Id (or path) of the step it stands on; empty for the whole run.
        line: The line in the scenario file, from 1; 0 if unknown.
    """

    spec: Expectation
    step: str = ""
    line: int = 0

    @classmethod
    def of(cls, spec: ExpectationFields, step: str, line: int) -> PlacedExpectation:
        """An expectation of a file with its place.

        Raises:
            TypeError: The class of its word is no expectation.
        """
        return cls(as_expectation(spec), step, line)


def as_expectation(spec: ExpectationFields) -> Expectation:
    """A file's expectation as what can be checked and judged.

    Raises:
        TypeError: The class of its word is no expectation.
    """
    if not isinstance(spec, Expectation):
        raise TypeError(f"{type(spec).__name__} is no subclass of Expectation")
    return spec


def check_expectation(spec: Expectation, loc: Loc, scope: Scope) -> None:
    """Report what is wrong with an expectation; names may be of steps and objects further down."""
    if spec.during is not None and spec.during not in scope.step_ids:
        scope.problems.unknown(
            (*loc, "during"), "step with the id", spec.during, scope.step_ids, needs=()
        )
    if loc[0] == "expect" and len(loc) == 2:
        _check_step_is_named(spec, loc, scope)
    for key, inner in spec.predicates().items():
        check_expectation(inner, (*loc, key), scope)
    spec.check(At(scope, loc))


def _check_step_is_named(spec: Expectation, loc: Loc, scope: Scope) -> None:
    """Report an expectation of the whole run that can be judged only over a step."""
    parts = (spec, *spec.predicates().values())
    why = next((part.needs_step() for part in parts if part.needs_step()), "")
    if why and not any(part.during for part in parts):
        scope.problems.add(
            loc,
            f"{why}; this is expected of the whole run",
            "write it under the step's `expect`, or name the step with `during`",
        )
