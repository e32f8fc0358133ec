"""tracking_error: joints stay near their commands."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from harness.cell.scope import At
from harness.core.amounts import amount
from harness.core.types import BoolArray, FloatArray
from harness.judging.expectation import Mechanisms, Predicate
from harness.judging.joints import hand_joints
from harness.judging.limits import refuse_decided
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.window import NotObservable, Window
from harness.language.base import JointValue
from harness.language.expectation import Quantity
from harness.recording.verdict import Measure

ERROR = Quantity("tracking error", "rad or m", "at most `max`, for each joint", "tracking")


class TrackingError(Predicate):
    """Joints stay near their commands."""

    short = "max"
    judged = "always"
    sentence = "tracking error is at most {max}"
    quantities = (ERROR,)
    is_upper_bound = True

    max: Annotated[JointValue, Field(gt=0)] = Field(
        default=0.05,
        description="The largest difference between a joint's measured position and its command; by"
        " default 0.05 rad, and 5 mm where the joint slides.",
    )

    def check(self, at: At) -> None:
        robot = at.scope.description
        joints = [robot.movable_joints[index] for index in robot.group_indices(robot.default_group)]
        farthest = max((joint.upper - joint.lower for joint in joints), default=np.inf)
        refuse_decided(at, "max", "<=", self.max, (0.0, farthest), "the tracking error")

    def joint_units(self, mechanisms: Mechanisms) -> frozenset[str]:
        robot = mechanisms.robot
        return mechanisms.units_of(robot.joint_units.by_joint.keys() - hand_joints(robot))

    def signal(self, window: Window) -> MarginSignal:
        """Largest distance of a joint from its command [rad or m].

        The gripper's joints are left out: one that stalls on an object stays short of its command.
        A position that is missing while the joint has a command is unknown, and so is a command
        that is missing between others. For joints that slide the default is a tenth of the given
        number, in metres.
        """
        run = window.run
        hand = hand_joints(run.robot)
        parts: list[Part] = []
        for column, joint in enumerate(run.robot.movable_joints):
            error = np.abs(
                run.signals.joint_positions[:, column] - run.signals.joint_commands[:, column]
            )
            error = window.cut(error)
            commanded = _between_known(window.cut(run.signals.joint_commands[:, column]))
            if joint.name in hand or np.isnan(error).all():
                continue
            slides = joint.kind == "prismatic" and "max" not in self.model_fields_set
            limit = 0.1 * self.max if slides else self.max
            unit = joint.position_unit
            parts.append(
                Part(
                    ERROR,
                    error,
                    limit,
                    "<=",
                    relevant=commanded,
                    detail=joint.name,
                    measured_unit=unit,
                )
            )
        if not parts:
            raise NotObservable("no commands of joints other than the gripper's were recorded")
        some = np.any([part.relevant for part in parts if part.relevant is not None], axis=0)

        def text(_: int, measure: Measure) -> str:
            return f"{measure.detail} is {amount(measure.value, measure.unit)} from its command"

        return all_of(window, parts, text, applies=some, shown=3)


def _between_known(commands: FloatArray) -> BoolArray:
    """Samples from the first known command to the last one, shape (n,)."""
    known = np.flatnonzero(~np.isnan(commands))
    inside: BoolArray = np.zeros(len(commands), dtype=bool)
    if len(known):
        inside[known[0] : known[-1] + 1] = True
    return inside
