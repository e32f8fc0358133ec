"""The joint controller `pd_servo`: servos without a model of the arm."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from harness.ports import ControlRequest, ControlResult, JointController


class PdServo(JointController):
    """Critically damped servos without feed-forward, so that the arm lags and sags."""

    name: ClassVar[str] = "pd_servo"

    def control(self, request: ControlRequest) -> ControlResult:
        """The servo of the arm alone."""
        nothing = np.zeros(len(request.joint_names))
        return ControlResult(nothing, request.stiffness, request.damping)
