"""jerk: joints change their accelerations gently."""

from __future__ import annotations

from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from harness.cell.scope import At
from harness.core.amounts import amounts
from harness.core.types import FloatArray
from harness.judging.expectation import Predicate
from harness.judging.joints import hand_joints
from harness.judging.limits import refuse_decided
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.window import NotObservable, Window
from harness.language.base import JointJerk, PositiveDuration
from harness.language.expectation import Judged, Quantity
from harness.recording.verdict import Measure

JERK = Quantity("jerk", "rad/s**3 or m/s**3", "at most `at_most`, for each joint")


class Jerk(Predicate):
    """The arm's joints change their accelerations gently.

    An acceleration is the change of a joint's measured velocity over `window`, and the jerk is the
    change of that acceleration over the same time. Trajectories without a `max_jerk` change their
    acceleration at once, so that the number depends on the window: a change of 5 rad/s**2 is
    500 rad/s**3 over 10 ms.
    """

    short = "at_most"
    judged: ClassVar[Judged] = "always"
    sentence = "jerk is at most {at_most}"
    quantities = (JERK,)
    is_upper_bound = True

    at_most: Annotated[JointJerk, Field(gt=0)] = Field(
        description="The largest jerk of a joint [rad/s^3, m/s^3]."
    )
    window: PositiveDuration = Field(
        default=0.01,
        description="The time over which velocities and accelerations change [s]; that between two"
        " samples, where it is longer.",
    )

    def check(self, at: At) -> None:
        fastest = max((each.velocity for each in at.scope.description.movable_joints), default=0.0)
        largest = 4 * fastest / self.window**2  # the velocity changes its sign twice
        if largest > 0:
            hint = "give a smaller one, or a shorter `window`"
            refuse_decided(at, "at_most", "<=", self.at_most, (0.0, largest), "the jerk", hint)

    def signal(self, window: Window) -> MarginSignal:
        """Largest jerk of a joint at each sample [rad/s^3 or m/s^3].

        Raises:
            NotObservable: No velocities of the arm's joints were recorded.
        """
        run = window.run
        velocities, times = run.signals.joint_velocities, run.signals.times
        span = max(self.window, float(np.median(np.diff(times)))) if len(times) > 1 else self.window
        hands = hand_joints(run.robot)
        parts = [
            Part(
                JERK,
                window.cut(_jerk(velocities[:, column], times, span)),
                self.at_most,
                "<=",
                detail=joint.name,
                measured_unit=f"{joint.position_unit}/s**3",
            )
            for column, joint in enumerate(run.robot.movable_joints)
            if joint.name not in hands and not joint.is_mimic
        ]
        if not parts:
            raise NotObservable("the robot has no joints besides its gripper's")

        def text(_: int, measure: Measure) -> str:
            jerk, most = amounts(measure.value, measure.limit, measure.unit)
            return f"{measure.detail} has a jerk of {jerk}, at most {most} required"

        return all_of(window, parts, text, shown=3)


def _jerk(velocities: FloatArray, times: FloatArray, span: float) -> FloatArray:
    """Size of the second change of velocities over a time span [s], per its square, shape (N,).

    Between samples velocities are interpolated; before the first one a joint has its velocity.
    """
    once, twice = (np.interp(times - count * span, times, velocities) for count in (1, 2))
    return np.abs(velocities - 2 * once + twice) / span**2
