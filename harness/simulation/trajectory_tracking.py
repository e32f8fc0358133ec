"""Follows trajectories within the tolerances of the joints' controller."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from weakref import proxy

import numpy as np

from harness.core.amounts import amounts
from harness.core.errors import StepFailed
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray, IntArray
from harness.recording.execution_failures import ContactForce, ControlFailure
from harness.simulation.contact_record import BodyPair
from harness.simulation.gripper_drive import GripperDrive
from harness.simulation.motors import Motors
from harness.simulation.set_points import sample_trajectory

CHECK_EVERY = 100
"""Samples between checks of the path tolerance; the record shows which sample exceeded it."""

SETTLE_EVERY = 10  # Samples between checks whether a goal is reached or everything is at rest
ABORT_HOLD = 0.2  # Time for which an aborted arm is held at its position [s]


class TrajectoryTracking(Motors):
    """Motors that follow trajectories, and grippers that move meanwhile."""

    @cached_property
    def _grippers(self) -> Mapping[str, GripperDrive]:
        """What drives each gripper, by the name of its joint."""
        return {
            gripper.joint: GripperDrive(proxy(self), self._recording, gripper)
            for gripper in self.description.grippers
        }

    def track(self, trajectory: JointTrajectory) -> None:
        """Follow a trajectory, then hold its end until every joint is within the goal tolerance.

        One that ends in motion is followed by another at once.

        Raises:
            StepFailed: CONTROL_FAILED; a joint left the tolerances of the controller.
        """
        columns = self._actuated_columns(trajectory.joint_names)
        self._recording.refuse_beyond(int(trajectory.duration / self._timestep))
        points = sample_trajectory(trajectory, self._timestep)
        whole = self.whole(points, columns)
        for gripper in self._grippers.values():
            whole = gripper.join(whole)
        controls = self.controls(whole)
        for begin in range(0, len(whole) - 1, CHECK_EVERY):
            end = min(begin + CHECK_EVERY, len(whole) - 1)
            first = self._recording.count
            self._advance(whole.part(begin, end), controls[begin : end + 1])
            self._command = whole.positions[end]
            if not self._drive.controller.is_compliant:
                self._refuse_lag(first, whole.positions[begin + 1 : end + 1, columns], columns)
        if trajectory.velocities[-1].any():
            self._control = controls[-1]
            return
        self.command(whole.positions[-1])
        if not self._drive.controller.is_compliant:
            self._wait_for_goal(whole.positions[-1, columns], columns)

    def _refuse_lag(self, first: int, commanded: FloatArray, columns: IntArray) -> None:
        tolerance = self.description.tracking.trajectory
        joints = self.physics.actuated[columns]
        noise = self.disturbance.measured_noise(len(commanded))[:, columns]
        errors = np.abs(self._recording.joint_positions(first)[:, joints] + noise - commanded)
        beyond = np.flatnonzero((errors > tolerance).any(axis=1))
        if len(beyond):
            row = int(beyond[0])
            self._abort(first + row, errors[row], joints, tolerance, "lags {} behind its set point")

    def _wait_for_goal(self, goal: FloatArray, columns: IntArray) -> None:
        tracking = self.description.tracking
        joints = self.physics.actuated[columns]
        deadline = self.time + tracking.goal_time
        while True:
            noise = self.disturbance.measured_noise(1)[-1, columns]
            errors = np.abs(self.joint_positions()[joints] + noise - goal)
            if (errors <= tracking.goal).all():
                return
            if self.time >= deadline:
                break
            self.hold_samples(SETTLE_EVERY)
        row = self._recording.count - 1
        self._abort(row, errors, joints, tracking.goal, "is still {} from its goal")

    def _abort(
        self, row: int, errors: FloatArray, joints: IntArray, tolerance: float, message: str
    ) -> None:
        """Hold the arm at its position and raise CONTROL_FAILED."""
        worst = int(np.argmax(errors))
        joint = self.description.movable_joints[int(joints[worst])]
        unit = joint.position_unit
        contacts = self._recording.strongest_robot_contacts(row)
        time = row * self._timestep
        command = self._command.copy()
        columns = np.searchsorted(self.physics.actuated, joints)
        command[columns] = self.joint_positions()[joints]
        self.command(command)
        self.hold(ABORT_HOLD)
        error, allowed = amounts(float(errors[worst]), tolerance, unit)
        raise StepFailed(
            "CONTROL_FAILED",
            f"{joint.name} {message.format(error)} at t={time:.3f} s "
            f"(tolerance {allowed}); {_contact_clause(contacts)}",
            ControlFailure(
                joint=joint.name,
                error=float(errors[worst]),
                tolerance=tolerance,
                unit=unit,
                time=time,
                contacts=tuple(ContactForce(pair, force) for pair, force in contacts.items()),
            ),
        )


def _contact_clause(contacts: Mapping[BodyPair, float]) -> str:
    """The strongest contacts as a clause of a failure's message."""
    parts = [f"{a} presses on {b} with {force:.3g} N" for (a, b), force in contacts.items()]
    return ", ".join(parts[:3]) or "it touches nothing"
