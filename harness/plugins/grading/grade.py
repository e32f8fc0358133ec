"""Grade a recording of another program by a scenario's expectations."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.types import BoolArray, FloatArray, IntArray, Pair
from harness.judging.joints import stood_still
from harness.judging.judge import judge
from harness.judging.placed import PlacedExpectation
from harness.judging.temporal import episodes
from harness.language.reading.resolve import resolved_text
from harness.plugins.grading.bag.content import BagTopics
from harness.plugins.grading.bag.recorded_run import DOUBT, Recorded, run_of_bag
from harness.plugins.grading.credit import credit_of_run
from harness.plugins.grading.points import Grade, Graded, graded
from harness.recording.digest import digest
from harness.recording.drawings import Drawings
from harness.recording.run import Run
from harness.recording.stored_run import StoredRun
from harness.recording.verdict import Verdict, VerdictWarning
from harness.recording.write_run import run_folder, write_document
from harness.reporting.reporter import Reports
from harness.session.prepare import Prepared, prepare


def grade_bag(
    scenario: Path,
    bag: Path,
    topics: BagTopics | None = None,
    overrides: Mapping[str, str] | None = None,
    allowed: Collection[str] = (),
    report_dir: Path | None = None,
) -> Grade:
    """Judge a recording by the expectations of a scenario; nothing is planned or simulated.

    Args:
        scenario: The scenario file: it says which robot, world and objects were recorded.
        bag: A rosbag2 folder, an .mcap or a .db3 file.
        topics: Where joints and objects are in it.
        overrides: Dotted path in the file -> new value, as YAML text.
        allowed: Doubts about the recording that withhold no points: `steps`, `frames`, ...
        report_dir: Folder that gets the recording as a run, with its page; None writes nothing.

    Raises:
        SpecError: The scenario or the recording cannot be used.
        HarnessError: The folder cannot be written.
    """
    prepared = prepare(scenario, overrides)
    program = prepared.program
    known = Recorded(
        description=program.description,
        objects=program.all_objects(),
        at_start=frozenset(obj.name for obj in program.world.objects),
        frames=prepared.observed_links,
        steps=_steps(prepared),
        title=program.title,
        gravity=program.world.gravity,
    )
    arms = dict.fromkeys(program.description.of_arm, program.description.joint_names)
    reads_wrenches = bool(known.description.wrench_sensors)
    topics = replace(topics or BagTopics(), arms=arms, reads_wrenches=reads_wrenches)
    run = replace(run_of_bag(bag, topics, known), source=prepared.loaded.text)
    notes = [finding.message for finding in run.findings]
    doubts = [
        finding.values
        for finding in run.findings
        if finding.kind == DOUBT and finding.values["doubt"] not in allowed
    ]
    withheld = [_withheld(expectation, doubts) for expectation in prepared.expectations]
    needs_distances = [
        expectation.spec.observations().reads_distances for expectation in prepared.expectations
    ]
    # whatever they are, distances of doubtful motions earn nothing, and they take time
    is_measured = any(
        needs and not kinds for needs, kinds in zip(needs_distances, withheld, strict=True)
    )
    if is_measured:
        run = _with_distances(prepared, run)
    verdicts = judge(run, prepared.expectations)
    is_full = all(each.status == "passed" for each in verdicts)
    credit = credit_of_run(is_idle=stood_still(run), is_full=is_full)
    notes += credit.notes
    rows = [
        replace(row, earned=0.0, withheld=kinds, is_measured=is_measured or not needs)
        if kinds
        else row
        for row, kinds, needs in zip(
            graded(verdicts, credit), withheld, needs_distances, strict=True
        )
    ]
    grade = Grade(run, tuple(rows), tuple(notes))
    if report_dir is not None:
        _write_page(run, grade, report_dir, resolved_text(prepared.loaded, folder=report_dir))
    return grade


def _write_page(run: Run, grade: Grade, folder: Path, resolved: str) -> None:
    """Write the recording as the folder of a run, and its page.

    Raises:
        HarnessError: The folder cannot be written.
    """
    from harness.session.observation.visuals import mesh_records

    drawings = Drawings(mesh_records(run))
    verdicts = tuple(_credited(row) for row in grade.rows)
    outcome = "passed" if grade.is_full else "failed"
    stored = StoredRun(run, verdicts, outcome, digest(run, verdicts), {}, resolved, drawings)
    with run_folder(folder, run) as target:
        write_document(target, stored)
        Reports(["html"]).write(target, stored)


def _credited(row: Graded) -> Verdict:
    """The verdict with its points, as the page shows it."""
    verdict = replace(row.verdict, points=row.points, earned=row.earned)
    if not row.is_withheld:
        return verdict
    doubts = ", ".join(f"--allow {kind}" for kind in row.withheld)
    withheld = VerdictWarning("points withheld", f"{row.points:g}, but for {doubts}")
    return replace(verdict, warnings=(*verdict.warnings, withheld))


def _withheld(
    expectation: PlacedExpectation, doubts: Sequence[Mapping[str, Any]]
) -> tuple[str, ...]:
    """The doubts that concern what is expected."""
    spec = expectation.spec
    is_of_step = bool(expectation.step) or any(
        part.during for part in (spec, *spec.predicates().values())
    )
    kinds: list[str] = []
    for doubt in doubts:
        kind, names = doubt["doubt"], doubt["names"]
        is_named = not spec.names().isdisjoint(names)
        if is_named or (not names and (is_of_step or kind != "steps")):
            kinds.append(kind)
    return tuple(dict.fromkeys(kinds))


def _steps(prepared: Prepared) -> dict[str, tuple[int, str]]:
    known: dict[str, tuple[int, str]] = {}
    for step in prepared.program.all_steps():
        known[step.id] = known[step.path] = (step.line, step.summary)
    return known


def _with_distances(prepared: Prepared, run: Run) -> Run:
    """The run with distances, measured from joints and poses where the joints are known."""
    from harness.session.observation.clearance import CoalClearance

    known: BoolArray = np.isfinite(run.signals.joint_positions.sum(axis=1))
    there = [obj for obj in run.objects if obj.pose or obj.name in run.signals.object_poses]
    observer = CoalClearance(prepared.program.description)
    cutoff = prepared.observations.recorded_cutoff
    clearances: dict[Pair, FloatArray] = {}
    links: dict[Pair, IntArray] = {}
    for start, stop in episodes(known):
        part = slice(start, stop)
        some = replace(
            run.signals,
            times=run.signals.times[part],
            joint_positions=run.signals.joint_positions[part],
            object_poses={name: rows[part] for name, rows in run.signals.object_poses.items()},
        )
        found = observer.observe(some, there, (), cutoff)
        for key, values in found.clearances.items():
            clearances.setdefault(key, np.full(len(known), np.nan))[part] = values
        for key, values in found.clearance_links.items():
            links.setdefault(key, np.full(len(known), -1))[part] = values
    signals = replace(
        run.signals, clearances=clearances, clearance_links=links, clearance_cutoff=cutoff
    )
    missing = tuple(name for name in run.unrecorded if name != "clearances")
    return replace(run, signals=signals, unrecorded=missing) if clearances else run
