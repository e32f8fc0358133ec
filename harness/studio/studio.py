"""What the page's requests do with the cell."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import viser

from harness.core.errors import Problem, SpecError
from harness.core.printable import printable
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.recording.run import StepRecord
from harness.reporting.explanation import explanation_lines
from harness.studio.document import Document
from harness.studio.files import StudioFiles
from harness.studio.language_help import Names, complete, hover
from harness.studio.live_cell import Judged, LiveCell
from harness.studio.previews import Preview, preview
from harness.studio.proposals import holding, proposals
from harness.studio.reach import Reach, ReachStudy
from harness.studio.scene_view import GHOST, PLANNED, REFUSED, SceneView
from harness.studio.session import FRAME, Message, RefusedError, Session
from harness.studio.step_texts import MOTIONS, joint_keys, object_spec, pose_keys, step_text

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 0.0)
"""Simulated seconds in a second of wall time; 0 is as fast as possible."""

MEASURED_EVERY = 5
"""Updates of the page between two measurements of the smallest clearance."""


class Studio:
    """A cell, the scenario that grows from it, and the pages that show both."""

    def __init__(self, files: StudioFiles, text: str, notice: str = "") -> None:
        """Build the cell.

        Raises:
            SpecError: The text has mistakes.
        """
        self.files = files
        self.text = self.saved = text
        self.notice = notice
        self.problems: list[Problem] = []
        self.cell = LiveCell(files.path, text, self._on_step)
        self.cell.pace = self._pace
        self.session = Session(
            self._do,
            self._frame,
            self._greeting,
            {"stop": self._stop, "play": self._play, "speed": self._set_speed},
        )
        self.view: SceneView | None = None
        self._server: viser.ViserServer | None = None
        self.is_playing, self.speed, self.share = True, 1.0, 0.3
        self._stopping = threading.Event()
        self._busy = ""
        self._target: FloatArray | None = None
        self._drag: tuple[str, SE3] | None = None
        self._study: ReachStudy | None = None
        self._reach: Reach | None = None
        self._chosen: FloatArray | None = None
        self._preview: Preview | None = None
        self._judged: Judged | None = None
        self._last_tick = self._last_scene = time.monotonic()
        self._due, self._frames, self._nearest = 0.0, 0, None
        self._actions: dict[str, Callable[[Message], Message]] = {
            name.removeprefix("do_"): getattr(self, name)
            for name in dir(self)
            if name.startswith("do_")
        }

    @classmethod
    def opened(cls, files: StudioFiles, text: str, unsaved: str | None, notice: str) -> Studio:
        """A studio on a file's text, in which unsaved work is shown as changes.

        Raises:
            SpecError: The file's text has mistakes.
        """
        files.refuse_outside(Document(text))
        studio = cls(files, text, notice)
        if unsaved is not None:
            studio.do_edit({"text": unsaved})
        return studio

    # -- the server and the thread ------------------------------------------------------------

    def open(self, server: viser.ViserServer) -> None:
        """Show the cell in a server's scene, and begin."""
        self._server = server
        self.view = SceneView(server, self._on_drag)
        self._show_cell()
        self.session.start()

    def close(self) -> None:
        """End; unsaved work stays in its file."""
        self._stopping.set()
        self.session.stop()

    def _show_cell(self) -> None:
        if self.view is None:
            return
        cell = self.cell
        program = cell.prepared.program
        reach = _reach_of(cell)
        self.view.show_cell(program.description, cell.prepared.kinematics, cell.tcp_pose(), reach)
        self.view.show_objects(program.all_objects())
        self.view.move(cell.joint_positions(), cell.object_poses())
        self._study = self._reach = self._preview = self._chosen = self._target = None

    def _pace(self, samples: int) -> bool:
        """Wait as long as samples last, showing them; False where the motion is to stop."""
        self.session.frame()
        while not self.is_playing and not self._stopping.is_set():
            time.sleep(FRAME)
            self.session.frame()
            self._due = time.monotonic()
        if self.speed > 0:
            now = time.monotonic()
            self._due = max(self._due, now - 0.1) + samples * self.cell.timestep / self.speed
            if self._due > now:
                time.sleep(self._due - now)
        return not self._stopping.is_set()

    def _frame(self, is_due: bool) -> None:
        now = time.monotonic()
        elapsed, self._last_tick = min(0.1, now - self._last_tick), now
        if not self._busy and self.is_playing and self.session.viewers:
            self._go_on(elapsed * (self.speed or 1.0))
        if self.view is not None and now - self._last_scene >= 0.9 * FRAME:
            self._last_scene = now
            self.view.move(self.cell.joint_positions(), self.cell.object_poses())
        if is_due and self.session.viewers:
            self._frames += 1
            if self._frames % MEASURED_EVERY == 0 and not self._busy:
                self._nearest = self.cell.nearest_pair()
            self.session.broadcast(self._state())

    def _go_on(self, seconds: float) -> None:
        if self._target is not None:
            self.cell.jog(self._target, self.share, seconds)
            actuated = self.cell.simulator.physics.actuated
            left = np.abs(self.cell.simulator.set_points() - self._target[actuated])
            if left.max(initial=0.0) < 1e-9:
                self._target = None
        else:
            self.cell.idle(seconds)

    def _on_step(self, event: str, step: Any, record: StepRecord | None) -> None:
        if event == "step_started":
            self._busy = step.summary
            self.session.frame()
        elif record is not None and record.status == "failed":
            self._say("failed", f"{record.summary}: {record.error_code}: {record.message}")

    def _working(self, what: str, action: Callable[[], None]) -> None:
        """Do something that takes simulated time."""
        self._busy, self._target = what, None
        self._stopping.clear()
        self._due = time.monotonic()
        self.session.broadcast(self._state())
        try:
            action()
        finally:
            self._busy = ""
            self._study = None
            self._last_tick = time.monotonic()
        self._clear_preview()
        if self.view is not None:
            self.view.move_handle(self.cell.tcp_pose())

    # -- messages -----------------------------------------------------------------------------

    def _do(self, name: str, message: Message) -> Message:
        if name not in self._actions:
            raise RefusedError(f"the studio has no action '{printable(name)}'")
        try:
            return self._actions[name](message)
        finally:
            self.session.broadcast(self._state())

    def _say(self, kind: str, text: str) -> None:
        self.session.broadcast({"type": "note", "kind": kind, "text": printable(text)})

    def _greeting(self) -> list[Message]:
        messages = [self._robot(), self._document(), self._state()]
        if self.notice:
            messages.append({"type": "note", "kind": "warning", "text": self.notice})
        if self._judged is not None:
            messages.append(_verdicts(self._judged))
        return messages

    def _robot(self) -> Message:
        """What does not change while the cell is the same."""
        description = self.cell.description
        gripper = description.gripper
        actuated = set(self.cell.simulator.physics.actuated.tolist())
        return {
            "type": "robot",
            "name": description.name,
            "tcp": description.tcp_link,
            "arm_joints": list(description.groups[description.arm_group].joint_names)
            if description.arm_group
            else [],
            "joints": [
                {
                    "name": joint.name,
                    "lower": max(joint.lower, -2 * np.pi),
                    "upper": min(joint.upper, 2 * np.pi),
                    "slides": joint.kind == "prismatic",
                }
                for index, joint in enumerate(description.movable_joints)
                if index in actuated
            ],
            "states": list(description.states_of(description.arm_group)),
            "gripper": None
            if gripper is None
            else {
                "states": list(description.states_of(gripper.group)),
                "widest": float(gripper.widths[:, 1].max()),
            },
            "frames": ["world", description.base_link, *self.cell.cell.presence],
            "objects": self.cell.document.object_names(),
            "bodies": list(self.cell.cell.presence),
            "overlaps": [
                f"{touch.first} and {touch.second} overlap by {-1e3 * touch.distance:.1f} mm"
                for touch in self.cell.overlaps_at_start
            ],
            "verbs": list(MOTIONS),
            "cameras": list(self.cell.prepared.program.cameras),
        }

    def _document(self) -> Message:
        return {
            "type": "document",
            "text": self.text,
            "file": str(self.files.path.name),
            "is_saved": self.text == self.saved,
            "problems": [_problem(problem) for problem in self.problems],
            "step_lines": self.cell.document.step_lines(),
        }

    def _state(self) -> Message:
        cell = self.cell
        positions = cell.joint_positions()
        actuated = cell.simulator.physics.actuated
        pose = cell.tcp_pose()
        contacts = sorted(cell.simulator.contact_forces().items(), key=lambda item: -item[1])
        nearest = self._nearest
        return {
            "type": "state",
            "time": round(cell.simulator.physics_time, 3),
            "positions": [round(float(positions[index]), 5) for index in actuated],
            "tcp": [round(float(value), 5) for value in pose.as_vector()],
            "contacts": [[*pair, round(force, 2)] for pair, force in contacts[:8]],
            "nearest": None
            if nearest is None
            else [nearest.first, nearest.second, round(nearest.distance, 5)],
            "width": _width(cell),
            "busy": self._busy,
            "is_playing": self.is_playing,
            "speed": self.speed,
            "share": self.share,
            "steps_done": cell.steps_done,
            "step_count": cell.document.step_count,
            "is_run": cell.is_run,
        }

    # -- at once ------------------------------------------------------------------------------

    def _stop(self, _: Message) -> Message:
        self._stopping.set()
        self._target = None
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

    # -- moving by hand -----------------------------------------------------------------------

    def do_jog(self, message: Message) -> Message:
        """Move one joint to a position, under its limits."""
        description = self.cell.description
        joint = description.joint_by_name[str(message["joint"])]
        value = float(message["value"])
        if not joint.lower <= value <= joint.upper:
            unit = "m" if joint.kind == "prismatic" else "rad"
            raise RefusedError(
                f"{joint.name} goes from {joint.lower:.4g} to {joint.upper:.4g} {unit},"
                f" not to {value:.4g}"
            )
        target = self._target
        if target is None:
            target = self.cell.simulator.commanded_positions()
        target = target.copy()
        target[description.joint_index[joint.name]] = value
        self._target = description.with_mimics(target)
        self._study = None
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
        self._target = None
        self.cell.reset()
        self._after_jump()
        return {}

    def _after_jump(self) -> None:
        self._study = self._judged = None
        self._clear_preview()
        if self.view is not None:
            self.view.move_handle(self.cell.tcp_pose())

    # -- goals --------------------------------------------------------------------------------

    def _on_drag(self, client: int, phase: str, pose: SE3) -> None:
        """A page's handle was moved; called in the server's thread."""
        if not self._controls(client):
            if self.view is not None:
                self.view.move_handle(self.cell.tcp_pose())
            return
        is_waiting = self._drag is not None
        self._drag = (phase, pose)
        if not is_waiting or phase == "end":
            self.session.post(self._answer_drag)

    def _controls(self, client: int) -> bool:
        """Whether the page that shows a scene is the one that controls."""
        assert self._server is not None
        live = self._server._websock_server._live_connections  # noqa: SLF001 - viser names no page
        connection = next((each for key, each in live.items() if int(key) == client), None)
        path = "" if connection is None or connection.request is None else connection.request.path
        return path.rpartition("/")[2] == self.session.controller

    def _answer_drag(self) -> None:
        drag, self._drag = self._drag, None
        if drag is None or self._busy:
            return
        phase, pose = drag
        self.answer_pose(pose, explain=phase == "end")

    def answer_pose(self, pose: SE3, *, explain: bool = True) -> Reach:
        """Find the ways to a TCP pose, and show them as ghosts."""
        if self._study is None:
            self._study = ReachStudy(self.cell, self.cell.description.default_group)
        near = None if self._reach is None or self._reach.best is None else self._reach.best
        reach = self._study.answer(pose, None if near is None else near.positions, explain=explain)
        self._reach, self._chosen, self._preview, self._goal = reach, None, None, pose
        best = reach.best
        if self.view is not None:
            shown = [(way.positions, REFUSED if way.refusal else GHOST) for way in reach.ways[:3]]
            self.view.show_ghosts(shown)
            self.view.show_path(None)
        self.session.broadcast(
            {
                "type": "reach",
                "pose": [round(float(value), 5) for value in pose.as_vector()],
                "refusal": printable(reach.refusal),
                "ways": [
                    {"name": way.name or f"way {number}", "refusal": printable(way.refusal)}
                    for number, way in enumerate(reach.ways, 1)
                ],
                "best": -1 if best is None else reach.ways.index(best),
            }
        )
        return reach

    def do_goal(self, message: Message) -> Message:
        """Put the handle on a pose that is given by numbers, in a frame."""
        xyz = np.array([float(value) for value in message["xyz"]])
        turn = np.array([float(value) for value in message["rpy"]])
        if message.get("unit") == "deg":
            turn = np.radians(turn)
        if not (np.isfinite(xyz).all() and np.isfinite(turn).all()) or len(xyz) + len(turn) != 6:
            raise RefusedError("a goal has three coordinates and three angles")
        pose = self.cell.cell.frame(str(message.get("frame", "world"))) @ SE3.from_xyz_rpy(
            xyz, turn
        )
        if self.view is not None:
            self.view.move_handle(pose)
        reach = self.answer_pose(pose)
        return {"refusal": printable(reach.refusal), "ways": len(reach.ways)}

    def do_choose(self, message: Message) -> Message:
        """Choose one of the ways to the pose."""
        if self._reach is None:
            raise RefusedError("drag the handle first")
        way = self._reach.ways[int(message["way"])]
        self._chosen = way.positions
        if self.view is not None:
            self.view.show_ghosts([(way.positions, REFUSED if way.refusal else GHOST)])
        return {"refusal": printable(way.refusal)}

    # -- plans --------------------------------------------------------------------------------

    def do_plan(self, message: Message) -> Message:
        """Plan a motion without moving; its path and its end are shown as a ghost."""
        text = self._motion_text(message)
        found = preview(self.cell, text)
        if found.record is not None:
            return {"step": text, **_failure(found.record)}
        self._preview = found
        if self.view is not None and found.positions is not None:
            self.view.show_ghosts([(found.positions[-1], PLANNED)])
            self.view.show_path(found.tcp_path)
        return {
            "step": text,
            "duration": round(found.duration, 3),
            "length": round(found.length, 4),
            "planner": found.planner,
        }

    def do_execute(self, message: Message) -> Message:
        """Execute a step; recorded, it becomes the scenario's next one."""
        text = str(message.get("step") or self._motion_text(message))
        return self._execute(text, is_recorded=bool(message.get("record", True)))

    def _execute(self, text: str, *, is_recorded: bool) -> Message:
        results: list[StepRecord] = []

        def action() -> None:
            if not is_recorded:
                results.append(self.cell.execute(text))
                return
            self._refuse_mistakes()
            self.files.refuse_outside(self.cell.document.with_step(text, self.cell.steps_done))
            new_text, record = self.cell.record(text)
            results.append(record)
            self._take_text(new_text)

        self._working(text, action)
        record = results[0]
        if record.status == "failed":
            return {"step": text, **_failure(record)}
        return {"step": text, "status": record.status, "message": printable(record.message)}

    def _motion_text(self, message: Message) -> str:
        """The step that a page's goal is."""
        verb = str(message.get("verb", "move_to"))
        if verb not in MOTIONS:
            raise RefusedError(f"a motion is one of {', '.join(MOTIONS)}")
        description = self.cell.description
        group = description.default_group
        keys: Any
        if message.get("state"):
            keys = {"named_target": str(message["state"])}
        elif message.get("here"):
            keys = joint_keys(description, group, self.cell.cell.planning_start())
        elif self._chosen is not None:
            keys = joint_keys(description, group, self._chosen)
        elif self._reach is not None:
            frame = str(message.get("frame", "world"))
            pose = self.cell.cell.frame(frame).inverse() @ self._goal
            keys = pose_keys(description, group, pose, frame)
        else:
            raise RefusedError("there is no goal: drag the handle, or choose a named state")
        if verb == "circ":
            keys["interim"] = {"xyz": [round(float(value), 5) for value in message["interim"]]}
        if message.get("planner"):
            keys["planning"] = {"planner_id": str(message["planner"])}
            planning = keys.pop("planning")
            return f"{step_text(verb, keys)}\nplanning: {step_text('x', planning)[3:]}"
        if set(keys) == {"named_target"}:
            return step_text(verb, keys["named_target"])
        return step_text(verb, keys)

    def _clear_preview(self) -> None:
        self._preview = self._reach = self._chosen = None
        if self.view is not None:
            self.view.show_ghosts([])
            self.view.show_path(None)
        self.session.broadcast(
            {"type": "reach", "pose": None, "refusal": "", "ways": [], "best": -1}
        )

    # -- objects ------------------------------------------------------------------------------

    def do_add_object(self, message: Message) -> Message:
        """Put an object into the scenario; the cell begins again at its start."""
        size = [float(value) for value in message["size"]]
        xyz = [float(value) for value in message["xyz"]]
        spec = object_spec(str(message["name"]), str(message["kind"]), size, xyz)
        self._refuse_mistakes()
        self._change(self.cell.document.with_object(spec))
        overlaps = self._robot()["overlaps"]
        return {"note": "; ".join(overlaps)}

    def do_move_object(self, message: Message) -> Message:
        """Put an object elsewhere in the scenario, or in the live cell alone."""
        name, xyz = str(message["name"]), [float(value) for value in message["xyz"]]
        if message.get("live"):
            pose = self.cell.cell.frame(name)
            self.cell.move_object(name, SE3(pose.rotation, np.array(xyz)))
            return {}
        self._refuse_mistakes()
        if name not in self.cell.document.object_names():
            raise RefusedError(f"'{name}' belongs to the world, not to the scenario's `objects`")
        spec = self.cell.document.object_spec(name)
        given = spec.get("pose")
        spec["pose"] = {**(given if isinstance(given, dict) else {}), "xyz": xyz}
        self._change(self.cell.document.with_object(spec))
        return {}

    def do_delete_object(self, message: Message) -> Message:
        """Take an object out of the scenario."""
        self._refuse_mistakes()
        name = str(message["name"])
        if name not in self.cell.document.object_names():
            raise RefusedError(f"'{name}' belongs to the world, not to the scenario's `objects`")
        self._change(self.cell.document.without_object(name))
        return {}

    # -- the scenario -------------------------------------------------------------------------

    def do_edit(self, message: Message) -> Message:
        """Take the editor's text; its mistakes are returned with their places."""
        text = str(message["text"])
        self.text = text
        self.problems = []
        try:
            self.files.refuse_outside(Document(text))
            is_new = self.cell.load(text)
        except SpecError as error:
            self.problems = list(error.problems)
        else:
            if is_new:
                self._judged = None
                self._show_cell()
                self.session.broadcast(self._robot())
        if text != self.saved:
            self.files.keep_unsaved(text)
        return {"document": self._document()}

    def do_check(self, message: Message) -> Message:
        """The mistakes of the text as it is."""
        del message
        return {"document": self._document()}

    def do_complete(self, message: Message) -> Message:
        """What may be written at a place of the text."""
        line, column = int(message["line"]), int(message["column"])
        found = complete(str(message["text"]), line, column, self._names())
        return {"options": [{"text": o.text, "kind": o.kind, "help": o.help} for o in found]}

    def do_hover(self, message: Message) -> Message:
        """The description of the key at a place of the text."""
        text = str(message["text"])
        return {"text": hover(text, int(message["line"]), int(message["column"]))}

    def do_run(self, message: Message) -> Message:
        """Run to a line of the text, one step more, or from the start to the end."""
        self._refuse_mistakes()
        cell, until = self.cell, message.get("until", "end")
        count = cell.document.step_count
        if not count:
            raise RefusedError("the scenario has no steps yet")
        if until == "line":
            count = cell.document.step_at(int(message["line"])) + 1
        elif until == "next":
            if cell.steps_done >= count:
                raise RefusedError("every step was executed; go back, or reset")
            count = cell.steps_done + 1

        def action() -> None:
            if until == "end":
                cell.reset()
            if until == "next":
                cell.run_steps(count)
            else:
                cell.go_to(count)
            self._busy = "judging"
            self.session.broadcast(self._state())
            self._judged = cell.judged()

        self._working("running", action)
        assert self._judged is not None
        self.session.broadcast(_verdicts(self._judged))
        failed = next((r for r in cell.execution.records if r.status == "failed"), None)
        return {} if failed is None else _failure(failed)

    def do_back(self, _: Message) -> Message:
        """Undo motions by hand, or the last step."""
        self._target = None
        self.cell.step_back()
        self._after_jump()
        return {}

    def do_expect_seen(self, _: Message) -> Message:
        """Propose expectations of what is seen now, for the last step executed."""
        self._refuse_mistakes()
        if not self.cell.steps_done:
            raise RefusedError("execute a step first: an expectation is about a step")
        if self.cell.is_by_hand:
            raise RefusedError("the cell was moved by hand since the last step: record that first")
        found = holding(self.cell, proposals(self.cell))
        return {"proposals": [{"text": each.text, "why": each.why} for each in found]}

    def do_expect(self, message: Message) -> Message:
        """Put expectations at the last step executed."""
        self._refuse_mistakes()
        texts = [str(text) for text in message["texts"]]
        step = self.cell.steps_done - 1
        done = self.cell.steps_done
        self._take_text(self.cell.document.with_expectations(texts, step).text)
        if self.cell.steps_done != done:
            self._say("warning", "the step is executed again, because its text has changed")
        return {}

    def do_save(self, message: Message) -> Message:
        """Write the file; the digest is that of the last whole run of this text."""
        self._refuse_mistakes()
        path = self.files.save(str(message.get("name") or self.files.path.name), self.text)
        self.saved = self.text
        self.session.broadcast(self._document())
        judged = self._judged
        is_current = judged is not None and judged.digest and judged.run.source == self.text
        return {"file": path.name, "digest": judged.digest if judged and is_current else ""}

    def _refuse_mistakes(self) -> None:
        if self.problems or self.text != self.cell.document.text:
            raise RefusedError("the scenario has mistakes; mend the marked lines first")

    def _change(self, document: Document) -> None:
        self._take_text(document.text)

    def _take_text(self, text: str) -> None:
        """Make a text the scenario's, and show it on every page."""
        self.files.refuse_outside(Document(text))
        is_new = self.cell.load(text)
        self.text, self.problems = text, []
        self.files.keep_unsaved(text)
        if is_new:
            self._judged = None
            self._show_cell()
        self.session.broadcast(self._robot())
        self.session.broadcast(self._document())

    def _names(self) -> Names:
        from harness.language.reading.load import bundled_worlds
        from harness.robot.load import gripper_names, robot_names

        description = self.cell.description
        gripper = description.gripper
        return Names(
            states=list(description.states_of(description.arm_group)),
            gripper_states=[] if gripper is None else list(description.states_of(gripper.group)),
            joints=description.joint_names,
            links=description.link_names,
            objects=list(self.cell.cell.presence),
            groups=list(description.groups),
            worlds=bundled_worlds(),
            robots=robot_names(),
            grippers=gripper_names(),
        )


def _failure(record: StepRecord) -> Message:
    return {
        "status": "failed",
        "error": printable(f"{record.error_code}: {record.message}"),
        "explanation": [
            printable(line) for line in explanation_lines(record.explanation, record.message)
        ],
    }


def _verdicts(judged: Judged) -> Message:
    return {
        "type": "verdicts",
        "outcome": judged.outcome,
        "digest": judged.digest,
        "steps": [
            {"summary": printable(s.summary), "status": s.status, "line": s.line}
            for s in judged.run.steps
            if s.path.count("[") == 1 and "." not in s.path
        ],
        "verdicts": [
            {
                "text": printable(v.expectation),
                "status": v.status,
                "margin": None if v.margin is None or not np.isfinite(v.margin) else v.margin,
                "unit": v.unit,
                "line": v.line,
                "reason": printable(v.reason),
            }
            for v in judged.verdicts
        ],
    }


def _problem(problem: Problem) -> Message:
    return {
        "line": problem.line,
        "column": problem.column,
        "length": problem.length,
        "text": printable(problem.message),
        "hint": printable(problem.hint),
    }


def _width(cell: LiveCell) -> float | None:
    gripper = cell.description.gripper
    if gripper is None:
        return None
    value = cell.joint_positions()[cell.description.joint_index[gripper.joint]]
    rows = gripper.widths[np.argsort(gripper.widths[:, 0])]
    return round(float(np.interp(value, rows[:, 0], rows[:, 1])), 5)


def _reach_of(cell: LiveCell) -> float:
    """The length of the arm from its base to its TCP [m]: how far away the camera stands."""
    description = cell.description
    before = {joint.child: joint for joint in description.joints}
    length, link = 0.0, description.tcp_link
    while link in before and before[link].parent != "world":
        length += float(np.linalg.norm(before[link].pose.translation))
        link = before[link].parent
    return max(0.2, length)
