"""released: no part of the gripper touches the object, and it is not attached."""

from __future__ import annotations

from harness.assertions.contacts import TOUCH_FORCE, robot_contact, was_in_robot
from harness.assertions.expectation import ObjectPredicate
from harness.assertions.margins import MarginSignal, Part, all_of
from harness.assertions.poses import present
from harness.assertions.text import amount
from harness.assertions.window import Window
from harness.cell.scope import At
from harness.language.expectation import Quantity
from harness.recording.verdict import Measure

CONTACT = Quantity("contact with the robot", "N", "at most 0.001 N", "contact")
ATTACHED = Quantity("attached in the planning scene", "1", "not attached")


class Released(ObjectPredicate):
    """No part of the gripper touches the object, and it is not attached."""

    quantities = (CONTACT, ATTACHED)
    opposite = "grasped"

    def check(self, at: At) -> None:
        at.scope.check_gripper(at.loc, "`released`")
        super().check(at)

    def signal(self, window: Window) -> MarginSignal:
        """No contact with any link of the robot, and not attached in the planning scene."""
        run, name = window.run, self.object
        force, hold = robot_contact(run, name)
        force, hold = window.cut(force), window.cut(hold)
        parts = [
            Part(CONTACT, force, TOUCH_FORCE, "<="),
            Part(ATTACHED, hold, 0.0, "=="),
        ]

        def text(index: int, _: Measure) -> str:
            belief = "attached in the planning scene" if hold[index] else "not attached"
            return f"the robot touches {name} with {amount(float(force[index]), 'N')}; {belief}"

        return all_of(window, parts, text, present=window.cut(present(run, name)))

    def unchanged(self, window: Window) -> str:
        if was_in_robot(window.run, self.object, slice(window.stop)):
            return ""
        return f"the robot never touched {self.object}"
