"""Planners compared: the medians of their measurements, as rows of a table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from harness.plugins.campaigns.bench.collect import MotionTrials
from harness.plugins.campaigns.bench.trial import Trial


@dataclass(frozen=True)
class ComparedQuantity:
    """A measured quantity that is compared between planners.

    Attributes:
        key: The key in results.json.
        name: Displayed name with unit.
        value: Value of a trial in that unit; NaN if the trial has none.
        digits: The number of decimals shown.
        solved_only: Whether failed trials have no value.
        may_be_log: Whether a plot may use a logarithmic axis.
    """

    key: str
    name: str
    value: Callable[[Trial], float]
    digits: int
    solved_only: bool = True
    may_be_log: bool = False


QUANTITIES = (
    ComparedQuantity(
        "state_checks", "state checks", lambda t: float(t.state_checks), 0, False, True
    ),
    ComparedQuantity(
        "planning_time", "planning time [ms]", lambda t: 1e3 * t.planning_time, 1, True, True
    ),
    ComparedQuantity("path_length", "path length [rad]", lambda t: t.path_length, 2),
    ComparedQuantity("smoothness", "smoothness [rad²]", lambda t: t.smoothness, 4),
    ComparedQuantity("clearance", "clearance [mm]", lambda t: 1e3 * t.clearance, 1),
)
"""The table shows their medians. Smaller values are better, except for the clearance."""


def values(quantity: ComparedQuantity, trials: Sequence[Trial]) -> list[float]:
    """A quantity of the trials that have it."""
    found = [quantity.value(t) for t in trials if t.is_solved or not quantity.solved_only]
    return [value for value in found if np.isfinite(value)]


def of_planner(motions: Sequence[MotionTrials], planner: str) -> list[Trial]:
    """A planner's trials on the motions that are searched."""
    return [
        trial
        for motion in motions
        if motion.is_searched
        for trial in motion.trials
        if trial.planner == planner
    ]


def planner_table(motions: Sequence[MotionTrials], planners: Sequence[str]) -> str:
    """One row per planner: its successes, then the medians."""
    rows = [["planner", "success", *(quantity.name for quantity in QUANTITIES)]]
    for planner in planners:
        trials = of_planner(motions, planner)
        solved = sum(trial.is_solved for trial in trials)
        row = [planner, f"{solved}/{len(trials)}"]
        for quantity in QUANTITIES:
            found = values(quantity, trials)
            row.append(f"{np.median(found):.{quantity.digits}f}" if found else "-")
        rows.append(row)
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  ".join(
            cell.ljust(width) if place == 0 else cell.rjust(width)
            for place, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    )


def failure_lines(motions: Sequence[MotionTrials], planners: Sequence[str]) -> Iterator[str]:
    """Each planner's errors with their number, and the first one's reason."""
    for planner in planners:
        failed = [trial for trial in of_planner(motions, planner) if not trial.is_solved]
        for code, count in Counter(trial.error_code for trial in failed).most_common():
            first = next(trial for trial in failed if trial.error_code == code)
            yield f"{planner}: {count} times {code}, with seed {first.seed}: {first.message}"


def motion_line(motion: MotionTrials) -> str:
    """A motion in one line: its place in the file and how many of its trials succeeded."""
    place = f"{motion.file}:{motion.line}"
    if not motion.is_searched:
        return f"{place}: {motion.summary}: the direct joint motion is free, no search is needed"
    solved = sum(trial.is_solved for trial in motion.trials)
    return f"{place}: {motion.summary}: {solved} of {len(motion.trials)} plans found"
