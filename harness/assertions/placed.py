"""An expectation with its place in the file."""

from __future__ import annotations

from dataclasses import dataclass

from harness.spec.checks import AnyExpectation


@dataclass(frozen=True)
class PlacedExpectation:
    """What is expected, where it is judged, and where the file says so.

    Attributes:
        spec: The expectation's model.
        step: Id (or path) of the step it stands on; empty for the whole run.
        line: In the scenario file, from 1; 0 if unknown.
    """

    spec: AnyExpectation
    step: str = ""
    line: int = 0
