"""named_target: a group stands at its named state."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from harness.cell.scope import At
from harness.core.state_words import stated_name
from harness.judging.expectation import Mechanisms, Predicate
from harness.judging.joints import POSITION_ERROR, check_tolerance, near
from harness.judging.margins import MarginSignal
from harness.judging.window import NotObservable, Window
from harness.language.base import JointValue, Name
from harness.robot.description import NamedState, RobotDescription


class NamedTarget(Predicate):
    """A group stands at its named state."""

    short = "state"
    sentence = "[{group}|arm] is at named target {state}"
    quantities = (POSITION_ERROR,)
    is_proposed = True

    state: Name = Field(description="The name of the SRDF group state.")
    group: Name | None = Field(
        default=None, description="The group that stands there; by default the arm."
    )
    tolerance: Annotated[JointValue, Field(gt=0)] = Field(
        default=0.01,
        description="The tolerance of each joint; by default 0.01 rad, and 2 mm where it slides.",
    )

    def check(self, at: At) -> None:
        if self.group is None:
            at.scope.check_arm(at.loc, "group")
        group = at.scope.check_group(self.group, at.key("group"))
        at.scope.check_state(group, self.state, at.key("state"))
        states = at.scope.description.states_of(group)
        state = states.get(stated_name(self.state, states))
        if state is not None:
            is_given = "tolerance" in self.model_fields_set
            check_tolerance(at, "state", state.positions, self.tolerance, is_given)

    def names(self) -> frozenset[str]:
        return frozenset()

    def joint_units(self, mechanisms: Mechanisms) -> frozenset[str]:
        try:
            return mechanisms.units_of(self._state(mechanisms.robot).positions)
        except NotObservable:  # which the verdict says
            return frozenset()

    def looks_back(self) -> float:
        return 0.0

    def signal(self, window: Window) -> MarginSignal:
        """The worst joint's distance from the named state [rad or m]."""
        is_given = "tolerance" in self.model_fields_set
        positions = self._state(window.run.robot).positions
        return near(window, positions, self.tolerance, is_given)

    def _state(self, robot: RobotDescription) -> NamedState:
        """The named state of the robot.

        Raises:
            NotObservable: No group, or not the one it names, has such a state.
        """
        hand = "" if robot.gripper is None else robot.gripper.group
        every = [robot.arm_group, hand, *sorted(robot.groups)]
        for group in every if self.group is None else [self.group]:
            states = robot.states_of(group)
            state = states.get(stated_name(self.state, states))
            if state is not None:
                return state
        raise NotObservable(f"there is no named state '{self.state}' in this run")
