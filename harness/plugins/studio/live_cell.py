"""A live robot cell: the scenario's program on the engine, planner and physics of a run."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from harness.cell.cell import Cell
from harness.cell.program import ProgramStep
from harness.core.errors import StepFailed
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.planning.collision.scene import CoalScene
from harness.plugins.studio.cell_state import CellState
from harness.plugins.studio.document import Document
from harness.plugins.studio.files import StudioFiles
from harness.plugins.studio.live_simulator import LiveSimulator, Pace
from harness.ports.motion_planning import MotionPlan
from harness.ports.scene import Touch
from harness.recording.step_record import StepRecord
from harness.robot.description import RobotDescription
from harness.session.execute import OnStep, ProgramExecution
from harness.session.prepare import Prepared, prepare
from harness.session.start import start_physics

STILL = 5e-4  # a joint or an object that is no farther from where it was has not moved [rad, m]


def _no_step(*_: object) -> None:
    return


def _added(prepared: Prepared) -> bytes:
    """The objects that steps add, which the physics has from its start."""
    return pickle.dumps(dict(prepared.program.later_objects))


class LiveCell:
    """The cell of a scenario, in any state between its start and its end, or moved by hand.

    Not thread-safe: one thread does everything.

    Attributes:
        files: The scenario's file, whether it exists or not, and the folder that may be read.
        document: The text that the cell was compiled from.
        history: Snapshots: at the start, then after every step that was executed.
        is_by_hand: Whether something was moved by hand since the last snapshot.
        chosen_arm: The arm that the page chose, of a robot with several.
    """

    def __init__(self, files: StudioFiles, document: Document, on_step: OnStep = _no_step) -> None:
        """Build the cell at the scenario's start.

        Raises:
            SpecError: With every problem of the text.
        """
        self.files = files
        self.on_step = on_step
        self.pace: Pace | None = None
        self.history: list[CellState] = []
        self.is_by_hand = False
        self.chosen_arm = ""
        self._build(document)

    # -- the scenario -------------------------------------------------------------------------

    def load(self, document: Document) -> bool:
        """Take a changed text; the state is kept as far as its steps are still those executed.

        Returns:
            Whether the cell was built again, at its start.

        Raises:
            SpecError: With every problem of the text; the cell is as it was.
        """
        prepared = self.prepared_as(document)
        is_same = document.base_key() == self.document.base_key()
        is_same = is_same and _added(prepared) == _added(self.prepared)
        if not is_same or set(prepared.observed_links) - set(self.prepared.observed_links):
            self._build(document, prepared)
            return True
        executed = self._keys[: self.steps_done]
        keys = document.step_keys()
        equal = 0
        while equal < min(len(keys), len(executed)) and keys[equal] == executed[equal]:
            equal += 1
        self.document, self._keys = document, keys
        observed = self.prepared.observed_links
        # the planner, the scene and the kinematics go on; they know nothing of the steps
        self.prepared = replace(prepared, ports=self.prepared.ports)
        self._has_same_links = prepared.observed_links == observed
        self.execution.program = prepared.program
        self.cell.later_objects = prepared.program.later_objects
        if equal < self.steps_done:
            self.restore(equal)
        return False

    @property
    def description(self) -> RobotDescription:
        """The robot; of one with several arms, with the arm that is moved by hand selected."""
        robot = self.prepared.program.description
        return robot.of_arm[self.arm] if robot.arms else robot

    @property
    def arm(self) -> str:
        """The arm that is moved by hand, of a robot with several; the default one, or the first."""
        robot = self.prepared.program.description
        names = list(robot.of_arm)
        return self.chosen_arm if self.chosen_arm in names else robot.default_arm or names[0]

    @property
    def cell(self) -> Cell:
        """The cell that steps work with."""
        return self.execution.cell

    @property
    def scene(self) -> CoalScene:
        """The planning scene."""
        scene = self.prepared.ports.scene
        assert isinstance(scene, CoalScene)
        return scene

    @property
    def steps_done(self) -> int:
        """The number of steps of the file that were executed."""
        return self.history[-1].steps

    @property
    def is_run(self) -> bool:
        """Whether a run of the file would be in the same state."""
        return self.history[-1].is_run and not self.is_by_hand

    @property
    def has_run_digest(self) -> bool:
        """Whether a run of the file would have recorded the same, and no less."""
        return self.is_run and self._has_same_links

    def prepared_as(self, document: Document) -> Prepared:
        """A text as it is compiled in the place of the cell's own.

        Raises:
            SpecError: With every problem of the text.
        """
        self.files.refuse_outside(document.root)
        text, inspect = document.compiled_text(), self.files.refuse_used_outside
        return prepare(self.files.path, text=text, inspect=inspect)

    # -- executing steps ----------------------------------------------------------------------

    def run_steps(self, end: int) -> None:
        """Execute the steps of the file up to a number of them, or to the first that fails.

        After motions by hand the steps go on from where the cell stands; otherwise every sample is
        the one of a run.
        """
        steps = self.execution.program.steps
        if not self.document.step_count:
            return
        while self.steps_done < min(end, len(steps)) and not self.execution.ended_early:
            self._continue_record()
            self.simulator.pace = self.pace
            try:
                self.execution.run([steps[self.steps_done]])
            finally:
                self.simulator.pace = None
            self._keep(self.steps_done + 1)

    def run_until(self, time: float) -> None:
        """Execute the file's steps from the start up to a moment; a step is stopped in its middle.

        Args:
            time: Simulated time from the start [s].
        """
        self.reset()
        self.simulator.stop_sample = round(time / self.timestep) + 1
        try:
            self.run_steps(self.document.step_count)
        finally:
            self.simulator.stop_sample = None
        if self.execution.ended_early:
            self.execution.ended_early = ""
            self.history[-1] = replace(self.history[-1], ended_early="")

    def go_to(self, count: int) -> None:
        """Make the state the one after some steps: forwards by executing, backwards restored."""
        if count < self.steps_done or self.is_by_hand or not self.is_run:
            last_of_run = max(state.steps for state in self.history if state.is_run)
            self.restore(min(count, last_of_run))
        self.run_steps(count)

    def step_back(self) -> None:
        """Undo motions by hand since the last step, else the last step; exact to the bit."""
        self.restore(self.steps_done if self.is_by_hand else max(0, self.steps_done - 1))

    def restore(self, count: int) -> None:
        """Restore the state after some executed steps; later ones are forgotten."""
        del self.history[count + 1 :]
        self._restore(self.history[-1])

    def reset(self) -> None:
        """Go back to the start."""
        self.restore(0)

    def execute(self, text: str) -> StepRecord:
        """Execute one step by hand, given as in a file; the scenario does not get it.

        Raises:
            SpecError: The step has a mistake.
        """
        step = self._step_by_hand(text)
        self._continue_record()
        self.is_by_hand = True
        self.simulator.pace = self.pace
        try:
            return self._run_aside(step)
        finally:
            self.simulator.pace = None

    def planned_only(self, text: str, keep: Callable[[MotionPlan], None]) -> StepRecord:
        """Execute a step up to its first motion, which `keep` takes, and which it ends by raising.

        Raises:
            SpecError: The step has a mistake.
        """
        step = self._step_by_hand(text)
        self._continue_record()
        before, on_step = self._saved(self.steps_done), self.on_step
        was_by_hand = self.is_by_hand
        vars(self.cell)["carry_out"] = lambda plan, *_: keep(plan)
        self.on_step = _no_step
        try:
            return self._run_aside(step)
        finally:
            del vars(self.cell)["carry_out"]
            self.on_step = on_step
            self._restore(before)
            self.is_by_hand = was_by_hand

    def _step_by_hand(self, text: str) -> ProgramStep:
        """A step as the scenario's next one would be, seed included."""
        document = self.document.with_step(text, self.steps_done)
        prepared = self.prepared_as(document)
        if _added(prepared) != _added(self.prepared):
            raise StepFailed("INVALID_OBJECT_NAME", "objects are added to the scenario's `objects`")
        return prepared.program.steps[self.steps_done]

    def _run_aside(self, step: ProgramStep) -> StepRecord:
        """Run a step whose record is not the scenario's."""
        first, ended = len(self.execution.records), self.execution.ended_early
        try:
            self.execution.run([step])
        finally:
            self.execution.ended_early = ended
        record = self.execution.records[first]
        del self.execution.records[first:]
        return record

    def record(self, text: str, *, if_moved: bool = False) -> tuple[str, StepRecord]:
        """Put a step into the scenario after those executed, and execute it.

        A step that adds new objects needs another physics: the steps before it are repeated there.

        Args:
            text: The step, given as in a file.
            if_moved: Whether a step after which everything is where the step before it left it is
                taken out again.

        Returns:
            The scenario's text, which has the step only where it succeeded; and its result.
        """
        before, count = self.document, self.steps_done
        state = self.history[-1]
        if self.load(before.with_step(text, count)):
            self.repeat(count)
        after = self.document.text
        self.run_steps(count + 1)
        record = next(r for r in self.execution.records if r.path == f"steps[{count}]")
        if record.status == "failed" or (if_moved and not self._has_moved(state)):
            self.restore(count)
            if self.load(before):
                self.repeat(count)
            return before.text, record
        return after, record

    def _has_moved(self, state: CellState) -> bool:
        """Whether a joint or an object is elsewhere than in a state."""
        now = self.simulator.objects_now()
        pairs = [(state.joint_positions, self.joint_positions())]
        pairs += [(pose, now.get(name, pose)) for name, pose in state.objects.items()]
        return any(np.abs(one - two).max(initial=0.0) > STILL for one, two in pairs)

    def repeat(self, count: int) -> None:
        """Execute the first steps as fast as possible."""
        pace, self.pace = self.pace, None
        try:
            self.run_steps(count)
        finally:
            self.pace = pace

    # -- the live physics ---------------------------------------------------------------------

    def idle(self, seconds: float) -> None:
        """Let physics go on without a record."""
        self._is_idle = True
        self.simulator.idle(max(1, round(seconds / self.timestep)))

    def jog(self, target: FloatArray, share: float, seconds: float) -> None:
        """Move set points towards a target for some simulated time.

        Args:
            target: Joint positions in description order.
            share: Share of the velocity limits, (0, 1].
            seconds: The simulated time that passes [s].
        """
        actuated = self.simulator.physics.actuated
        limits = np.array([joint.velocity for joint in self.description.movable_joints])
        self.is_by_hand = True
        self.simulator.jog(target[actuated], share * seconds * limits[actuated])
        self.idle(seconds)

    @property
    def timestep(self) -> float:
        """The physics step [s]."""
        return self.prepared.program.world.timestep

    def joint_positions(self) -> FloatArray:
        """Measured joint positions, description order."""
        return self.simulator.joint_positions()

    def tcp_pose(self) -> SE3:
        """T_world_tcp of the measured positions."""
        kinematics = self.prepared.ports.kinematics
        return kinematics.link_pose(self.joint_positions(), self.description.tcp_link)

    def object_poses(self) -> dict[str, SE3]:
        """T_world_object of every object that is there."""
        positions = self.joint_positions()
        poses: dict[str, SE3] = {}
        for name, presence in self.cell.presence.items():
            if not presence.is_there:
                continue
            if presence.obj.in_simulation:
                poses[name] = self.simulator.object_pose(name)
            elif name in self.scene.object_names():
                poses[name] = self.scene.object_pose(name, positions)
        return poses

    def object_vectors(self) -> dict[str, FloatArray]:
        """T_world_object (xyz, quat wxyz) of every object that is there, shape (7,) each."""
        return {name: pose.as_vector() for name, pose in self.object_poses().items()}

    def nearest_pair(self) -> tuple[Touch, FloatArray] | None:
        """The pair of bodies with the smallest clearance now, and its nearest points, (2, 3)."""
        self.cell.sync_scene()
        return self.scene.nearest_points(self.joint_positions())

    # -- inside -------------------------------------------------------------------------------

    def _build(self, document: Document, prepared: Prepared | None = None) -> None:
        prepared = prepared or self.prepared_as(document)
        simulator = start_physics(prepared, LiveSimulator, frames=prepared.observed_links)
        self.document, self.prepared, self.simulator = document, prepared, simulator
        self._keys = document.step_keys()
        self._has_same_links = True
        self.execution = ProgramExecution(
            prepared.program, prepared.ports, simulator, lambda *of: self.on_step(*of)
        )
        self.history = []
        self._keep(0)

    def _continue_record(self) -> None:
        """Make the record end in the current state, or the state the one where it ends."""
        if self.is_by_hand:
            self.simulator.resume_record()
            return
        if self._is_idle:
            self._restore(self.history[-1])

    def _keep(self, steps: int) -> None:
        """Keep a snapshot after a step."""
        self.history.append(self._saved(steps))
        self.is_by_hand = self._is_idle = False

    def _saved(self, steps: int) -> CellState:
        is_run = not self.history or (self.is_run and not self.simulator.was_stopped)
        return CellState.of(self.execution, self.simulator, self.scene, steps, is_run=is_run)

    def _restore(self, state: CellState) -> None:
        state.restore(self.execution, self.simulator, self.scene)
        self.is_by_hand = self._is_idle = False
