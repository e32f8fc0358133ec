"""Refuses robots with several arms, which `--robot ros2` does not move."""

from __future__ import annotations

from harness.core.errors import SpecError
from harness.session.prepare import Prepared


def refuse_several_arms(prepared: Prepared) -> None:
    """Refuse a robot with several arms.

    Raises:
        SpecError: It has some; at the scenario's robot.
    """
    arms = prepared.program.description.arms
    if arms:
        names = ", ".join(arm.name for arm in arms)
        message = f"`--robot ros2` moves one arm, and this robot has {names}"
        loc, hint = (prepared.loaded.scenario.robot_key,), "write a scenario for each arm"
        raise SpecError([prepared.loaded.lines.problem(loc, message, hint)])
