"""Whether an expectation that ends a step holds at the present moment of a run."""

from __future__ import annotations

import math

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.judging.expectation import Expectation
from harness.judging.judge import judge
from harness.judging.placed import PlacedExpectation, as_expectation, check_expectation
from harness.language.expectation import ExpectationFields
from harness.ports.simulation import RecordingSimulator
from harness.recording.run import ObjectRecord, Run
from harness.recording.step_record import StepRecord


def check_end(until: ExpectationFields, at: At) -> None:
    """Report what is wrong with the expectation under a step's `until`."""
    expectation = as_expectation(until)
    check_expectation(expectation, at.key("until"), at.scope)
    seen = expectation.observations()
    if seen.reads_distances or seen.planned_clearances or seen.pictures:
        at.scope.problems.add(
            at.key("until"),
            "distances and pictures are measured after the run, so they cannot end a step",
            "expect it under `expect`, and end the step by joints, poses, contacts or objects",
            needs=(),
        )


def holds_now(
    until: ExpectationFields, cell: Cell, simulator: RecordingSimulator, *, since: tuple[float, int]
) -> bool:
    """Whether an expectation passes that ends the current step.

    Args:
        until: The expectation that may end the step.
        cell: The cell in which the step runs.
        simulator: The simulator of the cell, whose record is read.
        since: Time [s] and sample at which the step began.
    """
    current, (begin, first) = cell.current, since
    placed = PlacedExpectation.of(until, current.id, current.line)
    skipped = _not_read(placed.spec, first, simulator.timestep)
    times = begin, simulator.time, first - skipped, simulator.sample_count - skipped
    step = StepRecord(current.id, current.path, "", "", current.line, "passed", *times)
    objects = (
        ObjectRecord.of(
            presence.obj,
            tuple((start, min(end, simulator.time)) for start, end in presence.intervals),
            presence.pose,
        )
        for presence in cell.presence.values()
    )
    run = Run(
        scenario="",
        file="",
        case="",
        seed=0,
        robot=cell.description,
        objects=tuple(objects),
        attachments=tuple(cell.attachments),
        steps=(step,),
        signals=simulator.finish(skipped),
        unrecorded=("clearances", "planned_clearances"),
    )
    return judge(run, [placed])[0].status == "passed"


def _not_read(spec: Expectation, first: int, timestep: float) -> int:
    """How many samples of a run an expectation does not read over a step from a sample on.

    Without them, a look takes as long late in a run as early.
    """
    is_of_step = not any(part.during for part in (spec, *spec.predicates().values()))
    back = spec.looks_back() if is_of_step else None
    return 0 if back is None else max(0, first - 1 - math.ceil(back / timestep))
