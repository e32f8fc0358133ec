"""The live part of the studio: its thread, its physics, and what every page is shown."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

import numpy as np

from harness.cell.program import ProgramStep
from harness.core.errors import Problem, SpecError
from harness.core.printable import printable
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.plugins.studio.document import Document, robot_alone
from harness.plugins.studio.files import StudioFiles
from harness.plugins.studio.judging import LiveVerdicts
from harness.plugins.studio.live_camera import LiveCamera
from harness.plugins.studio.live_cell import LiveCell
from harness.plugins.studio.messages import cell_message, problem_message, robot_message
from harness.plugins.studio.reach import Reach, ReachStudy
from harness.plugins.studio.scene_view import SceneView
from harness.plugins.studio.session import FRAME, Message, RefusedError, Session
from harness.plugins.studio.verdict_messages import NO_VERDICTS
from harness.ports.scene import Touch
from harness.recording.step_record import StepRecord

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 0.0)  # simulated by wall time; 0 is without a limit
MEASURED_EVERY = 5  # updates of the page between two measurements of the smallest clearance


class LiveStudio:
    """The cell's thread: physics that continues, joints that are moved by hand, what pages see.

    Attributes:
        text: The text in the editor, with mistakes or without.
        saved: The text of the file.
        problems: The mistakes of `text`; the cell is then that of an earlier text, or the robot
            alone, or there is none.
    """

    def __init__(self, files: StudioFiles, text: str, notice: str = "") -> None:
        """Build the cell of a text, or of its robot alone where it has mistakes."""
        self.files = files
        self.text = self.saved = text
        self.notice = notice
        self.problems: list[Problem] = []
        self._cell: LiveCell | None = None
        self.is_alone = False
        self._unkept = ""
        self.session = Session(
            self.do,
            self._frame,
            self._greeting,
            {
                "stop": self._stop,
                "play": self._play,
                "speed": self._set_speed,
                "recording": self._set_recording,
            },
            self._recover,
        )
        self.view = SceneView(self.session.broadcast)
        self.is_playing, self.speed, self.share = True, 1.0, 0.3
        self.is_recording, self.follows = True, False
        self.stopping = threading.Event()
        self.busy = ""
        self.target: FloatArray | None = None
        self.study: ReachStudy | None = None
        self.reach: Reach | None = None
        self.chosen: FloatArray | None = None
        self.verdicts, self.camera = LiveVerdicts(), LiveCamera()
        self._last_tick = self._last_scene = time.monotonic()
        self._due, self._frames = 0.0, 0
        self._lived = self._physics_time = 0.0
        self.nearest: Touch | None = None
        self.dragged: dict[str, FloatArray] = {}
        self._actions: dict[str, Callable[[Message], Message]] = {
            name.removeprefix("do_"): getattr(self, name)
            for name in dir(self)
            if name.startswith("do_")
        }

        self.take_text(text)

    # -- the text and its cell ----------------------------------------------------------------

    @property
    def cell(self) -> LiveCell:
        """The live cell.

        Raises:
            RefusedError: There is none: the text never had a robot that can be loaded.
        """
        if self._cell is None:
            raise RefusedError("there is no robot yet: correct the marked lines first")
        return self._cell

    def take_text(self, text: str) -> bool:
        """Compile a text; with mistakes, the cell stays, or is the robot alone.

        Returns:
            Whether the cell was built, or built again.
        """
        self._set_text(text)
        try:
            is_new = self._compile(text)
        except SpecError as error:
            self.problems = list(error.problems)
        else:
            self.is_alone = False
            return is_new
        if self._cell is not None and not self.is_alone:
            return False
        try:
            is_new = self._compile(robot_alone(text))
        except SpecError:
            return False
        self.is_alone = True
        return is_new

    def _set_text(self, text: str) -> None:
        self.text, self.problems = text, []
        if text != self.verdicts.text:
            self.forget_verdicts()

    def forget_verdicts(self) -> None:
        """Take the verdicts away from every page: they are of another text or another state."""
        if self.verdicts.text:
            self.verdicts.forget()
            self.session.broadcast(NO_VERDICTS)

    def keep_unsaved(self, text: str) -> None:
        """Keep a copy of the text; where that is not possible, say so once."""
        problem = self.files.keep_unsaved(text)
        if problem and problem != self._unkept:
            self.say("warning", problem)
        self._unkept = problem

    def _compile(self, text: str) -> bool:
        document = Document(text, str(self.files.path))
        if self._cell is not None:
            return self._cell.load(document)
        self._cell = LiveCell(self.files, document, self._on_step)
        self._cell.pace = self._pace
        return True

    # -- the server and the thread ------------------------------------------------------------

    def close(self) -> None:
        """End; unsaved work stays in its file."""
        self.stopping.set()
        self.session.stop()
        self.verdicts.forget()
        self.camera.look("")

    def show_cell(self) -> None:
        """Show every page the cell that was built, and where its bodies are."""
        if self._cell is None:
            return
        self.dragged = {}
        program = self.cell.prepared.program
        self.view.show_robot(program.description)
        self.view.show_objects(program.all_objects())
        self._move()
        self.put_handle()
        self.study = self.target = None
        self.clear_preview()
        self._pause_before_overlaps()

    def _pause_before_overlaps(self) -> None:
        """Stand still at a start at which bodies overlap: physics would push them apart."""
        if self.cell.simulator.overlaps_at_start and not self.cell.steps_done:
            self.is_playing = False

    def _pace(self, samples: int) -> bool:
        """Wait as long as samples last, showing them; False where the motion is to stop."""
        self.session.frame()
        while not self.is_playing and not self.stopping.is_set():
            time.sleep(FRAME)
            self.session.frame()
            self._due = time.monotonic()
        if self.speed > 0:
            now = time.monotonic()
            self._due = max(self._due, now - 0.1) + samples * self.cell.timestep / self.speed
            if self._due > now:
                time.sleep(self._due - now)
        return not self.stopping.is_set()

    def _frame(self, is_due: bool) -> None:
        now = time.monotonic()
        elapsed, self._last_tick = min(0.1, now - self._last_tick), now
        if self._cell is None:
            return
        physics_time = self._cell.simulator.physics_time
        self._lived += max(0.0, physics_time - self._physics_time)
        self._physics_time = physics_time
        if self.session.viewers:
            self.camera.draw(self._cell)
        for message in (self.verdicts.taken(), self.camera.taken()):
            if message is not None:
                self.session.broadcast(message)
        if not self.busy and self.is_playing and self.session.viewers:
            self._go_on(elapsed * (self.speed or 1.0))
        if self.session.viewers and now - self._last_scene >= 0.9 * FRAME:
            self._last_scene = now
            self._move()
        if is_due and self.session.viewers:
            self._frames += 1
            if self._frames % MEASURED_EVERY == 0 and not self.busy:
                self._measure_clearance()
            self.session.broadcast(self.state_message())

    def _move(self) -> None:
        """Show where everything is, and what is being dragged where it is dragged to."""
        cell, positions = self.cell, self.cell.joint_positions()
        more = {
            "live": round(self._lived, 3),
            "positions": [round(float(positions[i]), 5) for i in cell.simulator.physics.actuated],
            "tcp": cell.tcp_pose().as_vector().round(5).tolist(),
        }
        self.view.move(positions, {**cell.object_vectors(), **self.dragged}, more)

    def put_handle(self, pose: SE3 | None = None) -> None:
        """Put the handle on a goal of the TCP, or on the TCP itself."""
        description = self.cell.description
        is_whole = description.task_space(description.default_group).holds_pose
        at = self.cell.tcp_pose() if pose is None else pose
        self.view.put_handle(at.as_vector(), "all" if is_whole else "pitch")

    def _recover(self) -> None:
        """Stand still where the steps executed so far left the cell."""
        self.is_playing, self.target = False, None
        if self._cell is not None:
            self.cell.restore(self.cell.steps_done)

    def _measure_clearance(self) -> None:
        found = self.cell.nearest_pair()
        self.nearest = None if found is None else found[0]
        self.view.show_clearance(None if found is None else found[1])

    def _go_on(self, seconds: float) -> None:
        if self.target is not None:
            self.cell.jog(self.target, self.share, seconds)
            actuated = self.cell.simulator.physics.actuated
            left = np.abs(self.cell.simulator.set_points() - self.target[actuated])
            if left.max(initial=0.0) < 1e-9:
                self.target = None
        else:
            self.cell.idle(seconds)

    def _on_step(self, step: ProgramStep, record: StepRecord | None) -> None:
        if record is None:
            self.busy = step.summary
            self.session.frame()
            return
        if self.cell.document.step_count and not self.cell.is_by_hand:
            self.verdicts.begin(self.cell, is_last=False)
        if record.status == "failed":
            self.say("failed", f"{record.summary}: {record.error_code}: {record.message}")

    def working(self, what: str, action: Callable[[], None]) -> None:
        """Do something that takes simulated time, and judge where it leaves the scenario."""
        was_playing, self.is_playing = self.is_playing, True
        self.busy, self.target = what, None
        self.stopping.clear()
        self._due = time.monotonic()
        self.session.broadcast(self.state_message())
        try:
            action()
        finally:
            self.busy = ""
            self.is_playing &= was_playing
            self.study = None
            self._last_tick = time.monotonic()
        if self.cell.document.step_count and not self.cell.is_by_hand:
            self.verdicts.begin(self.cell, is_last=True)
        self.clear_preview()
        self.put_handle()

    # -- messages -----------------------------------------------------------------------------

    def do(self, name: str, message: Message) -> Message:
        """Carry out a request; its reply.

        Raises:
            HarnessError: It is refused.
        """
        if name not in self._actions:
            raise RefusedError(f"the studio has no action '{printable(name)}'")
        try:
            return self._actions[name](message)
        finally:
            if self._cell is not None:
                self.session.broadcast(self.state_message())

    def say(self, kind: str, text: str) -> None:
        self.session.broadcast({"type": "note", "kind": kind, "text": printable(text)})

    def _greeting(self) -> list[Message]:
        messages = [self.document_message()]
        if self._cell is not None:
            messages = [robot_message(self.cell), *self.view.greeting(), *messages]
            messages.append(self.state_message())
        if self.notice:
            messages.append({"type": "note", "kind": "warning", "text": self.notice})
        return [*messages, self.verdicts.message]

    def document_message(self) -> Message:
        return {
            "type": "document",
            "text": self.text,
            "file": self.files.name,
            "is_saved": self.text == self.saved,
            "problems": [problem_message(each, str(self.files.path)) for each in self.problems],
            "step_lines": [] if self._cell is None else self.cell.document.step_lines(),
            "scene": "none" if self._cell is None else "robot" if self.is_alone else "whole",
        }

    def state_message(self) -> Message:
        """The numbers of the page."""
        nearest = self.nearest
        return {
            **cell_message(self.cell),
            "live": round(self._lived, 3),  # it never goes back, whatever is restored
            "nearest": None
            if nearest is None
            else [nearest.first, nearest.second, round(nearest.distance, 5)],
            "busy": self.busy,
            "is_playing": self.is_playing,
            "speed": self.speed,
            "share": self.share,
            "is_recording": self.is_recording,
            "follows": self.follows,
        }

    def clear_preview(self) -> None:
        """Take ghosts and the path away, and forget the goal."""
        self.reach = self.chosen = None
        self.view.show_ghosts([])
        self.view.show_plan(None)
        self.session.broadcast(
            {"type": "reach", "pose": None, "refusal": "", "ways": [], "best": -1}
        )

    # -- at once ------------------------------------------------------------------------------

    def _stop(self, _: Message) -> Message:
        self.stopping.set()
        self.target = None
        return {}

    def _play(self, message: Message) -> Message:
        self.is_playing = bool(message["on"])
        return {}

    def _set_speed(self, message: Message) -> Message:
        speed = float(message["value"])
        if speed not in SPEEDS:
            raise RefusedError(f"the speed is one of {', '.join(map(str, SPEEDS))}")
        self.speed = speed
        return {}

    def _set_recording(self, message: Message) -> Message:
        self.is_recording = bool(message["on"])
        return {}

    # -- moving by hand -----------------------------------------------------------------------

    def do_jog(self, message: Message) -> Message:
        """Move one joint to a position, under its limits."""
        description = self.cell.description
        joint = description.joint_by_name[str(message["joint"])]
        value = float(message["value"])
        if not joint.lower <= value <= joint.upper:
            factor, unit = (1e3, " mm") if joint.kind == "prismatic" else (180 / np.pi, "°")
            low, high, given = (factor * each for each in (joint.lower, joint.upper, value))
            raise RefusedError(
                f"{joint.name} goes from {low:.1f} to {high:.1f}{unit}, not to {given:.1f}{unit}"
            )
        target = self.target
        if target is None:
            target = self.cell.simulator.commanded_positions()
        target = target.copy()
        target[description.joint_index[joint.name]] = value
        self.target = description.with_mimics(target)
        self.study = None
        if self.reach is not None:
            self.clear_preview()  # the goal is where the slider leads
        return {}

    def do_share(self, message: Message) -> Message:
        """Set the share of the velocity limits with which joints follow sliders."""
        self.share = float(np.clip(float(message["value"]), 0.01, 1.0))
        return {}

    def do_advance(self, message: Message) -> Message:
        """Let some simulated time pass."""
        self.cell.idle(float(np.clip(float(message["seconds"]), 0.001, 1.0)))
        return {}

    def do_reset(self, _: Message) -> Message:
        """Go back to the scenario's start."""
        self.target = None
        self.cell.reset()
        self.after_jump()
        return {}

    def after_jump(self) -> None:
        self._pause_before_overlaps()
        self.study = None
        self.forget_verdicts()
        self.clear_preview()
        self.put_handle()
