"""Two joint controllers: one that works, and one that is wrong on purpose."""

import numpy as np

from harness.ports import ControlRequest, ControlResult, JointController


class ComputedTorque(JointController):
    """Inverse dynamics of the set point, its acceleration corrected by the measured errors."""

    name = "computed_torque"
    period = 0.002
    frequency = 60.0
    """Natural frequency of the position error [rad/s]."""

    def control(self, request: ControlRequest) -> ControlResult:
        """The torques of one control cycle."""
        error = request.set_positions[0] - request.positions
        rate = request.set_velocities[0] - request.velocities
        correction = self.frequency**2 * error + 2.0 * self.frequency * rate
        efforts = request.inverse_dynamics(
            request.positions[None],
            request.velocities[None],
            request.set_accelerations[:1] + correction,
        )
        return ControlResult(efforts[0])


class WrongSign(ComputedTorque):
    """Computed torques whose last joint is driven away from its set point: wrong on purpose."""

    name = "wrong_sign"

    def control(self, request: ControlRequest) -> ControlResult:
        """The same torques, the last of them turned around."""
        efforts = np.array(super().control(request).efforts)
        efforts[-1] *= -1.0
        return ControlResult(efforts)
