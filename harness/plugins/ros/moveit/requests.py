"""What MoveIt's clients request, kept until it is answered while simulated time stands still."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from harness.cell.cell import Cell
from harness.core.activity import unobserved
from harness.core.errors import HarnessError, StepFailed
from harness.plugins.ros.control.cell import PLANNED, ExternalCell
from harness.plugins.ros.endpoints import Reply
from harness.plugins.ros.moveit.client_scene import ClientScene
from harness.plugins.ros.moveit.planning import (
    Planned,
    display_trajectory,
    motion_text,
    plan_motion,
    unknown_planner,
    warm_up,
)
from harness.plugins.ros.moveit.scene_changes import Change, changes_of_attached
from harness.plugins.ros.moveit.sequence import plan_sequence
from harness.plugins.ros.moveit.values import error_code
from harness.recording.commands import CommandRecord
from harness.recording.explanation import Explanation
from harness.session.background import Background

T = TypeVar("T")
OnPlan = Callable[[Planned | None, Any, float], object]

Read = Callable[[Cell, Any], Iterable[Change]]
"""Reads from a message what it changes of the planning scene."""


@dataclass(frozen=True)
class _Work:
    """What another process computes, who takes it, and whether that still waits."""

    value: Background[Any]
    done: Callable[[Any], None]
    is_awaited: Callable[[], bool]


class Requests:
    """The requests that wait, the cell that they are about, and what is common to all.

    What takes long (plans, and motions) is done one after another. A process of its own plans, so
    that everything else is answered meanwhile, and a crash costs one request.

    Attributes:
        control: Records commands, and lets them take effect.
        note: Takes each command that a client gave.
        scene: The planning scene; None while the arm is not handed over.
        on_scene: Called with the planning scene as a message, after each change.
        on_plan: Called with each plan as a DisplayTrajectory, which RViz shows.
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
        self.on_plan: Callable[[Any], None] = lambda _: None
        self._waiting: deque[Callable[[], object]] = deque()
        self._turns: deque[Callable[[], object]] = deque()
        self._work: _Work | None = None
        self._is_warm = False
        self._noted: set[str] = set()

    @property
    def here(self) -> ClientScene:
        """The planning scene and its cell.

        Raises:
            StepFailed: The arm is not handed over.
        """
        if self.scene is None:
            raise StepFailed("FAILURE", "the arm is not handed over")
        return self.scene

    @property
    def has_waiting(self) -> bool:
        """Whether a request waits for `work`."""
        return bool(self._waiting)

    def put(self, work: Callable[[], object]) -> None:
        """Keep something that is done in `work`."""
        self._waiting.append(work)

    def service(self, answer: Callable[[Cell, Any], Any]) -> Callable[[Any, Reply], None]:
        """What takes a request of a service now and answers it in `work`."""
        return lambda request, reply: self.put(lambda: reply(answer(self.here.cell, request)))

    def in_turn(self, begin: Callable[[], object]) -> None:
        """Keep something that begins once what was computed before is known."""

        def take() -> None:
            self._turns.append(begin)
            self._begin_next()

        self.put(take)

    def compute(
        self,
        work: Callable[[], T],
        done: Callable[[T | StepFailed], None],
        is_awaited: Callable[[], bool] = lambda: True,
    ) -> None:
        """Let another process compute something; of what begins in its turn.

        A command's process has one thread (`prepare_process`), so that a fork inherits no lock that
        another thread holds; where a program of one's own has threads, a canceled goal ends a fork
        that waits for such a lock, too.

        Args:
            work: Returns what can be pickled; raises StepFailed. It changes nothing here.
            done: Takes the value or the failure.
            is_awaited: Whether somebody still waits for it; the process is ended otherwise.
        """
        if not self._is_warm:
            warm_up(self.here.cell)
            self._is_warm = True
        self._work = _Work(Background(lambda _: work(), despite_threads=True), done, is_awaited)

    def topic(self, read: Read) -> Callable[[Any], None]:
        """What takes a message of a topic that changes the planning scene."""
        return lambda content: self.put(lambda: self.change(read, content))

    def work(self) -> bool:
        """Answer what waits; whether something is still computed."""
        while self.scene is not None and (self._waiting or self._is_computed()):
            if self._waiting:
                self._waiting.popleft()()
            else:
                self._begin_next()
        return self._work is not None

    def _begin_next(self) -> None:
        while self._turns and self._work is None:
            self._turns.popleft()()

    def _is_computed(self) -> bool:
        """Whether what another process computes has become known, or is awaited no more."""
        work = self._work
        if work is None or (work.is_awaited() and not work.value.has_message()):
            return False
        self._work, result = None, None
        if work.is_awaited():
            try:
                result = work.value.result(unobserved)
            except StepFailed as failure:
                result = failure
            except HarnessError as failure:
                result = StepFailed("CRASH", str(failure))
            work.done(result)  # the client needs not wait for the process to end
        work.value.close()
        return True

    def forget(self) -> None:
        """Answer nothing of what waits."""
        self.scene = None
        self._waiting.clear()
        self._turns.clear()
        if self._work is not None:
            self._work.value.close()
            self._work = None

    def report(self, failure: StepFailed | str) -> None:
        """Say why a request failed."""
        self._say(f"t={self.control.time:.2f} s: {failure}")

    def note_once(self, text: str) -> None:
        """Say once in a session that something which is requested has no effect."""
        if text not in self._noted:
            self._noted.add(text)
            self.report(text)

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

    def plan(
        self,
        request: Any,
        done: OnPlan,
        *,
        diff: Iterable[Change] = (),
        is_awaited: Callable[[], bool] = lambda: True,
    ) -> None:
        """Plan what a MotionPlanRequest or a MotionSequenceRequest describes, in its turn.

        Args:
            done: Takes the plan, its error code, and the wall time that it took [s].
            diff: Changes of the planning scene that are of this plan alone.
            is_awaited: Whether somebody still waits for it.
        """
        begin, scene = time.monotonic(), self.here
        items = getattr(request, "items", None)
        motions = [request] if items is None else [each.req for each in items]
        for note in filter(None, map(unknown_planner, motions)):
            self.report(f"{note}; the default plans instead, as with MoveIt")

        held = motions[0].start_state.attached_collision_objects if motions else ()

        def work() -> Planned:
            scene.apply([*diff])
            for each in held:
                if scene.cell.scene.attached().get(str(each.object.id)) != str(each.link_name):
                    scene.apply([*changes_of_attached(scene.cell, each)])
            plan = plan_motion if items is None else plan_sequence
            return plan(scene.cell, request)

        def end(result: Planned | StepFailed) -> None:
            failure = result if isinstance(result, StepFailed) else None
            planned = None if isinstance(result, StepFailed) else result
            self._record(motions, failure)
            if planned is not None:
                self.on_plan(display_trajectory(scene.cell, planned))
            done(planned, error_code(failure), time.monotonic() - begin)

        self.compute(work, end, is_awaited)

    def _record(self, motions: Sequence[Any], failure: StepFailed | None) -> None:
        """Record a request to plan with what became of it."""
        answer = PLANNED
        if failure is not None:
            explanation = failure.details.find(Explanation)
            advice = f"; advice: {explanation.advice}" if explanation and explanation.advice else ""
            answer = f"{failure}{advice}"
            self.report(answer)
        group = str(motions[0].group_name) or self.here.cell.description.default_group
        motion = motion_text(motions[0]) if len(motions) == 1 else f": {len(motions)} motions"
        self.control.receive("plan", group=group, motion=motion, answer=answer)
