"""Distances of a run, measured in another process while the physics goes on."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from harness.core.activity import Activity, unobserved
from harness.engine.execute import ProgramExecution
from harness.observation.beliefs import believed_poses
from harness.ports.simulation import Simulator
from harness.recording.motion import Motion
from harness.session.background import Background
from harness.session.prepare import Prepared

if TYPE_CHECKING:
    from harness.observation.measured_clearance import MeasuredClearance
    from harness.simulation.mujoco_simulator import MujocoSimulator

Parts = dict[int, "MeasuredClearance"]


class DistancesAhead:
    """Measures the parts of a run that are complete, one process after the other.

    The result is the same in whichever process a part is measured. Parts that are not complete, or
    that this process cannot fork for because it has threads, are left to be measured after the run.
    """

    def __init__(self, prepared: Prepared) -> None:
        self._prepared = prepared
        self._measured: Parts = {}
        self._begun = 0
        self._background: Background[Parts] | None = None
        self._earlier: list[Background[Parts]] = []

    def close(self) -> None:
        """End the processes, the one that is at work among them."""
        for background in (self._background, *self._earlier):
            if background is not None:
                background.close()

    def look(self, execution: ProgramExecution, simulator: Simulator) -> None:
        """Begin to measure the parts that are complete by now, unless others are being measured.

        Only the record of the physics is complete at once; that of a robot arrives later.
        """
        from harness.observation.sampled_clearance import complete_parts
        from harness.simulation.mujoco_simulator import MujocoSimulator

        if not isinstance(simulator, MujocoSimulator):
            return
        if self._background is not None and not self._background.has_message():
            return
        self._take()
        complete = complete_parts(simulator.sample_count, simulator.timestep)
        if complete > self._begun:
            numbers = range(self._begun, complete)
            background = Background(partial(self._parts, execution, simulator, numbers))
            if background.is_apart:
                self._background, self._begun = background, complete

    def part(self, number: int) -> MeasuredClearance | None:
        """A part that was measured, after waiting for it; None if it was left."""
        if number < self._begun and number not in self._measured:
            self._take()
        return self._measured.get(number)

    def _take(self) -> None:
        if self._background is not None:
            self._measured |= self._background.result(unobserved)
            self._earlier.append(self._background)
            self._background = None

    def _parts(
        self,
        execution: ProgramExecution,
        simulator: MujocoSimulator,
        numbers: range,
        _: Activity,
    ) -> Parts:
        """Parts of the run; in the other process."""
        from harness.observation.clearance import CoalClearance

        prepared, done = self._prepared, execution.finish()
        motion = simulator.motion()
        believed = believed_poses(done.beliefs, motion.joint_positions, prepared.ports.kinematics)
        poses = {**motion.object_poses, **believed}
        return CoalClearance(prepared.program.description).measured_parts(
            Motion(motion.times, motion.joint_positions, poses),
            done.objects,
            done.attachments,
            prepared.observations.recorded_cutoff,
            numbers,
        )
