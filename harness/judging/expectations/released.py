"""released: no part of the gripper touches the object, and it is not attached."""

from __future__ import annotations

from harness.cell.scope import At
from harness.core.amounts import amount
from harness.judging.at_rest import ATTACHED, CONTACT, released_parts
from harness.judging.contacts import was_in_robot
from harness.judging.expectation import ArmPredicate, ObjectPredicate
from harness.judging.margins import MarginSignal, all_of
from harness.judging.poses import present
from harness.judging.window import Window
from harness.recording.verdict import Measure


class Released(ArmPredicate, ObjectPredicate):
    """No part of the gripper touches the object, and it is not attached.

    With `by`, no part of this arm touches it; by default none of any arm.
    """

    sentence = "{object} is released"
    quantities = (CONTACT, ATTACHED)
    opposite = "grasped"

    def check(self, at: At) -> None:
        if not at.scope.description.needs_arm:
            at.scope.check_gripper(at.loc, "`released`")
        super().check(at)

    def arm_in(self, window: Window) -> str:
        del window
        return self.by or ""

    def signal(self, window: Window) -> MarginSignal:
        """No contact with any link of the robot, and not attached in the planning scene."""
        name = self.object
        parts = released_parts(window, name)
        force, hold = (part.values for part in parts)
        who = window.run.robot.selected_arm or "the robot"

        def text(index: int, _: Measure) -> str:
            belief = "attached in the planning scene" if hold[index] else "not attached"
            touch = f"touches {name} with {amount(float(force[index]), 'N')}"
            return f"{who} {touch if force[index] else f'does not touch {name}'}; {belief}"

        return all_of(window, parts, text, present=window.cut(present(window.run, name)))

    def unchanged(self, window: Window) -> str:
        if was_in_robot(window.run, self.object, slice(window.stop)):
            return ""
        return f"{window.run.robot.selected_arm or 'the robot'} never touched {self.object}"
