"""What MoveIt's clients request, kept until it is answered between two ticks."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable
from typing import Any

from harness.cell.cell import Cell
from harness.core.errors import StepFailed
from harness.plugins.ros.control.cell import ExternalCell
from harness.plugins.ros.endpoints import Reply
from harness.plugins.ros.moveit.client_scene import ClientScene
from harness.plugins.ros.moveit.planning import Planned, plan_motion, unknown_planner
from harness.plugins.ros.moveit.scene_changes import Change
from harness.plugins.ros.moveit.values import error_code
from harness.recording.commands import CommandRecord

Read = Callable[[Cell, Any], Iterable[Change]]
"""Reads from a message what it changes of the planning scene."""


class Requests:
    """The requests that wait, the cell that they are about, and what is common to all.

    Attributes:
        control: Records commands, and lets them take effect.
        note: Takes each command that a client gave.
        scene: The planning scene; None while the arm is not handed over.
        on_scene: Called with the planning scene as a message, after each change.
    """

    def __init__(
        self,
        control: ExternalCell,
        note: Callable[[CommandRecord], None],
        say: Callable[[str], None],
    ) -> None:
        """Keep requests from now on.

        Args:
            control: Records commands, and lets them take effect.
            note: Takes each command that a client gave.
            say: Takes sentences for the user: requests that failed, and why.
        """
        self.control, self.note, self._say = control, note, say
        self.scene: ClientScene | None = None
        self.on_scene: Callable[[Any], None] = lambda _: None
        self._waiting: deque[Callable[[], object]] = deque()

    @property
    def here(self) -> ClientScene:
        """The planning scene and its cell.

        Raises:
            StepFailed: The arm is not handed over.
        """
        if self.scene is None:
            raise StepFailed("FAILURE", "the arm is not handed over")
        return self.scene

    def put(self, work: Callable[[], object]) -> None:
        """Keep something that is done in `work`."""
        self._waiting.append(work)

    def service(self, answer: Callable[[Cell, Any], Any]) -> Callable[[Any, Reply], None]:
        """What takes a request of a service now and answers it in `work`."""
        return lambda request, reply: self.put(lambda: reply(answer(self.here.cell, request)))

    def topic(self, read: Read) -> Callable[[Any], None]:
        """What takes a message of a topic that changes the planning scene."""
        return lambda content: self.put(lambda: self.change(read, content))

    def work(self) -> float:
        """Answer what waits; the wall time that it took [s]."""
        begin = time.monotonic()
        while self._waiting and self.scene is not None:
            self._waiting.popleft()()
        return time.monotonic() - begin

    def forget(self) -> None:
        """Answer nothing of what waits."""
        self.scene = None
        self._waiting.clear()

    def report(self, failure: StepFailed | str) -> None:
        """Say why a request failed."""
        self._say(f"t={self.control.time:.2f} s: {failure}")

    def change(self, read: Read, content: Any) -> bool:
        """Change the planning scene as a message says; whether it could be done."""
        try:
            changes = [*read(self.here.cell, content)]
        except StepFailed as failure:
            self.report(f"planning scene: {failure}")
            return False
        if not changes:
            return True
        record = self.control.receive("scene", changes=changes)
        self.note(record)
        self.on_scene(self.here.as_message())
        return record.answer == "accepted"

    def plan(self, request: Any) -> tuple[Planned | None, Any, float]:
        """The plan of a MotionPlanRequest, its error code, and the wall time that it took [s]."""
        begin, cell = time.monotonic(), self.here.cell
        if note := unknown_planner(request):
            self.report(f"{note}; the default plans instead, as with MoveIt")
        try:
            planned, failure = plan_motion(cell, request), None
        except StepFailed as error:
            planned, failure = None, error
            self.report(failure)
        goal = str(request.group_name) or cell.description.default_group
        answer = "planned" if failure is None else str(failure)
        self.control.receive("plan", goal="", group=goal, answer=answer)
        return planned, error_code(failure), time.monotonic() - begin
