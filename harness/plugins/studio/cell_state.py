"""A snapshot of a live cell: physics, planning scene, and what the steps believe and recorded."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from harness.cell.holding import Held
from harness.cell.scene_state import Belief, Presence
from harness.core.types import FloatArray
from harness.planning.collision.collision_model import SceneState
from harness.planning.collision.scene import CoalScene
from harness.plugins.studio.live_simulator import LiveSimulator
from harness.plugins.studio.snapshot import PhysicsState
from harness.recording.run import AttachmentRecord
from harness.recording.step_record import StepRecord
from harness.session.execute import ProgramExecution


@dataclass(frozen=True, eq=False)
class CellState:
    """A snapshot of the cell after some steps of the file.

    Attributes:
        steps: The number of steps of the file that were executed.
        is_run: Whether a run of the file would be in the same state.
        joint_positions: Measured joint positions, description order.
        objects: T_world_object (xyz, quat wxyz) of the objects in the physics, shape (7,) each.
    """

    steps: int
    is_run: bool
    joint_positions: FloatArray
    objects: Mapping[str, FloatArray]
    physics: PhysicsState
    scene: SceneState
    presence: Mapping[str, Presence]
    attachments: tuple[AttachmentRecord, ...]
    held: tuple[Held, ...]
    beliefs: Mapping[str, tuple[Belief, ...]]
    records: tuple[StepRecord, ...]
    ended_early: str

    @classmethod
    def of(
        cls,
        execution: ProgramExecution,
        simulator: LiveSimulator,
        scene: CoalScene,
        steps: int,
        *,
        is_run: bool,
    ) -> CellState:
        """The state of a cell after some steps of its file."""
        cell = execution.cell
        return cls(
            steps,
            is_run,
            simulator.joint_positions(),
            simulator.objects_now(),
            simulator.snapshot(),
            scene.snapshot(),
            _copied(cell.presence),
            tuple(cell.attachments),
            tuple(cell.held),
            {name: tuple(beliefs) for name, beliefs in cell.beliefs.items()},
            tuple(execution.records),
            execution.ended_early,
        )

    def restore(
        self, execution: ProgramExecution, simulator: LiveSimulator, scene: CoalScene
    ) -> None:
        """Put a cell back into this state, exact to the bit."""
        cell = execution.cell
        simulator.restore(self.physics)
        scene.restore(self.scene)
        cell.presence = _copied(self.presence)
        cell.attachments[:] = self.attachments
        cell.held[:] = self.held
        cell.beliefs = {name: list(beliefs) for name, beliefs in self.beliefs.items()}
        execution.records[:] = self.records
        execution.ended_early = self.ended_early


def _copied(presence: Mapping[str, Presence]) -> dict[str, Presence]:
    return {
        name: replace(each, intervals=[list(interval) for interval in each.intervals])
        for name, each in presence.items()
    }
