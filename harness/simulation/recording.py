"""Steps the physics and records every sample."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Collection, Mapping
from itertools import pairwise

import mujoco
import numpy as np

from harness.core.errors import SimulationDiverged, StepFailed
from harness.core.limits import LONGEST_RUN
from harness.core.types import FloatArray
from harness.core.wrench_sensor import Payload
from harness.recording.execution_failures import LengthFailure
from harness.recording.link_poses import replayed_link_poses
from harness.recording.signals import Signals
from harness.simulation.adhesion import Adhesion
from harness.simulation.contact_record import ROWS, BodyPair, ContactRecord, enlarged
from harness.simulation.model import ObjectPlace, PhysicsModel
from harness.simulation.step_state import refresh
from harness.simulation.wrench_sensors import WrenchSensors

MOST_BYTES = 2**30  # Largest record; judging it takes about four times as much
LOOK_BACK = 25  # Number of samples before a failure in which contacts are searched
_DIVERGED = (mujoco.mjtWarning.mjWARN_BADQACC, mujoco.mjtWarning.mjWARN_BADCTRL)


class Recording:
    """The samples of a run: row i is the state at `i * timestep` and the forces in it.

    The last row is always the current state of the physics. A step is made of the two calls that
    `mj_step` consists of, because that computes forces a second time where bodies fall asleep.

    Attributes:
        longest: The most simulated time of the run [s].
        contacts: The contacts of all samples.
    """

    def __init__(
        self,
        physics: PhysicsModel,
        data: mujoco.MjData,
        wrenches: WrenchSensors,
        adhesion: Adhesion | None,
    ) -> None:
        model = physics.model
        self.wrenches = wrenches
        self._adhesion = adhesion
        self._physics = physics
        self._data = data
        self._qpos = np.empty((ROWS, model.nq))
        self._qvel = np.empty((ROWS, model.nv))
        self._sensors = np.empty((ROWS, model.nsensordata))
        self._commands = np.empty((ROWS, model.nu))
        self._command_velocities = np.empty((ROWS, model.nu))
        self.contacts = ContactRecord(physics, data)
        self.count, self.longest = 0, LONGEST_RUN

    def start(self, command: FloatArray) -> None:
        """Record sample 0: the state before the first step."""
        self._qpos[0], self._qvel[0] = self._data.qpos, self._data.qvel
        self._commands[0], self._command_velocities[0] = command, 0.0
        self.count = 1
        self._record_forces_of_last_row()

    def advance(
        self, controls: FloatArray, commands: FloatArray, command_velocities: FloatArray
    ) -> None:
        """Step once for each row of `controls` except the last; the last sample is the new state.

        Args:
            controls: The controls from one sample to the next, and one more row for the state
                reached: its recorded forces are those of a servo at its set point,
                shape (N + 1, m).

        Raises:
            SimulationDiverged: The state left the finite numbers.
        """
        steps = len(controls) - 1
        if steps <= 0:
            return
        first = self.count
        for name in ("_qpos", "_qvel", "_sensors", "_commands", "_command_velocities"):
            setattr(self, name, enlarged(getattr(self, name), first + steps))
        self._commands[first : first + steps] = commands
        self._command_velocities[first : first + steps] = command_velocities
        model, data = self._physics.model, self._data
        forward, check, integrate = mujoco.mj_forward, mujoco.mj_checkAcc, mujoco.mj_implicit
        control, qpos, qvel, sensors = data.ctrl, data.qpos, data.qvel, data.sensordata
        positions, velocities, sensed = self._qpos, self._qvel, self._sensors
        keep_contacts, adhesion = self.contacts.keep, self._adhesion
        for row in range(first, first + steps):
            control[:] = controls[row - first]
            forward(model, data)
            if row > first:
                sensed[row - 1] = sensors
                keep_contacts()
            if adhesion is not None:
                adhesion.apply(row)
            check(model, data)
            integrate(model, data)
            positions[row] = qpos
            velocities[row] = qvel
        control[:] = controls[-1]
        self.count = first + steps
        self._refuse_divergence(first)
        self._record_forces_of_last_row()

    def refuse_beyond(self, steps: int) -> None:
        """Check that a number of further samples can be recorded.

        Raises:
            StepFailed: TIMED_OUT; the run would exceed its longest time or the memory limit.
        """
        end = (self.count - 1 + steps) * self.timestep
        if end > self.longest * (1 + 1e-9):
            raise StepFailed(
                "TIMED_OUT",
                f"the run would go on to t={end:.0f} s; it may take {self.longest:g} s of simulated"
                " time: shorten it, or make it several scenarios",
                LengthFailure(self.longest, end=end),
            )
        rows = (self._qpos, self._qvel, self._sensors, self._commands, self._command_velocities)
        per_row = 8 * (1 + sum(array.shape[1] for array in rows))
        size = (self.count + steps) * per_row + self.contacts.nbytes
        if size > MOST_BYTES:
            raise StepFailed(
                "TIMED_OUT",
                f"the record of the run would grow to {size / 2**20:.0f} MiB by t={end:.1f} s, and"
                f" {MOST_BYTES / 2**20:.0f} MiB are the limit: use fewer objects that move, a"
                " longer time step, or several scenarios",
                LengthFailure(MOST_BYTES, bytes=size),
            )

    def rewind(self, count: int) -> None:
        """Forget all samples after the first `count`; the physics stands at the last one kept."""
        self.count = count
        self.contacts.rewind(count)
        self.wrenches.rewind(count)
        if self._adhesion is not None:
            self._adhesion.rewind(count)

    def replace_last(self, command: FloatArray) -> None:
        """Make the last sample the current state, after a change that was not recorded."""
        row = self.count - 1
        self.contacts.rewind(row)
        self._qpos[row], self._qvel[row] = self._data.qpos, self._data.qvel
        self._commands[row], self._command_velocities[row] = command, 0.0
        self._record_forces_of_last_row()

    def _record_forces_of_last_row(self) -> None:
        """Record the forces of the current state without changing the physics state."""
        refresh(self._physics.model, self._data)
        self._sensors[self.count - 1] = self._data.sensordata
        self.contacts.keep()

    def _refuse_divergence(self, first: int) -> None:
        rows = self._qpos[first : self.count], self._qvel[first : self.count]
        warned = any(self._data.warning[kind].number for kind in _DIVERGED)
        if not warned and all((np.abs(part[-1]) <= mujoco.mjMAXVAL).all() for part in rows):
            return
        usable = np.logical_and(*((np.abs(part) <= mujoco.mjMAXVAL).all(axis=1) for part in rows))
        row = first + (0 if usable.all() else int(np.argmin(usable)))
        raise SimulationDiverged(
            f"the physics left the finite numbers near t={row * self.timestep:.3f} s"
        )

    @property
    def timestep(self) -> float:
        """Time between samples [s]."""
        return float(self._physics.model.opt.timestep)

    def times(self) -> FloatArray:
        """Simulation time of every sample [s], shape (N,)."""
        return np.arange(self.count, dtype=np.float64) * self.timestep

    def joint_positions(self, first: int) -> FloatArray:
        """Measured positions from a sample on, description order, shape (N, n)."""
        return self._qpos[first : self.count, self._physics.qpos]

    def joint_velocities(self, first: int) -> FloatArray:
        """Measured velocities from a sample on, description order, shape (N, n)."""
        return self._qvel[first : self.count, self._physics.dof]

    def fastest(self, first: int) -> tuple[str, float, str]:
        """Find the joint or object with the largest mean velocity component from a sample on.

        A mean, because a cylinder that stands on a box rocks by some mrad/s from step to step, as
        its points of contact change, and goes nowhere.

        Returns:
            Its name, empty when nothing can move, the component's size, and its unit.
        """
        dofs = [int(dof) for dof in self._physics.dof]
        joints = self._physics.description.movable_joints
        names = [joint.name for joint in joints]
        units = [f"{joint.position_unit}/s" for joint in joints]
        for name, place in self._physics.objects.items():
            if place.dof >= 0:
                count = 6 if place.obj.joint is None else 1
                dofs += range(place.dof, place.dof + count)
                names += [name] * count
                units += ["m/s"] * 3 + ["rad/s"] * 3 if count == 6 else ["m/s or rad/s"]
        speeds = np.abs(self._qvel[first : self.count, dofs].mean(axis=0))
        if not len(dofs):
            return "", 0.0, ""
        worst = int(np.argmax(speeds))
        return names[worst], float(speeds[worst]), units[worst]

    def actuator_efforts(self) -> FloatArray:
        """Efforts of the actuated joints at the last sample, shape (m,)."""
        return self._sensors[self.count - 1, self._effort_columns]

    @property
    def _effort_columns(self) -> slice:
        """The efforts' columns of `_sensors`: after the frames, before the wrenches."""
        start = 7 * (1 + len(self._physics.frames))
        return slice(start, start + len(self._physics.actuated))

    def wrench(self, name: str, first: int, *, tared: bool = True) -> FloatArray:
        """What a sensor of force and torque reads from a sample on, in its axes, shape (N, 6)."""
        measured = self._sensors[:, self._effort_columns.stop :]
        found = self.wrenches.readings(name, measured, first, self.count - first, tared=tared)
        payloads = self.wrenches.payloads(name) if tared else []
        for (since, payload), (until, _) in pairwise([*payloads, (self.count, None)]):
            if payload is not None and until > first:
                weight = self.weight(name, payload, max(since, first))
                rows = slice(max(since, first) - first, until - first)
                found[rows] -= weight[: rows.stop - rows.start]
        return found

    def weight(self, name: str, payload: Payload, first: int) -> FloatArray:
        """The weight of a payload in a sensor's readings from a sample on, shape (N, 6)."""
        sensor, physics = self.wrenches.sensors[name], self._physics
        _, rows = self.wrenches.rows_read(name, first, self.count - first)
        positions = self._qpos[rows][:, physics.qpos]
        poses = replayed_link_poses(physics.description, positions, [sensor.link])[sensor.link]
        return payload.weight(sensor, poses, physics.model.opt.gravity)

    def strongest_robot_contacts(self, row: int) -> dict[BodyPair, float]:
        """Largest force [N] of each pair with a robot link just before a sample, largest first."""
        links = set(self._physics.description.link_names)
        peaks = {
            pair: float(force.max())
            for pair, force in self.contacts.forces(max(0, row - LOOK_BACK), row + 1).items()
            if pair[0] in links
        }
        return dict(sorted(peaks.items(), key=lambda item: -item[1]))

    def signals(
        self,
        object_poses: Mapping[str, FloatArray],
        surfaces: Mapping[str, FloatArray],
        first: int = 0,
    ) -> Signals:
        """All recorded signals from a sample on.

        Args:
            object_poses: T_world_object of each object, NaN while absent, shape (N, 7) each.
            surfaces: The velocity of the surface of each belt, as in `Signals.surfaces`.
        """
        physics, last = self._physics, self.count
        count, rows = last - first, slice(first, last)
        joints = len(physics.qpos)
        commands, command_velocities = (np.full((count, joints), np.nan) for _ in range(2))
        efforts = np.zeros((count, joints))
        frame_end = 7 * (1 + len(physics.frames))
        commands[:, physics.actuated] = self._commands[rows]
        command_velocities[:, physics.actuated] = self._command_velocities[rows]
        efforts[:, physics.actuated] = self._sensors[rows, self._effort_columns]
        frames = self._sensors[rows, :frame_end].reshape(count, -1, 7)
        contacts = self.contacts.forces(first, last)
        moved = {name: rows * self.timestep for name, rows in surfaces.items()}
        return Signals(
            times=self.times()[first:],
            joint_positions=self.joint_positions(first).copy(),
            joint_velocities=self.joint_velocities(first).copy(),
            joint_efforts=efforts,
            joint_commands=commands,
            joint_command_velocities=command_velocities,
            tcp_pose=frames[:, 0].copy(),
            frames={name: frames[:, i + 1].copy() for i, name in enumerate(physics.frames)},
            object_poses=dict(object_poses),
            contact_forces=contacts,
            support_forces=self.contacts.support_forces(first, last),
            presses=self.contacts.presses(first, last),
            frictions=self.contacts.frictions(first, last),
            pulls={}
            if self._adhesion is None
            else {pair: values[first:] for pair, values in self._adhesion.recorded(last).items()},
            wrenches={name: self.wrench(name, first) for name in self.wrenches.sensors},
            slides=self.contacts.slides(
                first, last, object_poses, self._moved_by_robot(contacts), moved
            ),
            surfaces=dict(surfaces),
        )

    def _moved_by_robot(self, pairs: Collection[BodyPair]) -> set[str]:
        """Free objects that the robot touches, or that touch such: it may hold or carry them."""
        links = {self._physics.body_names[body] for body in self._physics.robot_bodies}
        free = {name for name, place in self._physics.objects.items() if place.qpos >= 0}
        found, added = set[str](), links
        while added:
            near = {name for pair in pairs if added & set(pair) for name in pair}
            added = (near & free) - found
            found |= added
        return found

    def poses(self, place: ObjectPlace, first: int = 0) -> FloatArray:
        """Recorded T_world_object of an object that can move, from a sample on, shape (N, 7)."""
        rows = slice(first, self.count)
        if place.obj.joint is None:
            return self._qpos[rows, place.qpos : place.qpos + 7].copy()
        return place.obj.joint.poses(self._qpos[rows, place.qpos])
