"""Motors of a robot in the physics: set points in, recorded samples out."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from contextlib import AbstractContextManager, nullcontext

import mujoco
import numpy as np

from harness.core.errors import ModelRefused, StepFailed
from harness.core.types import FloatArray, IntArray
from harness.core.world import WorldObject
from harness.ports.joint_control import JointController
from harness.robot.description import RobotDescription
from harness.robot.end_effector import Gripper
from harness.simulation.adhesion import adhesion_of
from harness.simulation.disturbance import Disturbance
from harness.simulation.joint_drive import JointDrive
from harness.simulation.model import build_model
from harness.simulation.objects import Objects, overlaps
from harness.simulation.recording import Recording
from harness.simulation.set_points import SetPoints
from harness.simulation.step_state import refresh
from harness.simulation.surfaces import Surfaces
from harness.simulation.wrench_sensors import WrenchSensors


class Motors:
    """The physics of a run, whose motors follow set points of all actuated joints, m in number.

    Attributes:
        overlaps_at_start: Pairs of bodies that overlap at the start, deepest first.
        adhesion: The forces of its suction cups; None of a robot without.
    """

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
        self._drive = JointDrive(self.physics, self._data, gravity, timestep)
        self._command = description.start_positions()[self.physics.actuated]
        self._control = self._first_control()
        self._data.ctrl[:] = self._control
        self._grips: dict[int, float] = {}  # effort limits of grippers, by actuator
        self.disturbance = Disturbance(self.physics, self._data)
        self.adhesion = adhesion_of(self.physics, self._data)
        sensors, is_cell = description.wrench_sensors.values(), description.is_cell
        wrenches = WrenchSensors(sensors, timestep, seed, is_cell=is_cell)
        self._recording = Recording(self.physics, self._data, wrenches, self.adhesion)
        self._surfaces = Surfaces(self.physics, self._data, self._recording)
        refresh(self._model, self._data)
        self._refuse_unusable_start()
        self.overlaps_at_start = overlaps(self.physics, self._data)
        self._recording.start(self._command)
        self._objects = Objects(self.physics, self._data, self._recording, frozenset(present))
        for gripper in description.grippers:
            self.limit_grip(self.actuator_of(gripper), gripper.grip_effort)

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

    def use_controller(self, controller: JointController | None) -> None:
        """Let a controller move the arm's joints from now on.

        Args:
            controller: The controller; None for the robot's own, which holds the arm where it is.
        """
        if controller is None:
            arm = self._drive.arm
            self._command = self._command.copy()
            self._command[arm] = self.joint_positions()[self.physics.actuated[arm]]
        self._drive.use(controller)
        self.command(self._command)
        self.hold_samples(1)

    def joint_positions(self) -> FloatArray:
        """The measured joint positions, in description order."""
        return self._data.qpos[self.physics.qpos].copy()

    def commanded_positions(self) -> FloatArray:
        """The last set point in description order, mimic joints included."""
        return self._drive.whole_positions(self._command)

    def hold(self, duration: float) -> None:
        """Keep the last commands for a duration in simulation time [s]."""
        self.hold_samples(round(duration / self._timestep))

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
        effort *= self.disturbance.grip_share.get(actuator, 1.0)
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
            controls: Inputs of the motors at these; a controller that measures computes its own.
        """
        cycle = self._drive.cycle
        with self._moving():
            if cycle is None:
                self._step(points, controls)
                return
            for begin in range(0, len(points) - 1, cycle):
                part = points.part(begin, min(begin + cycle, len(points) - 1))
                self._step(part, self._drive.inputs(part, self.disturbance.measured_noise(1)[-1]))

    def _step(self, points: SetPoints, controls: FloatArray) -> None:
        arrived = self.disturbance.distorted(controls, self._drive.position_share)
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

    def gripper(self, joint: str) -> Gripper:
        """The gripper with a joint; by default the robot's first."""
        grippers = {gripper.joint: gripper for gripper in self.description.grippers}
        if not grippers:
            raise StepFailed("INVALID_GROUP_NAME", f"{self.description.name} has no gripper")
        return grippers[joint or next(iter(grippers))]

    def actuator_of(self, gripper: Gripper) -> int:
        """The index of a gripper's joint among the actuated ones."""
        place = self.description.joint_index[gripper.joint]
        return int(np.searchsorted(self.physics.actuated, place))


# No log file of MuJoCo's in the working folder: its warnings are read from its data.
mujoco.set_mju_user_warning(lambda _message: None)
