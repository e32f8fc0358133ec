"""Carries out steps of different arms at once: their motions in rounds, each merged in time."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace

from harness.cell.cell import Cell
from harness.cell.program import ProgramStep
from harness.cell.runner import End, Failure, RunEndedError
from harness.cell.scene_state import StepNotes
from harness.cell.watched_goals import watched_goals
from harness.core.errors import StepFailed
from harness.plugins.assembly.merged_motion import MergedMotion
from harness.recording.goal_failures import CollisionFailure, TouchRecord
from harness.recording.step_record import StepRecord


@dataclass
class _Branch:
    """What one arm does: a motion, or a step that is made of parts.

    Attributes:
        end: Completes the record of a step that is made of parts.
        parts: Its parts that are still to come.
        notes: What such a step leaves in its record.
        part: What is carried out next; None before it is known.
        after: The part after that, where it is known.
        has_begun: Whether a part was carried out.
        is_over: Whether all of it is done.
        begin: When its first motion begins [s].
        refused: Why its next part could not begin, and the records of the attempt.
    """

    step: ProgramStep
    end: End | None = None
    parts: Generator[ProgramStep] | None = None
    notes: StepNotes = field(default_factory=StepNotes)
    part: ProgramStep | None = None
    after: ProgramStep | None = None
    has_begun: bool = False
    is_over: bool = False
    begin: float | None = None
    refused: tuple[Failure, Sequence[StepRecord]] | None = None

    def done(self) -> None:
        """Go on after a part."""
        self.part, self.has_begun, self.is_over = None, True, self.parts is None


class AtOnce:
    """Carries out steps of different arms at once.

    In each round every arm does its next part. The motions of a round are planned one after the
    other, each around the ends of those before it, and begin as soon as all of them are free; a
    motion that is not possible waits for the next round, as long as another arm goes on. Parts
    that move no arm, such as `grasp`, follow the motions of their round.
    """

    def __init__(self, cell: Cell, steps: Sequence[ProgramStep]) -> None:
        self._runner, self._cell = cell.runner, cell
        self._around = self._cell.step, self._cell.notes
        self._begin = self._cell.simulator.time
        self._branches = [self._branch(step) for step in steps]

    def run(self) -> tuple[float, ...]:
        """Carry them out; returns when the first motion of each begins [s].

        Raises:
            RunEndedError: A part failed, or none can go on.
            StepFailed: The motions of none can be merged, or the arms cannot follow them.
        """
        try:
            while active := [each for each in self._branches if not each.is_over]:
                self._round(active)
        except (StepFailed, RunEndedError) as failure:
            own = failure.failure if isinstance(failure, RunEndedError) else failure
            for branch in self._branches:
                if branch.parts is not None and not branch.is_over:
                    self._end(branch, StepFailed("PREEMPTED", f"a step at once with it: {own}"))
            raise
        finally:
            for branch in self._branches:
                if branch.parts is not None:
                    branch.parts.close()
            self._cell.step, self._cell.notes = self._around
        return tuple((each.begin or self._begin) - self._begin for each in self._branches)

    def _branch(self, step: ProgramStep) -> _Branch:
        if not step.spec.is_made_of_parts:
            return _Branch(step, part=step)
        return _Branch(step, self._runner.begin(step), step.spec.parts(self._cell))

    def _round(self, active: Sequence[_Branch]) -> None:
        for branch in active:
            self._choose(branch)
        ready = [branch for branch in active if branch.part is not None]
        movers = [each for each in ready if each.part and each.part.spec.moves_arm]
        has_moved = self._move(movers)
        others = [branch for branch in ready if branch not in movers]
        for branch in others:
            self._act(branch)
        if not (has_moved or others or any(branch.is_over for branch in active)):
            self._refuse(active[0])

    def _choose(self, branch: _Branch) -> None:
        """Make the next part of a step; one that cannot begin may be possible later."""
        branch.refused, cell = None, self._cell
        if branch.part is not None or branch.parts is None:
            return
        cell.step, cell.notes = branch.step, branch.notes
        try:
            branch.part = branch.after or next(branch.parts, None)
            branch.after = next(branch.parts, None)
        except StepFailed as failure:
            self._wait(branch, failure, ())
            return
        if branch.part is None:
            self._end(branch, None)

    def _wait(self, branch: _Branch, failure: Failure, records: Sequence[StepRecord]) -> None:
        """Try a part in the next round; a step of which nothing is done yet is planned anew."""
        branch.refused = failure, records
        if branch.parts is not None and not branch.has_begun:
            branch.parts.close()
            branch.parts, branch.notes = branch.step.spec.parts(self._cell), StepNotes()
            branch.part = branch.after = None

    def _end(self, branch: _Branch, failure: Failure | None) -> None:
        self._cell.step, self._cell.notes, branch.is_over = branch.step, branch.notes, True
        if branch.end is not None and failure is None:
            branch.end(None)
        elif branch.end is not None:
            with suppress(RunEndedError):  # the caller raises it
                branch.end(failure)

    def _act(self, branch: _Branch) -> None:
        """Carry out a part that moves no arm."""
        assert branch.part is not None
        try:
            self._runner.run([branch.part])
        except RunEndedError as failure:
            self._end(branch, failure)
            raise
        branch.done()

    def _move(self, branches: Sequence[_Branch]) -> bool:
        """Carry out the motions of a round that are possible; whether there is one."""
        cell, records = self._cell, self._runner.records
        merged, begun = MergedMotion(cell), list[tuple[_Branch, int]]()
        cell.waiting = []
        try:
            for branch in branches:
                first, count = len(records), len(cell.waiting)
                try:
                    self._plan(branch, merged)
                except (StepFailed, RunEndedError) as failure:
                    self._wait(branch, failure, records[first:])
                    del records[first:], cell.waiting[count:]
                else:
                    begun.append((branch, first))
        finally:
            cell.waiting = None
        if begun:
            cell.step, cell.notes = self._around
            start = cell.simulator.time
            with watched_goals([each.part for each, _ in begun if each.part], cell):
                merged.follow()
            ends = {"end_time": cell.simulator.time, "end_index": cell.simulator.sample_count}
            for (branch, place), delay in zip(begun, merged.delays, strict=True):
                records[place] = replace(records[place], **ends)
                branch.begin = start + delay if branch.begin is None else branch.begin
                branch.done()
        return bool(begun)

    def _plan(self, branch: _Branch, merged: MergedMotion) -> None:
        """Plan a motion and merge it with those before it; it is announced once that is done."""
        runner, cell = self._runner, self._cell
        events: list[tuple[ProgramStep, StepRecord | None]] = []

        def keep(step: ProgramStep, record: StepRecord | None) -> None:
            events.append((step, record))

        on_step, runner.on_step = runner.on_step, keep
        try:
            assert branch.part is not None
            assert cell.waiting is not None
            runner.run([branch.part])
            self._refuse_closed_in()
            cell.step, cell.notes = self._around
            merged.add(cell.waiting[-1])
        finally:
            runner.on_step = on_step
        for event in events:
            on_step(*event)

    def _refuse_closed_in(self) -> None:
        """Refuse the end of a motion where hands that move next would meet something.

        Raises:
            StepFailed: GOAL_IN_COLLISION, with the pair.
        """
        cell, robot = self._cell, self._cell.robot
        opened, fingers = cell.planning_start(), set[str]()
        for branch in self._branches:
            hand = robot.of_arm[branch.step.arm].gripper
            next_parts = [part.spec for part in (branch.part, branch.after) if part is not None]
            if hand is not None and any(part.moves_gripper for part in next_parts):
                opened[robot.joint_index[hand.joint]] = hand.open_position
                fingers.update(hand.links)
        near = cell.scene.touches(robot.with_mimics(opened))
        touches = [touch for touch in near if not fingers.isdisjoint((touch.first, touch.second))]
        if touches:
            one = touches[0]
            raise StepFailed(
                "GOAL_IN_COLLISION",
                f"an opened gripper has no room at the end of this motion: {one.first} reaches"
                f" {-1e3 * one.distance:.1f} mm into {one.second}",
                CollisionFailure(
                    tuple(TouchRecord((t.first, t.second), t.distance) for t in touches)
                ),
            )

    def _refuse(self, branch: _Branch) -> None:
        """End the steps, because a part cannot begin and no arm goes on.

        Raises:
            RunEndedError: The part failed by itself.
            StepFailed: It cannot begin with the others.
        """
        assert branch.refused is not None
        failure, records = branch.refused
        own, now = failure.failure if isinstance(failure, RunEndedError) else failure, ""
        if (since := self._cell.simulator.time - self._begin) > 0:
            time = f"t={self._begin + since:.3f} s, {since:.3f} s into the motions"
            now = f"; at {time}, all others rest"
        own.message += now
        if isinstance(failure, RunEndedError):
            self._runner.records += [replace(each, message=each.message + now) for each in records]
        elif branch.parts is not None:
            self._end(branch, failure)
            raise RunEndedError(failure, branch.step.summary)
        self._end(branch, failure)
        raise failure
