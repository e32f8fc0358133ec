"""Refuses robots with several arms, whose controllers are not served to ROS 2 nodes."""

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
        message = f"ROS 2 nodes and robots are connected to one arm, and this robot has {names}"
        loc, hint = (prepared.loaded.scenario.robot_key,), "write a scenario for each arm"
        raise SpecError([prepared.loaded.lines.problem(loc, message, hint)])
