"""The simulator port on MuJoCo: servos under effort limits, every sample recorded."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Collection

from harness.core.errors import StepFailed
from harness.core.spatial import SE3
from harness.core.surface_motion import SurfaceMotion
from harness.core.types import FloatArray
from harness.core.wrench_sensor import Payload
from harness.ports.simulation import ExpectedGrasp, GripperResult
from harness.recording.execution_failures import UnrestFailure
from harness.recording.motion import Motion
from harness.recording.signals import Signals
from harness.simulation.trajectory_tracking import SETTLE_EVERY, TrajectoryTracking
from harness.simulation.wrench_sensors import Tare

SETTLE_FOR = 0.06
"""Time below the velocity limit that counts as rest; a swing's turning point is shorter [s]."""


class MujocoSimulator(TrajectoryTracking):
    """The physics of one run; it is bitwise deterministic, however its time is divided."""

    unrecorded: tuple[str, ...] = ()

    def object_pose(self, name: str) -> SE3:
        """The current T_world_object of a simulated object."""
        return self._objects.pose(name)

    def objects_now(self) -> dict[str, FloatArray]:
        """T_world_object of the objects in the scene (xyz, quat wxyz), shape (7,) each."""
        return self._objects.present_poses()

    def force_on_robot(self, span: float, held: Collection[str]) -> tuple[float, FloatArray]:
        """The robot's normal forces and its push, mean over `span` [N]."""
        last, own = self._recording.count, {*self.description.link_names, *held}
        first = max(0, last - max(1, round(span / self._timestep)))
        return self._recording.contacts.force_on(own, first, last)

    def wrench(self, sensor: str, span: float) -> FloatArray:
        """What a sensor of force and torque reads, in its axes, mean over `span`, shape (6,)."""
        first = max(0, self._recording.count - max(1, round(span / self._timestep)))
        return self._recording.wrench(sensor, first).mean(axis=0)

    def tare(self, sensor: str, duration: float, payload: Payload | None = None) -> FloatArray:
        """Hold, and take the mean of a sensor's readings meanwhile for zero; returns it, (6,).

        It holds for these readings, too: a mean over the time before the end mixes none of both.
        """
        self.hold(duration)
        recording = self._recording
        first = max(0, recording.count - max(1, round(duration / self._timestep)))
        readings = recording.wrench(sensor, first, tared=False)
        if payload is not None:
            readings = readings - recording.weight(sensor, payload, first)
        zero = readings.mean(axis=0)
        recording.wrenches.tare(Tare(first, sensor, zero, payload))
        return zero

    def command_gripper(
        self,
        position: float,
        max_effort: float,
        *,
        timeout: float,
        expected: ExpectedGrasp | None = None,
        joint: str = "",
    ) -> GripperResult:
        """Drive a gripper's joint under an effort limit until it reaches its goal or stalls."""
        del expected  # the physics shows what the fingers meet
        return self._grippers[self.gripper(joint).joint].drive(position, max_effort, timeout)

    def start_gripper(self, position: float, max_effort: float, joint: str = "") -> None:
        """Start moving a gripper; its set points join those of the arm's next motion."""
        self._grippers[self.gripper(joint).joint].start(position, max_effort)

    def limit_gripper(self, effort: float, joint: str) -> None:
        """Limit the effort of a gripper's joint from now on."""
        self.limit_grip(self.actuator_of(self.gripper(joint)), effort)

    def settle(self, max_velocity: float, timeout: float) -> bool:
        """Hold until joints and objects have been slower than a limit for `SETTLE_FOR`.

        Raises:
            StepFailed: TIMED_OUT; the error names what still moves, and its speed.
        """
        name, speed, unit, calm = "", 0.0, "", 0.0
        last = self._recording.count + max(1, int(timeout / self._timestep + 1e-6))
        while (first := self._recording.count) < last:
            count = min(SETTLE_EVERY, last - first)
            self.hold_samples(count)
            name, speed, unit = self._recording.fastest(first)
            calm = calm + count * self._timestep if speed < max_velocity else 0.0
            if calm > SETTLE_FOR - 0.5 * self._timestep:
                return True
        raise StepFailed(
            "TIMED_OUT",
            f"{name} still moves with {speed:.3g} {unit} after {timeout:g} s;"
            f" at rest is slower than {max_velocity:g} {unit} for {SETTLE_FOR:g} s",
            UnrestFailure(name, speed, max_velocity, timeout),
        )

    def add_object(self, name: str, pose: SE3) -> None:
        """Make a prepared object appear at T_world_object."""
        self._objects.add(name, pose)

    def remove_object(self, name: str) -> None:
        """Park an object, without contacts."""
        self._objects.remove(name)

    def move_object(self, name: str, pose: SE3) -> None:
        """Set T_world_object; the object is at rest."""
        self._objects.move(name, pose)

    def surface_motion(self, name: str) -> SurfaceMotion:
        """How the surface of a belt or a turntable moves now."""
        return self._surfaces.motion(name)

    def drive_surface(self, name: str, motion: SurfaceMotion, duration: float) -> None:
        """Change the motion of a belt's surface evenly, a little at each sample."""
        before, samples = self.surface_motion(name), round(duration / self._timestep)
        self._recording.refuse_beyond(samples)
        for sample in range(samples):
            self._surfaces.set(name, before.between(motion, (sample + 0.5) / samples))
            self.hold_samples(1)
        self._surfaces.set(name, motion)

    def weld(self, name: str, link: str) -> None:
        """Fix an object to a link at its current pose."""
        self._objects.weld(name, link)

    def unweld(self, name: str, believed: SE3 | None = None) -> None:
        """Release a welded object."""
        del believed  # the physics knows better
        self._objects.unweld(name)

    def motion(self) -> Motion:
        """What has moved so far, as `finish` returns it."""
        return Motion(
            self._recording.times(),
            self._recording.joint_positions(0),
            self._objects.recorded_poses(),
        )

    def finish(self, first: int = 0) -> Signals:
        """All recorded signals from a sample on, without clearances."""
        poses, surfaces = self._objects.recorded_poses(first), self._surfaces.recorded(first)
        return self._recording.signals(poses, surfaces, first)
