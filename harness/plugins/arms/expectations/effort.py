"""effort: joint efforts stay below a share of their limits."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from harness.judging.expectation import Predicate
from harness.judging.joints import ROUNDING, is_measured
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.window import NotObservable, Window
from harness.language.base import Fraction
from harness.language.expectation import Quantity
from harness.recording.verdict import Measure

EFFORT = Quantity("effort", "1", "at most `max_fraction`, for each joint", "effort")


class Effort(Predicate):
    """Joint efforts stay below a share of their limits."""

    short = "max_fraction"
    judged = "always"
    sentence = "effort is at most {max_fraction} of its limit"
    quantities = (EFFORT,)
    is_upper_bound = True

    max_fraction: Fraction = Field(
        default=1.0,
        description="The largest share of its effort limit that a joint may use; 1 is the limit,"
        " which a simulated motor never exceeds.",
    )

    def signal(self, window: Window) -> MarginSignal:
        """Largest share of its effort limit that a joint uses."""
        efforts = window.run.signals.joint_efforts
        parts = [
            Part(
                EFFORT,
                np.abs(window.cut(efforts)[:, column]) / joint.effort,
                self.max_fraction * (1 + ROUNDING),
                "<=",
                detail=joint.name,
            )
            for column, joint in enumerate(window.run.robot.movable_joints)
            if math.isfinite(joint.effort)
            and joint.effort > 0
            and is_measured(efforts[:, column], joint, "effort")
        ]
        if not parts:
            raise NotObservable("no effort limits are known")

        def text(_: int, measure: Measure) -> str:
            return f"{measure.detail} uses {100 * measure.value:.1f} % of its effort limit"

        return all_of(window, parts, text, shown=3)
