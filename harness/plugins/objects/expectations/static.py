"""static: the object, or everything, moves slower than a limit."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from harness.cell.scope import At
from harness.core.amounts import amounts, is_exact
from harness.judging.at_rest import SPEED, TURNING, rest_is_known, resting_parts, still_part
from harness.judging.expectation import Predicate
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.poses import physical_poses, present
from harness.judging.window import Window, lasting
from harness.language.base import Name, RestSpeed, RestTurning
from harness.language.expectation import Quantity
from harness.recording.verdict import Measure

JOINT_SPEED = Quantity(
    "joint speed", "rad/s or m/s", "of everything: the same limits, for each joint", "displacement"
)


class Static(Predicate):
    """The object, or everything, moves slower than a limit.

    It counts as still where it was slower for 50 ms: at the turning point of a swing it is slow for
    a moment. Those 50 ms may begin before the step's window. Where less was recorded of an object
    it is not judged, since what is let go in the air is slow at first. The speed is that of its
    fastest point: the ends of a long plank that turns slowly are fast.
    """

    short = "object"
    sentence = "[{object}|everything] is static"
    quantities = (SPEED, TURNING, JOINT_SPEED)
    opposite = "displaced"

    object: Name | None = Field(
        default=None,
        description="The name of the object; by default every dynamic object and the robot.",
    )
    max_velocity: RestSpeed = Field(
        default=0.005,
        description="The largest speed of objects [m/s] and of joints that slide [m/s].",
    )
    max_angular_velocity: RestTurning = Field(
        default=0.05,
        description="The largest turning speed of objects and of joints that turn [rad/s].",
    )

    def check(self, at: At) -> None:
        if self.object is not None:
            at.scope.check_object(self.object, at.key("object"), simulated=True)

    def signal(self, window: Window) -> MarginSignal:
        """Speeds of an object; by default of every dynamic object and of the robot's joints.

        Judged where the speeds of `STILL` seconds before are recorded, in the window or before it.

        Raises:
            NotReached: They are not at any sample.
        """
        run = window.run
        here = np.ones(len(run.signals.times), dtype=bool)
        if self.object is not None:
            here = present(run, self.object)
        judged = rest_is_known(window, here)
        parts: list[Part] = []
        free = [each.name for each in run.objects if each.in_simulation and not each.is_static]
        names = [self.object] if self.object is not None else free
        for name in names:
            there = present(run, name)
            physical_poses(run, name)  # not observable of what the planner alone knows
            relevant = None if self.object is not None else window.cut(there)
            limits = (self.max_velocity, self.max_angular_velocity)
            parts += resting_parts(window, name, limits, there, relevant=relevant, detail=name)
        if self.object is None:
            parts += self._of_joints(window)

        def text(_: int, measure: Measure) -> str:
            speed, limit = amounts(measure.value, measure.limit, measure.unit)
            if is_exact(measure.value, measure.limit, measure.unit):
                return f"{measure.detail} stands still, {limit} allowed"
            return f"{measure.detail} moves with {speed} of {limit}"

        here = None if self.object is None else lasting(window.cut(present(run, self.object)))
        return all_of(window, parts, text, applies=judged, present=here)

    def _of_joints(self, window: Window) -> list[Part]:
        parts: list[Part] = []
        for column, joint in enumerate(window.run.robot.movable_joints):
            speed = np.abs(window.run.signals.joint_velocities[:, column])
            slides = joint.kind == "prismatic"
            limit = self.max_velocity if slides else self.max_angular_velocity
            unit = "m/s" if slides else "rad/s"
            always = np.ones(len(speed), dtype=bool)
            more = {"detail": joint.name, "measured_unit": unit}
            parts.append(still_part(window, JOINT_SPEED, speed, limit, always, **more))
        return parts
