"""The simulator port on MuJoCo: servos under effort limits, every sample recorded."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext

import mujoco
import numpy as np

from harness.core.errors import ModelRefused, StepFailed
from harness.core.spatial import SE3
from harness.core.surface_motion import SurfaceMotion
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray, IntArray
from harness.core.world import WorldObject
from harness.ports.simulation import ExpectedGrasp, GripperResult
from harness.recording.execution_failures import ContactForce, ControlFailure, UnrestFailure
from harness.recording.motion import Motion
from harness.recording.signals import Signals
from harness.robot.description import RobotDescription
from harness.simulation.adhesion import adhesion_of
from harness.simulation.contact_record import BodyPair
from harness.simulation.faults import MujocoFaults
from harness.simulation.gripper_drive import GripperDrive
from harness.simulation.joint_drive import JointDrive
from harness.simulation.model import build_model
from harness.simulation.objects import Objects, overlaps
from harness.simulation.recording import Recording
from harness.simulation.robot_mjcf import coupling
from harness.simulation.set_points import SetPoints, sample_trajectory
from harness.simulation.snapshot import (
    PhysicsState,
    SimulatorCommand,
    load_state,
    saved_state,
)
from harness.simulation.step_state import refresh
from harness.simulation.surfaces import Surfaces
from harness.simulation.wrench_sensors import WrenchSensors

CHECK_EVERY = 100
"""Samples between checks of the path tolerance; the record shows which sample exceeded it."""

SETTLE_EVERY = 10  # Samples between checks whether a goal is reached or everything is at rest
SETTLE_FOR = 0.06
"""Time below the velocity limit that counts as rest; a swing's turning point is shorter [s]."""

ABORT_HOLD = 0.2  # Time for which an aborted arm is held at its position [s]


class MujocoSimulator:
    """The physics of one run; it is bitwise deterministic, however the time is divided into calls.

    Attributes:
        overlaps_at_start: Pairs of bodies that overlap at the start, deepest first.
        adhesion: The forces of its suction cups; None of a robot without.
        unrecorded: Signals that are not recorded: none.
    """

    unrecorded: tuple[str, ...] = ()

    def __init__(
        self,
        description: RobotDescription,
        world_objects: Sequence[WorldObject],
        present: Collection[str],
        *,
        gravity: tuple[float, float, float] = (0.0, 0.0, -9.8),
        timestep: float = 0.001,
        frames: Sequence[str] = (),
        seed: int = 0,
        moving: Callable[[], AbstractContextManager[None]] = nullcontext,
    ) -> None:
        """Build the model and record its start state as sample 0.

        Args:
            description: The robot, at its start state.
            world_objects: All objects that are ever in the world.
            present: The names of the objects that are present at the start.
            gravity: The gravitational acceleration [m/s^2].
            timestep: The physics step [s].
            frames: Links whose poses are recorded in addition to the TCP's.
            seed: Source of the noise of sensors of force and torque.
            moving: Makes a context in which the physics advances, which measures its wall time.

        Raises:
            ModelRefused: MuJoCo cannot simulate one of the bodies, or the joint controller fails
                at the start.
        """
        self.physics = build_model(
            description, world_objects, present, gravity=gravity, timestep=timestep, frames=frames
        )
        self.description = description
        self._timestep = timestep
        self._moving = moving
        self._model = self.physics.model
        self._data = mujoco.MjData(self._model)
        self._data.qpos[self.physics.qpos] = description.start_positions()
        for place in self.physics.objects.values():
            if place.obj.joint is not None:
                self._data.qpos[place.qpos] = place.obj.joint.start
        self._coupling = coupling(description)
        self._offsets = description.with_mimics(np.zeros(len(description.joint_names)))
        self._drive = JointDrive(self.physics, self._data, gravity, timestep)
        self._command = description.start_positions()[self.physics.actuated]
        self._control = self._first_control()
        self._data.ctrl[:] = self._control
        self._grips: dict[int, float] = {}  # effort limits of grippers, by actuator
        self.faults = MujocoFaults(self, self.physics, self._data)
        self.adhesion = adhesion_of(self.physics, self._data)
        wrenches = WrenchSensors(description.wrench_sensors.values(), timestep, seed)
        self._recording = Recording(self.physics, self._data, wrenches, self.adhesion)
        self._surfaces = Surfaces(self.physics, self._data, self._recording)
        refresh(self._model, self._data)
        self._refuse_unusable_start()
        self.overlaps_at_start = overlaps(self.physics, self._data)
        self._recording.start(self._command)
        self._objects = Objects(self.physics, self._data, self._recording, frozenset(present))
        self._grippers = {
            gripper.joint: GripperDrive(self, self._recording, gripper)
            for gripper in description.grippers
        }

    def limit(self, longest: float) -> None:
        """Let the run take at most this simulated time [s]; a call that exceeds it fails."""
        self._recording.longest = longest

    def _first_control(self) -> FloatArray:
        """Inputs of the motors at the start."""
        try:
            return self.controls(self._still(self._command))[0]
        except StepFailed as failed:
            refresh(self._model, self._data)
            self._refuse_unusable_start()  # the cause, if forces at the start are infinite
            raise ModelRefused("", failed.message) from failed

    def _refuse_unusable_start(self) -> None:
        """Check that MuJoCo can step from the start state."""
        for name, place in self.physics.objects.items():
            pose = self._data.xpos[place.body]
            if not (np.abs(pose) <= mujoco.mjMAXVAL).all():
                far = float(np.abs(pose).max())
                raise ModelRefused(
                    name, f"it stands {far:.3g} m away; the physics takes {mujoco.mjMAXVAL:g} m"
                )
        beyond = np.flatnonzero(~(np.abs(self._data.qacc) <= mujoco.mjMAXVAL))
        if len(beyond):
            raise ModelRefused(
                self.physics.body_names[self._model.dof_bodyid[beyond[0]]],
                f"its acceleration at the start exceeds {mujoco.mjMAXVAL:g} m/s^2: its mass, its"
                " inertia, its pose or gravity has a number that is too large or too small",
            )

    @property
    def time(self) -> float:
        """Simulation time [s]."""
        return (self._recording.count - 1) * self._timestep

    @property
    def sample_count(self) -> int:
        """Number of recorded samples; the last one is the current state."""
        return self._recording.count

    def joint_positions(self) -> FloatArray:
        """The measured joint positions, in description order."""
        return self._data.qpos[self.physics.qpos].copy()

    def commanded_positions(self) -> FloatArray:
        """The last set point in description order, mimic joints included."""
        return self._coupling @ self._command + self._offsets

    def object_pose(self, name: str) -> SE3:
        """The current T_world_object of a simulated object."""
        return self._objects.pose(name)

    def objects_now(self) -> dict[str, FloatArray]:
        """T_world_object of the objects in the scene (xyz, quat wxyz), shape (7,) each."""
        return self._objects.present_poses()

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
            self._refuse_lag(first, whole.positions[begin + 1 : end + 1, columns], columns)
        if trajectory.velocities[-1].any():
            self._control = controls[-1]
            return
        self.command(whole.positions[-1])
        self._wait_for_goal(whole.positions[-1, columns], columns)

    def force_on_robot(self, span: float, held: Collection[str]) -> float:
        """Sum of the normal forces between the robot and other bodies, mean over `span` [N]."""
        last = self._recording.count
        first = max(0, last - max(1, round(span / self._timestep)))
        own = {*self.description.link_names, *held}
        pairs = self._recording.contacts(first, last)
        forces = (force for pair, force in pairs.items() if (pair[0] in own) != (pair[1] in own))
        return float(sum(float(force.mean()) for force in forces))

    def wrench(self, sensor: str, span: float) -> FloatArray:
        """What a sensor of force and torque reads, in its axes, mean over `span`, shape (6,)."""
        return self._wrench(sensor, span)

    def tare(self, sensor: str, duration: float) -> FloatArray:
        """Hold, and take the mean of a sensor's readings meanwhile for zero; returns it, (6,)."""
        self.hold(duration)
        zero = self._wrench(sensor, duration, tared=False)
        self._recording.wrenches.tare(sensor, self._recording.count - 1, zero)
        return zero

    def _wrench(self, sensor: str, span: float, *, tared: bool = True) -> FloatArray:
        first = max(0, self._recording.count - max(1, round(span / self._timestep)))
        return self._recording.wrench(sensor, first, tared=tared).mean(axis=0)

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
        return self._gripper(joint).drive(position, max_effort, timeout)

    def start_gripper(self, position: float, max_effort: float, joint: str = "") -> None:
        """Start moving a gripper; its set points join those of the arm's next motion."""
        self._gripper(joint).start(position, max_effort)

    def _gripper(self, joint: str) -> GripperDrive:
        """The drive of the gripper with a joint; by default that of the robot's first."""
        if not self._grippers:
            raise StepFailed("INVALID_GROUP_NAME", f"{self.description.name} has no gripper")
        return self._grippers[joint or next(iter(self._grippers))]

    def hold(self, duration: float) -> None:
        """Keep the last commands for a duration in simulation time [s]."""
        self.hold_samples(round(duration / self._timestep))

    def settle(self, max_velocity: float, timeout: float) -> bool:
        """Hold until joints and objects have been slower than a limit for `SETTLE_FOR`.

        Raises:
            StepFailed: TIMED_OUT; the error names what still moves, and its speed.
        """
        name, speed, calm = "", 0.0, 0.0
        last = self._recording.count + max(1, int(timeout / self._timestep + 1e-6))
        while (first := self._recording.count) < last:
            count = min(SETTLE_EVERY, last - first)
            self.hold_samples(count)
            name, speed = self._recording.fastest(first)
            calm = calm + count * self._timestep if speed < max_velocity else 0.0
            if calm > SETTLE_FOR - 0.5 * self._timestep:
                return True
        raise StepFailed(
            "TIMED_OUT",
            f"{name} still moves with {speed:.3g} after {timeout:g} s;"
            f" at rest is slower than {max_velocity:g} m/s (or rad/s) for {SETTLE_FOR:g} s",
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

    def finish(self) -> Signals:
        """All recorded signals, without clearances."""
        return self._recording.signals(self._objects.recorded_poses(), self._surfaces.recorded())

    def snapshot(self) -> PhysicsState:
        """Everything that decides how the run continues."""
        command = SimulatorCommand(
            self._command.copy(),
            self._control.copy(),
            dict(self._grips),
            {joint: gripper.pending for joint, gripper in self._grippers.items()},
            self._drive.copy(),
        )
        history, faults = self._objects.history, self.faults.state()
        surfaces = self._surfaces.history
        return saved_state(
            self._model, self._data, command, self.sample_count, history, faults, surfaces
        )

    def restore(self, state: PhysicsState) -> None:
        """Go back to a snapshot of this simulator; later samples are forgotten."""
        load_state(self._model, self._data, state)
        command = state.command
        self._command, self._control = command.positions.copy(), command.control.copy()
        self._grips = dict(command.grips)
        self._drive.restore(command.controller)
        for joint, gripper in self._grippers.items():
            gripper.pending = command.pending[joint]
        self._objects.history = state.history
        self.faults.restore(state.faults)
        self._surfaces.history = state.surfaces
        self._recording.rewind(state.samples)

    def command(self, positions: FloatArray) -> None:
        """Set the servos to hold actuated joints at positions, shape (m,)."""
        self._command = np.array(positions)
        self._control = self.controls(self._still(self._command))[0]

    def hold_samples(self, count: int) -> None:
        """Hold the last commands for a number of samples."""
        self._recording.refuse_beyond(count)
        shape = (count + 1, len(self._command))
        still = np.zeros(shape)
        points = SetPoints(np.broadcast_to(self._command, shape), still, still)
        self._advance(points, np.broadcast_to(self._control, shape))

    def limit_grip(self, actuator: int, effort: float) -> None:
        """Limit a gripper's effort, in addition to the effort that carries its own weight."""
        self._grips[actuator] = effort
        effort *= self.faults.grip_share.get(actuator, 1.0)
        largest = self.physics.servos.effort[actuator]
        weight = self._drive.weight(self.joint_positions())[actuator]
        limits = np.clip([weight - effort, weight + effort], -largest, largest)
        self._model.actuator_forcerange[actuator] = limits

    def renew_grip_limit(self) -> None:
        """Apply the grippers' effort limits again, for their current weight and faults."""
        for actuator, effort in self._grips.items():
            self.limit_grip(actuator, effort)

    def follow(self, points: SetPoints, controls: FloatArray | None = None) -> None:
        """Advance along set points of all actuated joints.

        Args:
            points: The set points, the first where the command stands.
            controls: What `controls` says of them; computed by default.
        """
        self._advance(points, self.controls(points) if controls is None else controls)
        self._command = points.positions[-1]

    @property
    def timestep(self) -> float:
        """Time between samples [s]."""
        return self._timestep

    def stream(self, rows: FloatArray) -> None:
        """Advance along set points of all actuated joints, one physics step from row to row.

        `command` has to follow the last of these calls, before anything is held.

        Args:
            rows: Positions, velocities and accelerations, shape (3, N + 1, m); the first of the
                N + 1 is where the command stands.
        """
        points = SetPoints(*rows)
        self._recording.refuse_beyond(len(points) - 1)
        self.renew_grip_limit()
        self.follow(points)

    def measured(self, first: int) -> tuple[FloatArray, FloatArray]:
        """Positions and velocities from a sample on, description order, shape (N, n) each."""
        return self._recording.joint_positions(first), self._recording.joint_velocities(first)

    def efforts(self) -> FloatArray:
        """Efforts of the actuated joints at the last sample, shape (m,)."""
        return self._recording.actuator_efforts()

    def limit_gripper(self, effort: float) -> None:
        """Limit the effort of the gripper's joint from now on."""
        if self._grippers:
            self.limit_grip(self._gripper("").actuator, effort)

    def weaken_gripper(self, joint: str, share: float) -> float:
        """Leave a gripper a share of its effort; returns the share before."""
        actuator, shares = self._gripper(joint).actuator, self.faults.grip_share
        before, shares[actuator] = shares.get(actuator, 1.0), share
        self.renew_grip_limit()
        return before

    def whole(self, points: SetPoints, columns: IntArray) -> SetPoints:
        """Set points of all actuated joints, those outside `columns` held, shape (N, m)."""
        shape = (len(points), len(self._command))
        positions = np.broadcast_to(self._command, shape).copy()
        velocities, accelerations = np.zeros(shape), np.zeros(shape)
        positions[:, columns] = points.positions
        velocities[:, columns] = points.velocities
        accelerations[:, columns] = points.accelerations
        return SetPoints(positions, velocities, accelerations)

    def _advance(self, points: SetPoints, controls: FloatArray) -> None:
        """Step along set points, with the controls that arrive at the motors.

        Args:
            points: Set points of all actuated joints, the first row for now.
            controls: Inputs of the motors at these; a controller that measures computes its own.
        """
        cycle = self._drive.cycle
        with self._moving():
            if cycle is None:
                self._step(points, controls)
                return
            for begin in range(0, len(points) - 1, cycle):
                part = points.part(begin, min(begin + cycle, len(points) - 1))
                self._step(part, self._drive.inputs(part, self.faults.measured_noise(1)[-1]))

    def _step(self, points: SetPoints, controls: FloatArray) -> None:
        arrived = self.faults.distorted(controls, self._drive.position_share)
        self._recording.advance(arrived, points.positions[1:], points.velocities[1:])

    def _actuated_columns(self, joint_names: Sequence[str]) -> IntArray:
        places = [self.description.joint_index[name] for name in joint_names]
        return np.searchsorted(self.physics.actuated, places).astype(np.int64)

    def _still(self, command: FloatArray) -> SetPoints:
        still = np.zeros((1, len(command)))
        return SetPoints(command[None], still, still)

    def controls(self, points: SetPoints) -> FloatArray:
        """Inputs of the motors at set points; zero where the controller measures first."""
        if self._drive.cycle is not None:
            return np.zeros_like(points.positions)
        return self._drive.inputs(points)

    def _refuse_lag(self, first: int, commanded: FloatArray, columns: IntArray) -> None:
        tolerance = self.description.tracking.trajectory
        joints = self.physics.actuated[columns]
        noise = self.faults.measured_noise(len(commanded))[:, columns]
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
            noise = self.faults.measured_noise(1)[-1, columns]
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
        """Hold the arm at its position and raise the failure.

        Raises:
            StepFailed: CONTROL_FAILED, always.
        """
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
        error = f"{errors[worst]:.3g} {unit}"
        raise StepFailed(
            "CONTROL_FAILED",
            f"{joint.name} {message.format(error)} at t={time:.3f} s "
            f"(tolerance {tolerance:g} {unit}); {_contact_clause(contacts)}",
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
    if not contacts:
        return "it touches nothing"
    parts = [f"{a} presses on {b} with {force:.3g} N" for (a, b), force in contacts.items()]
    return ", ".join(parts[:3])


def _silence(_message: str) -> None:
    """Suppress MuJoCo's log file in the working folder; warnings are read from its data."""


mujoco.set_mju_user_warning(_silence)
