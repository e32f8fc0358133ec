"""path_efficiency: how direct the TCP's way is."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field

from harness.judging.expectation import Predicate
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.window import NotReached, Window
from harness.language.base import Fraction
from harness.language.expectation import Judged, Quantity
from harness.recording.verdict import Measure

EFFICIENCY = Quantity("path efficiency", "1", "at least `at_least`", "tcp")
LEAST_WAY = 0.001  # [m]: of less, the direction is that of the servo's trembling


class PathEfficiency(Predicate):
    """The TCP's way is nearly straight: the distance from its start, over the way travelled.

    A straight line has 1, half a circle 2 / pi, and a way there and back 0. Judged over a window in
    which the TCP travels less than 1 mm, it is not reached.
    """

    short = "at_least"
    judged: ClassVar[Judged] = "at_end"
    sentence = "path efficiency is at least {at_least}"
    quantities = (EFFICIENCY,)
    synonyms = ("directness", "straightness")

    at_least: Fraction = Field(
        description="The smallest share that the distance from the start has of the way travelled."
    )

    def signal(self, window: Window) -> MarginSignal:
        """Distance from the window's start over the way travelled since then.

        Raises:
            NotReached: The TCP travels less than 1 mm in the window.
        """
        places = window.tcp_position
        steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
        travelled = np.concatenate([[0.0], np.cumsum(steps)])
        if travelled[-1] < LEAST_WAY:
            raise NotReached(f"the TCP travels {1e3 * travelled[-1]:.2g} mm, 1 mm are judged")
        distance = np.linalg.norm(places - places[0], axis=1)
        share = np.where(travelled < LEAST_WAY, 1.0, distance / np.maximum(travelled, LEAST_WAY))

        def text(index: int, measure: Measure) -> str:
            return (
                f"the TCP is {1e3 * distance[index]:.4g} mm from its start after"
                f" {1e3 * travelled[index]:.4g} mm: {measure.value:.3g}, at least"
                f" {self.at_least:g} required"
            )

        return all_of(window, [Part(EFFICIENCY, share, self.at_least, ">=")], text)
