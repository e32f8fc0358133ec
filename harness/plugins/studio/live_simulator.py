"""The physics of a run, paced by the wall clock, with motions that no file commands."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from typing import Any

import mujoco
import numpy as np

from harness.core.errors import StepFailed
from harness.core.types import FloatArray
from harness.plugins.studio.snapshot import (
    OF_FAULTS,
    PhysicsState,
    changed_arrays,
    load_state,
    set_step_state,
    step_state,
)
from harness.simulation.mujoco_simulator import MujocoSimulator
from harness.simulation.set_points import SetPoints
from harness.simulation.step_state import refresh, wake

CHUNK = 16  # samples between two calls of the pace; the results do not depend on it
Pace = Callable[[int], bool]  # waits as long as the samples last; whether to go on


class LiveSimulator(MujocoSimulator):
    """The simulator of a run; its samples are the same, however fast they are shown.

    Between steps of a program the physics may also go on without a record, while the set points of
    joints are moved by hand.

    Attributes:
        pace: Called while a step of a program advances the physics; None: as fast as possible.
        stop_sample: The number of samples at which a motion is stopped; None lets it go on.
        was_stopped: Whether the last motion was stopped by hand.
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:
        self.pace: Pace | None = None
        self.stop_sample: int | None = None
        self.was_stopped = False
        super().__init__(*arguments, **options)

    def idle(self, samples: int) -> None:
        """Step without a record; set points stay where they are."""
        self._data.ctrl[:] = self._control
        if self.adhesion is not None:
            for _ in range(samples):
                self.adhesion.apply(self.sample_count, anew=True)
                mujoco.mj_step(self._model, self._data)
            self.adhesion.rewind(self.sample_count)
        else:
            mujoco.mj_step(self._model, self._data, nstep=samples)
        refresh(self._model, self._data)

    def resume_record(self) -> None:
        """Let the record go on from the current state, after motions without a record."""
        wake(self._model, self._data)  # the record holds no contacts of what fell asleep since
        self._recording.replace_last(self._command)

    @property
    def physics_time(self) -> float:
        """Simulation time, that without a record included [s]."""
        return float(self._data.time)

    def set_points(self) -> FloatArray:
        """Set points of the actuated joints, shape (m,)."""
        return self._command.copy()

    def jog(self, target: FloatArray, most: FloatArray) -> None:
        """Move the set points of actuated joints towards a target.

        Args:
            target: The set points that are requested, shape (m,).
            most: Farthest that each may move now, shape (m,).
        """
        self.command(self._command + np.clip(target - self._command, -most, most))

    def contact_forces(self) -> dict[tuple[str, str], float]:
        """Normal forces of pairs of bodies in contact now [N]."""
        names = self.physics.body_names
        state = step_state(self._model, self._data)
        wake(self._model, self._data)
        found: dict[tuple[str, str], float] = {}
        force = np.zeros(6)
        for index in range(self._data.ncon):
            mujoco.mj_contactForce(self._model, self._data, index, force)
            bodies = self._model.geom_bodyid[self._data.contact.geom[index]]
            first, second = sorted(names[int(body)] for body in bodies)
            if force[0] > 0:
                found[first, second] = found.get((first, second), 0.0) + float(force[0])
        set_step_state(self._model, self._data, state)
        return found

    def snapshot(self) -> PhysicsState:
        """Everything that decides how the run continues."""
        return PhysicsState(
            step_state(self._model, self._data),
            changed_arrays(self._model),
            self.sample_count,
            self._command.copy(),
            self._control.copy(),
            dict(self._grips),
            {joint: gripper.pending for joint, gripper in self._grippers.items()},
            deepcopy(self._drive.controller),
            {name: deepcopy(getattr(self.disturbance, name)) for name in OF_FAULTS},
            deepcopy(self._objects.log),
            deepcopy(self._surfaces.log),
        )

    def restore(self, state: PhysicsState) -> None:
        """Go back to a snapshot of this simulator; later samples are forgotten."""
        load_state(self._model, self._data, state)
        self._command, self._control = state.command.copy(), state.control.copy()
        self._grips = dict(state.grips)
        self._drive.restore(state.controller)
        for joint, gripper in self._grippers.items():
            gripper.pending = state.pending[joint]
        self._objects.log = deepcopy(dict(state.objects))
        for name, value in state.faults.items():
            setattr(self.disturbance, name, deepcopy(value))
        self._surfaces.log = deepcopy(dict(state.surfaces))
        self._recording.rewind(state.samples)

    def _step(self, points: SetPoints, controls: FloatArray) -> None:
        count = len(points) - 1
        begin, self.was_stopped = 0, False
        while begin < count:
            left = count if self.stop_sample is None else self.stop_sample - self.sample_count
            end = min(begin + (count if self.pace is None else CHUNK), count, begin + left)
            if end > begin:
                super()._step(points.part(begin, end), controls[begin : end + 1])
            goes_on = self.pace is None or self.pace(end - begin)
            if end == begin or not goes_on:
                self.was_stopped = True
                self.command(points.positions[max(1, end)])
                raise StepFailed("PREEMPTED", "the motion was stopped by hand")
            begin = end
