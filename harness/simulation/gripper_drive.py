"""Closes and opens a gripper like a GripperCommand action, until it reaches its goal or stalls."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from harness.core.antipodal import combined_press, is_antipodal, least_thickness
from harness.ports.simulation import GripperResult
from harness.robot.end_effector import Gripper
from harness.robot.mechanism import Joint
from harness.simulation.motors import Motors
from harness.simulation.recording import Recording
from harness.simulation.set_points import SetPoints, ramp

GOAL_TOLERANCE = 0.004  # Largest position error at the goal, as a share of the joint's range
STALL_TIME = 0.15  # Time for which the joint must be at rest to count as stalled [s]
STALL_SPEED = 0.02  # Speed below which the joint is at rest, as a share of its closing speed
CHECK_EVERY = 10  # Samples between two checks whether the joint reached its goal or stalled


class GripperDrive:
    """The gripper's joint under a force-limited servo; after a stall it keeps squeezing."""

    def __init__(self, simulator: Motors, recording: Recording, gripper: Gripper) -> None:
        self._simulator = simulator
        self._recording = recording
        self._gripper = gripper
        self._joint = simulator.description.joint_index[gripper.joint]
        self.actuator = simulator.actuator_of(gripper)
        self._range = abs(gripper.closed_position - gripper.open_position)
        self._speed = simulator.description.closing_speed(gripper)
        self.pending: SetPoints | None = None

    def start(self, position: float, max_effort: float) -> None:
        """Start moving to a position; the set points join those of the arm's next motion."""
        self._simulator.limit_grip(self.actuator, max_effort)
        self.pending = self._ramp(position)

    def join(self, whole: SetPoints) -> SetPoints:
        """Merge the set points of a started gripper into a motion; the shorter one is extended."""
        points, self.pending = self.pending, None
        if points is None:
            return whole
        missing = max(0, len(points) - len(whole))
        held = np.repeat(whole.positions[-1:], missing, axis=0)
        still = np.zeros_like(held)
        joined = SetPoints(
            np.concatenate([whole.positions, held]),
            np.concatenate([whole.velocities, still]),
            np.concatenate([whole.accelerations, still]),
        )
        for rows, own in zip(vars(joined).values(), vars(points).values(), strict=True):
            rows[: len(points), self.actuator] = own[:, 0]
        joined.positions[len(points) :, self.actuator] = points.positions[-1, 0]
        return joined

    def drive(self, position: float, max_effort: float, timeout: float) -> GripperResult:
        """Move to a position under an effort limit until the goal, a stall or the timeout."""
        simulator, timestep = self._simulator, self._recording.timestep
        points = self._ramp(position)
        whole = simulator.whole(points, np.array([self.actuator]))
        controls = simulator.controls(whole)
        first = self._recording.count
        stall_samples = round(STALL_TIME / timestep)
        last = first + max(1, int(timeout / timestep + 1e-6))
        begin, reached, stalled = 0, False, False
        while self._recording.count < last and not (reached or stalled):
            simulator.limit_grip(self.actuator, max_effort)
            count = min(CHECK_EVERY, last - self._recording.count)
            if begin < len(whole) - 1:
                end = min(begin + count, len(whole) - 1)
                simulator.follow(whole.part(begin, end), controls[begin : end + 1])
                begin = end
            else:
                simulator.command(whole.positions[-1])
                simulator.hold_samples(count)
                reached = self._miss(position) <= GOAL_TOLERANCE * self._range
            if not reached and self._recording.count - first >= stall_samples:
                recent = self._recording.joint_positions(self._recording.count - stall_samples)
                travel = float(np.ptp(recent[:, self._joint]))
                stalled = travel < STALL_SPEED * self._speed * STALL_TIME
        simulator.command(whole.positions[-1])
        reached = self._miss(position) <= GOAL_TOLERANCE * self._range
        forces, objects = self._forces(), simulator.physics.objects
        return GripperResult(
            position=float(simulator.joint_positions()[self._joint]),
            effort=float(self._recording.actuator_efforts()[self.actuator]),
            stalled=stalled and not reached,
            reached_goal=reached,
            contacts={
                side: tuple(sorted(pressed.keys() & objects)) for side, pressed in forces.items()
            },
            between=self._between(),
            forces=forces,
            unsealed=self._unsealed(),
        )

    def _ramp(self, position: float) -> SetPoints:
        simulator = self._simulator
        measured = float(simulator.joint_positions()[self._joint])
        commanded = float(simulator.commanded_positions()[self._joint])
        timestep = self._recording.timestep
        joint = simulator.description.joint_by_name[self._gripper.joint]
        return gripper_ramp(joint, self._speed, measured, commanded, position, timestep)

    def _miss(self, position: float) -> float:
        return abs(float(self._simulator.joint_positions()[self._joint]) - position)

    def _forces(self) -> dict[str, dict[str, float]]:
        last = self._recording.count
        touching = self._recording.contacts.forces(last - 1, last)
        robot = set(self._simulator.description.link_names)
        forces: dict[str, dict[str, float]] = {side: {} for side in self._gripper.sides}
        for side, links in self._gripper.sides.items():
            for (first, second), force in touching.items():
                if first in links and second not in robot and force[0] > 0:
                    forces[side][second] = forces[side].get(second, 0.0) + float(force[0])
        return forces

    def _unsealed(self) -> dict[str, str]:
        adhesion = self._simulator.adhesion
        return (
            {} if adhesion is None else adhesion.unsealed(self._recording.count - 1, self._gripper)
        )

    def _between(self) -> tuple[str, ...]:
        """Objects that cups hold, or two finger sides press from opposite sides, at the end."""
        adhesion = self._simulator.adhesion
        if adhesion is not None and self._gripper.cups:
            return tuple(sorted(adhesion.held(self._recording.count - 1, self._gripper)))
        last = self._recording.count
        presses = self._recording.contacts.presses(max(0, last - CHECK_EVERY), last)
        found: list[str] = []
        for name, place in self._simulator.physics.objects.items():
            sides = [
                combined_press(
                    [row[None] for link in links for row in presses.get((link, name), ())]
                )
                for links in self._gripper.sides.values()
                if any((link, name) in presses for link in links)
            ]
            thickness = least_thickness(place.obj.shapes)
            if any(is_antipodal(*pair, thickness)[0] for pair in combinations(sides, 2)):
                found.append(name)
        return tuple(sorted(found))


def gripper_ramp(
    joint: Joint, speed: float, measured: float, commanded: float, goal: float, timestep: float
) -> SetPoints:
    """The motion of the gripper's joint to a goal.

    It begins at the last command, or at the joint's position where the command is in the other
    direction.
    """
    turns_back = (goal - measured) * (commanded - measured) < 0
    return ramp(measured if turns_back else commanded, goal, speed, joint.acceleration, timestep)
