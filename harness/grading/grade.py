"""Grade a recording of another program by a scenario's expectations."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from harness.assertions.judge import judge
from harness.grading.bag.content import BagTopics
from harness.grading.bag.recorded_run import Recorded, run_of_bag
from harness.recording.run import Run, Verdict
from harness.session.prepare import Prepared, prepare
from harness.session.record import robot_record


@dataclass(frozen=True)
class Graded:
    """An expectation's verdict, and what it is worth.

    Attributes:
        points: The points that can be earned; 0 where only other rows have points.
        earned: The points that were earned.
    """

    verdict: Verdict
    points: float
    earned: float


@dataclass(frozen=True)
class Grade:
    """The grade of a recording.

    Attributes:
        run: The recording, as far as it goes.
        rows: One an expectation, in file order.
        notes: What a person should know of the recording.
    """

    run: Run
    rows: tuple[Graded, ...]
    notes: tuple[str, ...]

    @property
    def points(self) -> float:
        """That can be had."""
        return sum(row.points for row in self.rows)

    @property
    def earned(self) -> float:
        """Of them."""
        return sum(row.earned for row in self.rows)

    @property
    def open(self) -> float:
        """Points of what this recording cannot show: neither earned nor lost."""
        return sum(row.points for row in self.rows if row.verdict.status == "not observable")


def grade_bag(
    scenario: Path,
    bag: Path,
    topics: BagTopics | None = None,
    overrides: Mapping[str, str] | None = None,
) -> Grade:
    """Judge a recording by the expectations of a scenario; nothing is planned or simulated.

    Args:
        scenario: The scenario file: it says which robot, world and objects were recorded.
        bag: A rosbag2 folder, an .mcap or a .db3 file.
        topics: Where joints and objects are in it.
        overrides: Dotted path in the file -> new value, as YAML text.

    Raises:
        SpecError: The scenario or the recording cannot be used.
    """
    prepared = prepare(scenario, overrides)
    program = prepared.program
    known = Recorded(
        robot=robot_record(program.description, prepared.kinematics),
        description=program.description,
        objects=program.all_objects(),
        at_start=frozenset(obj.name for obj in program.world.objects),
        frames=prepared.observed_links,
        steps=_steps(prepared),
        title=program.title,
        gravity=program.world.gravity,
    )
    run = run_of_bag(bag, topics or BagTopics(), known)
    if prepared.observations.reads_distances:
        run = _with_distances(prepared, run)
    verdicts = [_honest(verdict) for verdict in judge(run, prepared.expectations)]
    notes = tuple(finding.message for finding in run.findings)
    return Grade(run, graded(verdicts), notes)


def graded(verdicts: Sequence[Verdict]) -> tuple[Graded, ...]:
    """What each is worth: its `points`; one each where no expectation has any."""
    has_points = any(verdict.points is not None for verdict in verdicts)
    worth = [(verdict.points or 0.0) if has_points else 1.0 for verdict in verdicts]
    return tuple(
        Graded(verdict, points, points if verdict.status == "passed" else 0.0)
        for verdict, points in zip(verdicts, worth, strict=True)
    )


def _honest(verdict: Verdict) -> Verdict:
    """A failure for a missing number alone is not an observation; a simulated run fails."""
    if verdict.status != "failed" or math.isfinite(verdict.margin):
        return verdict
    reason = f"{verdict.reason}: the recording has a gap there"
    return replace(verdict, status="not observable", reason=reason)


def _steps(prepared: Prepared) -> dict[str, tuple[int, str]]:
    known: dict[str, tuple[int, str]] = {}
    for step in prepared.program.all_steps():
        known[step.id] = known[step.path] = (step.line, step.summary)
    return known


def _with_distances(prepared: Prepared, run: Run) -> Run:
    """With distances from joints and poses, where all joints are known."""
    if np.isnan(run.signals.joint_positions).any():
        return run
    from harness.observation.clearance import CoalClearance

    there = [obj for obj in run.objects if obj.pose or obj.name in run.signals.object_poses]
    observer = CoalClearance(prepared.program.description)
    cutoff = prepared.observations.recorded_cutoff
    signals = observer.observe(run.signals, there, (), cutoff)
    missing = tuple(name for name in run.unrecorded if name != "clearances")
    return replace(run, signals=signals, unrecorded=missing)
