"""The studio: what a page's requests do with the scenario."""

from __future__ import annotations

import gc
from collections.abc import Sequence

import numpy as np

from harness.core.printable import printable
from harness.core.spatial import SE3
from harness.language.step import STEPS
from harness.plugins.studio.document import Document
from harness.plugins.studio.files import StudioFiles
from harness.plugins.studio.goal_actions import GoalActions
from harness.plugins.studio.language_help import complete, hover
from harness.plugins.studio.live_cell import LiveCell
from harness.plugins.studio.messages import failure_message, names_of, resizable, robot_message
from harness.plugins.studio.proposals import proposals
from harness.plugins.studio.session import Message, RefusedError
from harness.plugins.studio.texts import object_spec, of_arm, pose_keys_of, step_text
from harness.recording.step_record import StepRecord
from harness.session.prepare import prepare


def of_selected_arm(cell: LiveCell, text: str) -> str:
    """A step on one line with the arm that it moves, of a robot with several."""
    step = STEPS.get(text.partition(":")[0].strip())
    is_moved = step is not None and (step.moves_arm or step.moves_gripper)
    return of_arm(cell.description, text) if is_moved and "\n" not in text else text


class Studio(GoalActions):
    """A cell, the scenario that grows from it, and the pages that show both."""

    @classmethod
    def opened(cls, files: StudioFiles, text: str, unsaved: str | None, notice: str) -> Studio:
        """A studio on a file's text, in which unsaved work is shown as changes."""
        studio = cls(files, text, notice)
        if unsaved is not None:
            studio.take_text(unsaved)
        return studio

    # -- the picture and its handles ----------------------------------------------------------

    def open(self) -> None:
        """Begin: pages that come see the cell."""
        self.show_cell()
        gc.collect()
        gc.freeze()  # what is loaded stays; to walk through it would take 60 ms every few edits
        self.session.start()

    def do_drag(self, message: Message) -> Message:
        """Answer a handle that was dragged: of the TCP's goal, an object, or an object's size."""
        vector = [float(value) for value in message["pose"]]
        if len(vector) != 7 or not np.isfinite(vector).all() or not any(vector[3:]):
            raise RefusedError("a pose has seven finite numbers")
        pose, is_end = SE3.from_xyz_quat(vector[:3], vector[3:]), bool(message["end"])
        kind = message["kind"]
        if kind == "tcp":
            self.answer_pose(pose, explain=is_end)
            return {}
        name = str(message["name"])
        if not is_end:
            self.dragged = {name: pose.as_vector()}
            return {}
        self.dragged = {}
        if kind == "object":
            self.put_object(name, pose)
        else:
            self.resize_object(name, [float(value) for value in message["half"]])
        return {}

    # -- steps --------------------------------------------------------------------------------

    def do_execute(self, message: Message) -> Message:
        """Execute a step; recorded, it becomes the scenario's next one."""
        is_goal = not message.get("step")
        given = str(message.get("step", ""))
        text = self.motion_text(message) if is_goal else of_selected_arm(self.cell, given)
        count = self.cell.document.step_count
        is_recorded = bool(message.get("record", self.is_recording))
        results: list[StepRecord] = []

        def action() -> None:
            if not is_recorded:
                results.append(self.cell.execute(text))
                return
            self._refuse_mistakes()
            new_text, record = self.cell.record(
                text, if_moved=bool(message.get("if_moved")) or is_goal
            )
            results.append(record)
            self._take_text(new_text)

        self.working(text, action)
        record = results[0]
        if record.status == "failed":
            return {"step": text, **failure_message(record)}
        reply = {"step": text, "status": record.status, "message": printable(record.message)}
        if is_recorded and self.cell.document.step_count == count:
            reply["note"] = "nothing has moved since the last step, so no step was recorded"
        return reply

    def do_arm(self, message: Message) -> Message:
        """Choose the arm that is moved by hand, of a robot with several."""
        name = str(message["name"])
        arms = list(self.cell.prepared.program.description.of_arm)
        if name not in arms:
            raise RefusedError(f"the arms are {', '.join(arms)}" if arms else "there is one arm")
        self.cell.chosen_arm = name
        self.study = self.target = None
        self.clear_preview()
        self.session.broadcast(robot_message(self.cell))
        self.put_handle()
        return {}

    # -- objects ------------------------------------------------------------------------------

    def do_add_object(self, message: Message) -> Message:
        """Put an object into the scenario, or in the place of one; the cell begins again."""
        size = [float(value) for value in message["size"]]
        xyz = [float(value) for value in message["xyz"]]
        self._refuse_mistakes()
        spec = object_spec(str(message["name"]), str(message["kind"]), size, xyz)
        self._take_text(self.cell.document.with_object(spec).text)
        return {}

    def do_delete_object(self, message: Message) -> Message:
        """Take an object out of the scenario."""
        name = str(message["name"])
        self._refuse_mistakes()
        if name not in self.cell.document.object_names():
            raise RefusedError(f"'{name}' belongs to the world, not to the scenario's `objects`")
        self._take_text(self.cell.document.without_object(name).text)
        return {}

    def do_world(self, message: Message) -> Message:
        """Load a world: a bundled name, or a file."""
        self._refuse_mistakes()
        self._take_text(self.cell.document.with_world(str(message["name"])).text)
        return {}

    def put_object(self, name: str, pose: SE3) -> None:
        """Move an object: at the start in the scenario's `objects`, later with a step."""
        document, place = self.cell.document, pose_keys_of(pose)
        if not self.cell.steps_done and name in document.object_names() and not self.problems:
            self._take_text(
                document.with_object({**document.object_spec(name), "pose": place}).text
            )
            return
        step = step_text("move_object", {"object": name, "pose": place})
        reply = self.do_execute({"step": step})
        if "error" in reply:
            raise RefusedError(reply["error"])

    def resize_object(self, name: str, half: Sequence[float]) -> None:
        """Move one face of an object of the scenario, before the first step.

        Args:
            name: The name of the object.
            half: Half its new sizes along its axes [m], shape (3,); what it does not have is 0.
        """
        form, pose = resizable(self.cell).get(name), self.cell.object_poses().get(name)
        if form is None or pose is None or self.problems:
            raise RefusedError(
                f"'{name}' keeps its size: it is no simple shape, or steps have begun"
            )
        spec = self.cell.document.object_spec(name)
        self._take_text(self.cell.document.with_object(form.resized(spec, pose, half)).text)

    def do_camera(self, message: Message) -> Message:
        """Show what a camera of the scenario sees, until another is chosen, or none."""
        name = str(message["name"])
        if name and name not in self.cell.prepared.program.cameras:
            raise RefusedError(f"there is no camera '{printable(name)}'")
        self.camera.look(name)
        return {}

    # -- the scenario -------------------------------------------------------------------------

    def do_edit(self, message: Message) -> Message:
        """Take the editor's text; its mistakes are returned with their places."""
        text = str(message["text"])
        if self.take_text(text):
            self.show_cell()
            self.session.broadcast(robot_message(self.cell))
        if text != self.saved:
            self.keep_unsaved(text)
        document = self.document_message()
        self.session.broadcast(document, but=self.session.controller)
        return {"document": document}

    def do_complete(self, message: Message) -> Message:
        """What may be written at a place of the text."""
        line, column = int(message["line"]), int(message["column"])
        found = complete(str(message["text"]), line, column, names_of(self._cell))
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

        if until != "next":
            self.forget_verdicts()
        self.working("running", action)
        failed = next((r for r in cell.execution.records if r.status == "failed"), None)
        return {} if failed is None else failure_message(failed)

    def do_back(self, _: Message) -> Message:
        """Undo motions by hand, or the last step."""
        self.target = None
        self.cell.step_back()
        self.after_jump()
        return {}

    def do_undo(self, _: Message) -> Message:
        """Undo the last step, and take it out of the text."""
        self._refuse_mistakes()
        index = self.cell.steps_done - 1
        if index < 0:
            raise RefusedError("no step was executed")
        self.target = None
        self.cell.restore(index)
        self._take_text(self.cell.document.without_step(index).text)
        self.after_jump()
        return {}

    def do_expect_seen(self, _: Message) -> Message:
        """Propose expectations of what is seen now, for the last step executed."""
        self._refuse_mistakes()
        if not self.cell.steps_done:
            raise RefusedError("execute a step first: an expectation is about a step")
        if self.cell.is_by_hand:
            raise RefusedError("the cell was moved by hand since the last step: record that first")
        found = proposals(self.cell)
        return {"proposals": [{"text": each.text, "why": each.why} for each in found]}

    def do_expect(self, message: Message) -> Message:
        """Put expectations at the last step executed."""
        self._refuse_mistakes()
        texts = [str(text) for text in message["texts"]]
        count = self.cell.steps_done
        self._take_text(self.cell.document.with_expectations(texts, count - 1).text)
        if self.cell.steps_done < count:  # what they observe needs another record from the start
            self.working("repeating the steps", lambda: self.cell.repeat(count))
        self.verdicts.begin(self.cell, is_last=True)
        return {}

    def do_save(self, message: Message) -> Message:
        """Write the file; the digest is that of the last whole run of this text."""
        judged = self.verdicts.taken(wait=True)
        if judged is not None:
            self.session.broadcast(judged)
        self._refuse_mistakes()
        path = self.files.named(str(message.get("name") or self.files.name))
        if path.parent.resolve() != self.files.path.parent.resolve():
            prepare(path, text=self.text)  # relative paths begin in another folder
        self.files.save(path, self.text)
        self.saved = self.text
        self.session.broadcast(self.document_message())
        return {"file": self.files.name, "digest": self.verdicts.message["digest"]}

    def _refuse_mistakes(self) -> None:
        if self.problems or self.text != self.cell.document.text:
            raise RefusedError("the scenario has mistakes; correct the marked lines first")

    def _take_text(self, text: str) -> None:
        """Make a text the scenario's, and show it on every page."""
        is_new = self.cell.load(Document(text, str(self.files.path)))
        self._set_text(text)
        self.keep_unsaved(text)
        if is_new:
            self.show_cell()
        self.session.broadcast(robot_message(self.cell))
        self.session.broadcast(self.document_message())
