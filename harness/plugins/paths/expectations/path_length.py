"""path_length: how far the TCP travels."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from harness.core.amounts import amounts
from harness.judging.expectation import Predicate
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.window import Window
from harness.language.base import PositiveLength
from harness.language.expectation import Quantity
from harness.recording.verdict import Measure

LENGTH = Quantity("path length", "m", "at most `at_most`, at least `at_least`", "tcp")


class PathLength(Predicate):
    """The TCP travels at most or at least a given distance."""

    short = "at_most"
    some_of = ("at_most", "at_least")
    sentence = "path length is[ at least {at_least}][ at most {at_most}]"
    quantities = (LENGTH,)

    at_most: PositiveLength | None = Field(
        default=None, description="The longest distance that the TCP may travel [m]."
    )
    at_least: PositiveLength | None = Field(
        default=None, description="The shortest distance that the TCP may travel [m]."
    )

    def signal(self, window: Window) -> MarginSignal:
        """Distance travelled by the TCP since the window's start [m]."""
        moves = np.diff(window.tcp_position, axis=0)
        travelled = np.concatenate([[0.0], np.cumsum(np.linalg.norm(moves, axis=1))])
        parts: list[Part] = []
        if self.at_most is not None:
            parts.append(Part(LENGTH, travelled, self.at_most, "<="))
        if self.at_least is not None:
            parts.append(Part(LENGTH, travelled, self.at_least, ">="))

        def text(_: int, measure: Measure) -> str:
            bound = "at most" if measure.comparison == "<=" else "at least"
            travelled, limit = amounts(measure.value, measure.limit, "m")
            return f"the TCP travelled {travelled}, {bound} {limit} required"

        return all_of(window, parts, text)
