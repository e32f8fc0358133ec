"""What differs between two saved runs: steps, trajectories, verdicts, signals, versions."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from itertools import zip_longest

import numpy as np

from harness.core.amounts import amount, amounts, is_visible, stated_amount
from harness.core.trajectory import JointTrajectory, path_length
from harness.core.types import FloatArray
from harness.plugins.comparison.alignment import StepPair, aligned_steps, names_of
from harness.plugins.comparison.farthest import Farthest, farthest_apart
from harness.plugins.comparison.first_difference import FirstDifference, first_difference
from harness.recording.run import Run
from harness.recording.step_record import StepRecord
from harness.recording.stored_run import StoredRun
from harness.recording.verdict import Verdict

DRAWN = re.compile(r"-?\d+\.\d{7,}")  # as `randomize` draws them, not as people write them
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
EVERY_DIGIT = 17  # of a double

VerdictPair = tuple[str, Verdict | None, Verdict | None]


@dataclass(frozen=True)
class Change:
    """One thing that differs.

    Attributes:
        what: `scenario` (a line of the resolved file), `verdict`, `step`, `trajectory`, `version`,
            `robot`, `seed`, `outcome` ...
        name: The name of the step, expectation or library.
        before: The value in the first run, in words; `-` where it has none.
        amount: After less before, where both are one number; NaN elsewhere.
        unit: The unit of the amount, which `difference` writes.
    """

    what: str
    name: str
    before: str
    after: str
    amount: float = float("nan")
    unit: str = ""

    @property
    def difference(self) -> str:
        """`+2.0 mm`, or how far apart two trajectories are; empty where there is no number."""
        if np.isnan(self.amount):
            return ""
        if self.what == "trajectory":
            return f"{amount(self.amount, self.unit)} apart"
        return f"{'-' if self.amount < 0 else '+'}{amount(abs(self.amount), self.unit)}"


@dataclass(frozen=True)
class RunComparison:
    """Two runs side by side.

    Attributes:
        is_same: Whether the digests of what both folders hold are equal.
        changes: The changes: everything that differs.
        first_difference: Where the recordings part.
        farthest: Where the tool and objects are farthest apart.
        warnings: What was changed in either folder after its run was written.
    """

    is_same: bool
    changes: tuple[Change, ...]
    first_difference: FirstDifference | None
    farthest: tuple[Farthest, ...] = ()
    warnings: tuple[str, ...] = ()


def compare(first: StoredRun, second: StoredRun) -> RunComparison:
    """Everything that differs, the outcome first."""
    one, two = first.run, second.run
    pairs = aligned_steps(one, two)
    names = names_of(pairs)
    changes = [
        *_words("outcome", "", first.outcome, second.outcome),
        *(Change("scenario", "", *_readable(*each)) for each in line_changes(first, second)),
        *_words("robot", "", one.robot.name, two.robot.name),
        *_words("seed", "", str(one.seed), str(two.seed)),
        *_versions(one.versions, two.versions),
        *_steps(pairs, names, one.robot.joint_units.by_joint),
        *_verdicts(verdict_pairs(first, second)),
        *_findings(one, two),
    ]
    warnings = (
        *(f"first run: {each}" for each in first.changes()),
        *(f"second run: {each}" for each in second.changes()),
    )
    is_same = first.content_digest == second.content_digest
    parting = first_difference(one, two)
    return RunComparison(is_same, tuple(changes), parting, farthest_apart(one, two), warnings)


def _readable(before: str, after: str) -> tuple[str, str]:
    """Two lines of files, whose drawn numbers have as many digits as show where they differ."""
    for digits in range(4, EVERY_DIGIT):
        lines = [
            DRAWN.sub(lambda number, count=digits: f"{float(number[0]):.{count}g}", line)
            for line in (before, after)
        ]
        if lines[0] != lines[1]:
            return lines[0], lines[1]
    return before, after


def _words(what: str, name: str, before: str, after: str) -> list[Change]:
    return [] if before == after else [Change(what, name, before, after)]


def _versions(one: Mapping[str, str], two: Mapping[str, str]) -> list[Change]:
    names = sorted(one.keys() | two.keys())
    return [
        change
        for name in names
        for change in _words("version", name, one.get(name, NONE), two.get(name, NONE))
    ]


def _steps(
    pairs: Sequence[StepPair],
    names: tuple[Mapping[str, str], Mapping[str, str]],
    units: Mapping[str, str],
) -> list[Change]:
    changes: list[Change] = []
    for a, b in pairs:
        name = names[0][a.id] if a is not None else names[1][b.id] if b is not None else ""
        if a is None or b is None:
            changes.append(Change("step", name, _status(a), _status(b)))
            continue
        changes += _words("step", name, a.summary, b.summary)
        changes += _words("step", name, _status(a), _status(b))
        changes += _trajectory(name, a, b, units)
        lasted = a.end_time - a.start_time, b.end_time - b.start_time
        if is_visible(lasted[1] - lasted[0], "s"):
            changes.append(_number("duration", name, *lasted, "s"))
    return changes


def _status(step: StepRecord | None) -> str:
    if step is None:
        return NONE
    return f"{step.status} {step.error_code}".rstrip()


def _trajectory(
    name: str, one: StepRecord, two: StepRecord, units: Mapping[str, str]
) -> list[Change]:
    """The joint that is farthest apart, compared at equal parts of the durations."""
    ours, theirs = one.trajectory, two.trajectory
    if ours is None or theirs is None:
        words = ["planned" if step.trajectory else NONE for step in (one, two)]
        return _words("trajectory", name, words[0], words[1])
    joints = [", ".join(trajectory.joint_names) for trajectory in (ours, theirs)]
    if joints[0] != joints[1]:
        return [Change("trajectory", name, joints[0], joints[1])]
    before, after = _resampled(ours), _resampled(theirs)
    apart = np.abs(after - before).max(axis=0)
    known = [units.get(joint, "") for joint in ours.joint_names]
    if not any(map(is_visible, apart.tolist(), known)):
        return []
    shared = known[0] if len(set(known)) == 1 else ""
    words = [f"path of {amount(path_length(path), shared)}".rstrip() for path in (before, after)]
    worst = int(np.argmax(apart))
    return [Change("trajectory", name, words[0], words[1], float(apart[worst]), known[worst])]


def _resampled(trajectory: JointTrajectory) -> FloatArray:
    times, positions = trajectory.times, trajectory.positions
    at = np.linspace(float(times[0]), float(times[-1]), 200)
    resampled = np.empty((len(at), positions.shape[1]))
    for joint in range(positions.shape[1]):
        resampled[:, joint] = np.interp(at, times, positions[:, joint])
    return resampled


def verdict_pairs(first: StoredRun, second: StoredRun) -> list[VerdictPair]:
    """The expectations of both runs by text and step; None where a run has no verdict on it."""
    names = names_of(aligned_steps(first.run, second.run))
    ours, theirs = map(_by_name, (first.verdicts, second.verdicts), names)
    twins = _twins([each for each in ours if each not in theirs],
                   [each for each in theirs if each not in ours])  # fmt: skip
    pairs = {name: (ours.get(name), theirs.get(twins.get(name, name))) for name in [*ours, *theirs]}
    return [
        (_both(name, twins[name]) if name in twins else name, *pair)
        for name, pair in pairs.items()
        if name not in twins.values()
    ]


def _verdicts(pairs: Sequence[VerdictPair]) -> Iterator[Change]:
    for name, a, b in pairs:
        if a is None or b is None or (a.status, a.expectation) != (b.status, b.expectation):
            yield Change("verdict", name, _judged(a), _judged(b))
        elif a.unit != b.unit or is_visible(b.margin - a.margin, a.unit):
            yield _margin(name, a, b)


def _twins(ours: Sequence[str], theirs: Sequence[str]) -> dict[str, str]:
    """Expectations of one run, and of the other one those that differ from them in numbers."""
    twins: dict[str, str] = {}
    for name in ours:
        alike = (each for each in theirs if NUMBER.sub("#", each) == NUMBER.sub("#", name))
        twin = next((each for each in alike if each not in twins.values()), None)
        if twin is not None:
            twins[name] = twin
    return twins


def _both(one: str, two: str) -> str:
    """A sentence with the numbers of both: `duration is at least 0.05 → 2.0 s`."""
    numbers = iter(NUMBER.findall(two))

    def with_other(number: re.Match[str]) -> str:
        other = next(numbers)
        return number[0] if number[0] == other else f"{number[0]} → {other}"

    return NUMBER.sub(with_other, one)


def _margin(name: str, one: Verdict, two: Verdict) -> Change:
    if one.unit == two.unit:
        return _number("margin", name, one.margin, two.margin, one.unit)
    before, after = (amount(each.margin, each.unit) for each in (one, two))
    return Change("margin", name, before, after)


def _by_name(verdicts: Sequence[Verdict], steps: Mapping[str, str]) -> dict[str, Verdict]:
    """Verdicts under a name that does not depend on lines: text, step, and which of equal ones.

    Args:
        verdicts: Those of a run.
        steps: Names of its steps by their ids.
    """
    named: dict[str, Verdict] = {}
    for verdict in verdicts:
        step = steps.get(verdict.step, verdict.step)
        base = f"{verdict.expectation} ({step})" if step else verdict.expectation
        name, count = base, 2
        while name in named:
            name, count = f"{base} #{count}", count + 1
        named[name] = verdict
    return named


def _judged(verdict: Verdict | None) -> str:
    if verdict is None:
        return NONE
    if np.isnan(verdict.margin):
        return verdict.status
    return f"{verdict.status} by {stated_amount(abs(verdict.margin), verdict.unit)}"


def _number(what: str, name: str, before: float, after: float, unit: str) -> Change:
    return Change(what, name, *amounts(before, after, unit), after - before, unit)


def _findings(one: Run, two: Run) -> list[Change]:
    """Kinds of findings that one run has more of."""
    changes: list[Change] = []
    for kind in sorted({found.kind for found in (*one.findings, *two.findings)}):
        counts = [sum(found.kind == kind for found in run.findings) for run in (one, two)]
        changes += _words("findings", kind.replace("_", " "), *map(str, counts))
    return changes


NONE = "-"  # Stands for what one of two runs does not have
MOST = 20  # Changes that are listed one by one


def line_changes(one: StoredRun, two: StoredRun) -> list[tuple[str, str]]:
    """Each line before and after; the last says how many more there are."""
    ours, theirs = (_lines(run.resolved) for run in (one, two))
    found: list[tuple[str, str]] = []
    matcher = SequenceMatcher(None, ours, theirs, autojunk=False)
    for kind, a, b, c, d in matcher.get_opcodes():
        if kind != "equal":
            found += zip_longest(ours[a:b], theirs[c:d], fillvalue=NONE)
    if len(found) <= MOST:
        return found
    more = f"{len(found) - MOST} more lines"
    return [*found[:MOST], (more, more)]


def _lines(text: str) -> list[str]:
    """The lines without indentation, list dashes and comments, which hold the seeds of steps."""
    lines = (line.strip().removeprefix("- ") for line in text.splitlines())
    return [line for line in lines if line and not line.startswith("#")]
