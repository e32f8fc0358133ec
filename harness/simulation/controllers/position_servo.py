"""The joint controller `position_servo`: stiff servos with inverse-dynamics feed-forward."""

from __future__ import annotations

from typing import ClassVar

from harness.ports import ControlRequest, ControlResult, JointController


class PositionServo(JointController):
    """Critically damped servos with feed-forward: how industrial arms follow a trajectory."""

    name: ClassVar[str] = "position_servo"

    def control(self, request: ControlRequest) -> ControlResult:
        """The servo of the arm, around the efforts that the set points take."""
        return ControlResult(request.feed_forward(), request.stiffness, request.damping)
