"""Mimic joints that left the joint they follow, in the physics."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from harness.core.amounts import amount
from harness.recording.run import Finding, ObjectRecord
from harness.recording.signals import Signals
from harness.recording.step_record import StepRecord
from harness.robot.description import RobotDescription
from harness.session.observation.observer import Observed, Observer

APART = {"prismatic": 1e-3}  # deviation of a prismatic mimic joint from which it is reported [m]
TURNED_APART = 0.02  # the same of a revolute one [rad]


class Couplings(Observer):
    """Mimic joints that left the joint they follow."""

    name: ClassVar[str] = "couplings"

    def observe(
        self,
        steps: Sequence[StepRecord],
        signals: Signals,
        robot: RobotDescription,
        objects: Sequence[ObjectRecord],
    ) -> Observed:
        del objects
        return tuple(steps), coupling_findings(signals, robot)


def coupling_findings(signals: Signals, description: RobotDescription) -> tuple[Finding, ...]:
    """The mimic joint that deviated most from its coupling, if that is more than a servo's lag."""
    positions, worst = signals.joint_positions, (1.0, 0, "")
    for column, joint in enumerate(description.movable_joints):
        if joint.mimic is None or not len(positions):
            continue
        followed = positions[:, description.joint_index[joint.mimic.joint]]
        expected = joint.mimic.multiplier * followed + joint.mimic.offset
        deviation = np.nan_to_num(np.abs(positions[:, column] - expected))
        share = deviation / APART.get(joint.kind, TURNED_APART)
        row = int(share.argmax())
        if share[row] > worst[0]:
            worst = (float(share[row]), row, joint.name)
    if not worst[2]:
        return ()
    joint = description.joint_by_name[worst[2]]
    assert joint.mimic is not None
    unit = joint.position_unit
    error = worst[0] * APART.get(joint.kind, TURNED_APART)
    message = (
        f"{joint.name} was {amount(error, unit)} from where it follows {joint.mimic.joint}: the "
        "coupling did not hold; check the masses and inertias of the links between them"
    )
    values = {"joint": joint.name, "error": error, "unit": unit}
    return (Finding("coupling", message, float(signals.times[worst[1]]), values=values),)
