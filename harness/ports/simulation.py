"""The physics, and what can be broken in it."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

from harness.core.spatial import SE3
from harness.core.surface_motion import SurfaceMotion
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.core.wrench_sensor import Payload
from harness.ports.joint_control import JointController
from harness.ports.scene import Touch
from harness.recording.signals import Signals


@dataclass(frozen=True)
class GripperResult:
    """What GripperCommand's result says, and more.

    Attributes:
        position: The position of the gripper's joint at the end.
        effort: The effort of the gripper's joint at the end.
        stalled: Stopped before the goal (contact).
        reached_goal: Whether it is at the commanded position within tolerance.
        contacts: Object names in contact with each finger side at the end, by side name.
        between: Names of objects that two finger sides press from opposite sides at the end.
        unsealed: Why each suction cup that holds nothing does not, by cup.
        forces: Normal force with which each finger side presses other bodies at the end, by side
            name and body [N]; empty where it is not measured.
    """

    position: float
    effort: float
    stalled: bool
    reached_goal: bool
    contacts: Mapping[str, tuple[str, ...]]
    between: tuple[str, ...]
    forces: Mapping[str, Mapping[str, float]] = field(
        default_factory=dict[str, Mapping[str, float]]
    )
    unsealed: Mapping[str, str] = field(default_factory=dict[str, str])


@dataclass(frozen=True)
class ExpectedGrasp:
    """Where fingers that close are expected to meet an object, for adapters without physics.

    Attributes:
        position: The position of the gripper's joint there.
        is_free: Whether they meet nothing else before.
    """

    position: float
    is_free: bool


class Simulator(Protocol):
    """The physics; time only moves inside these calls, and every sample of it is recorded.

    A call that would take the run beyond `LONGEST_RUN`, or its record beyond what the memory is
    sized for, raises StepFailed TIMED_OUT.
    """

    @property
    def time(self) -> float:
        """Simulation time [s]."""
        ...

    @property
    def sample_count(self) -> int:
        """Samples recorded so far."""
        ...

    def joint_positions(self) -> FloatArray:
        """Measured, description order."""
        ...

    def commanded_positions(self) -> FloatArray:
        """Last commanded set point, description order, mimic joints consistent."""
        ...

    def object_pose(self, name: str) -> SE3:
        """T_world_object of a simulated object, as it is now."""
        ...

    def track(self, trajectory: JointTrajectory) -> None:
        """Follow a trajectory from where the command stands, then hold its end for the goal time.

        One that ends in motion is followed by another at once.

        Raises:
            StepFailed: CONTROL_FAILED, when a joint leaves the controller's tolerances; says which
                joint, by how much, what it touched.
        """
        ...

    def use_controller(self, controller: JointController | None) -> None:
        """Let a controller move the arm's joints from now on.

        Args:
            controller: The controller; None for the robot's own, which holds the arm where it is.
        """
        ...

    def force_on_robot(self, span: float, held: Collection[str]) -> tuple[float, FloatArray]:
        """Normal forces between the robot and other bodies, mean over some time [N].

        Args:
            span: The time until now [s].
            held: Objects that count as parts of the robot.

        Returns:
            The sum of their sizes, and the robot's push on the others, in the world, shape (3,).
        """
        ...

    def wrench(self, sensor: str, span: float) -> FloatArray:
        """What a sensor of force and torque reads, in its axes, shape (6,) [N, N m].

        Args:
            sensor: The name of the sensor.
            span: The time until now over which the mean is taken [s].
        """
        ...

    def tare(self, sensor: str, duration: float, payload: Payload | None = None) -> FloatArray:
        """Hold for some time [s], and take what a sensor reads meanwhile for zero from then on.

        Args:
            sensor: The name of the sensor.
            duration: The time over which the mean is taken [s].
            payload: What it carries: its weight is subtracted in every orientation.

        Returns:
            The mean of its readings, without an earlier tare and the payload's weight, shape (6,).
        """
        ...

    def command_gripper(
        self,
        position: float,
        max_effort: float,
        *,
        timeout: float,
        expected: ExpectedGrasp | None = None,
        joint: str = "",
    ) -> GripperResult:
        """Drive a gripper's joint under an effort limit until it arrives or stalls.

        Args:
            position: The goal of the gripper's joint.
            max_effort: The limit of its effort.
            timeout: The longest time that it may take [s].
            expected: Where the fingers should meet an object; only what has no physics reads it.
            joint: The gripper's joint; by default that of the only gripper.
        """
        ...

    def start_gripper(self, position: float, max_effort: float, joint: str = "") -> None:
        """Let a gripper set out while time is moved by other calls; `command_gripper` follows."""
        ...

    def hold(self, duration: float) -> None:
        """Keep the last commands for some simulated time [s]."""
        ...

    def settle(self, max_velocity: float, timeout: float) -> bool:
        """Hold until joints and objects stay slower than a limit [m/s, rad/s]; True.

        Raises:
            StepFailed: TIMED_OUT; says what still moves, and how fast.
        """
        ...

    def add_object(self, name: str, pose: SE3) -> None:
        """Let a prepared object appear at T_world_object."""
        ...

    def remove_object(self, name: str) -> None:
        """Park an object without contacts."""
        ...

    def move_object(self, name: str, pose: SE3) -> None:
        """Set T_world_object, at rest."""
        ...

    def surface_motion(self, name: str) -> SurfaceMotion:
        """How the surface of a belt or a turntable moves now."""
        ...

    def drive_surface(self, name: str, motion: SurfaceMotion, duration: float) -> None:
        """Change the motion of a belt's surface evenly, while a duration passes [s]."""
        ...

    def weld(self, name: str, link: str) -> None:
        """Fix an object to a link where it stands (grasp mode `weld`)."""
        ...

    def unweld(self, name: str, believed: SE3 | None = None) -> None:
        """Undo `weld`, and let go; what has no physics leaves the object where it is believed."""
        ...


@runtime_checkable
class RecordingSimulator(Simulator, Protocol):
    """A simulator, or a robot, that a whole case runs on and that records it."""

    @property
    def timestep(self) -> float:
        """The time between two samples [s]."""
        ...

    @property
    def overlaps_at_start(self) -> Sequence[Touch]:
        """Pairs of bodies that overlap at the start, deepest first."""
        ...

    @property
    def unrecorded(self) -> tuple[str, ...]:
        """Names of `Signals`' fields that are not recorded."""
        ...

    def finish(self, first: int = 0) -> Signals:
        """Everything recorded from a sample on, without clearances."""
        ...
