"""Whether an expectation that ends a step holds at the present moment of a run."""

from __future__ import annotations

import math

from harness.cell.cell import Cell
from harness.cell.scope import At
from harness.judging.contacts import was_in_robot
from harness.judging.expectation import Expectation, Predicate
from harness.judging.judge import judge
from harness.judging.placed import PlacedExpectation, as_expectation, check_expectation
from harness.language.expectation import ExpectationFields
from harness.ports.simulation import RecordingSimulator
from harness.recording.run import Run
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
    until: ExpectationFields,
    cell: Cell,
    simulator: RecordingSimulator,
    *,
    since: tuple[float, int],
    looked: int = 0,
) -> bool:
    """Whether an expectation passes that ends the current step.

    Args:
        since: Time [s] and sample at which the step began.
        looked: The last sample at which it was found not to hold; 0 before the first look.
    """
    current, (begin, first) = cell.current, since
    placed = PlacedExpectation.of(until, current.id, current.line)
    if looked and _lacks_touch(placed.spec, _run_from(looked, (), cell, simulator)):
        return False
    skipped = _not_read(placed.spec, first, simulator.timestep)
    times = begin, simulator.time, first - skipped, simulator.sample_count - skipped
    step = StepRecord(current.id, current.path, "", "", current.line, "passed", *times)
    return judge(_run_from(skipped, (step,), cell, simulator), [placed])[0].status == "passed"


def _run_from(
    first: int, steps: tuple[StepRecord, ...], cell: Cell, simulator: RecordingSimulator
) -> Run:
    """What the simulator has recorded from a sample on."""
    return Run(
        scenario="",
        file="",
        case="",
        seed=0,
        robot=cell.description,
        objects=tuple(each.record(simulator.time) for each in cell.presence.values()),
        attachments=tuple(cell.attachments),
        steps=steps,
        signals=simulator.finish(first),
        unrecorded=("clearances", "planned_clearances"),
    )


def _lacks_touch(spec: Expectation, run: Run) -> bool:
    """Whether an expectation that needs the robot's touch cannot hold at a sample of a run."""
    name = getattr(spec, "object", None)
    if not isinstance(spec, Predicate) or not spec.needs_touch or spec.during or name is None:
        return False
    return not was_in_robot(run, str(name), slice(None))


def _not_read(spec: Expectation, first: int, timestep: float) -> int:
    """How many samples of a run an expectation does not read over a step from a sample on.

    Without them, a look takes as long late in a run as early.
    """
    is_of_step = not any(part.during for part in (spec, *spec.predicates().values()))
    back = spec.looks_back() if is_of_step else None
    return 0 if back is None else max(0, first - 1 - math.ceil(back / timestep))
