"""How much of the variance of a file's results each of its parameters explains."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.core.types import FloatArray
from harness.reporting.suite.columns import Columns, VariedQuantity

FEWEST_RUNS = 8
"""With fewer runs a share says nothing."""

MOST_WITHOUT_MARGIN = 0.1
"""With a larger part of runs without a margin, outcomes are explained instead of margins."""

BINS = 8


@dataclass(frozen=True)
class Effect:
    """The share of the variance that one parameter explains alone.

    Attributes:
        share: The part of the variance, from 0 to 1; None where these runs cannot show it.
        reason: Why there is no share; empty where there is one.
    """

    path: str
    share: float | None
    reason: str = ""


@dataclass(frozen=True)
class FileSensitivity:
    """The effects of everything that varies among the runs of one file.

    Attributes:
        measured: What varies with the parameters: `worst margin` or `outcome`.
        effects: The largest share first; empty where the file has too few runs.
    """

    file: str
    runs: int
    measured: str = ""
    effects: Sequence[Effect] = ()


def sensitivities(columns: Columns) -> Iterator[FileSensitivity]:
    """Judge each parameter among the runs of one file, in the order of the files.

    The runs of a file are divided into groups by the parameter: by its values, or into groups of
    equal size. The share is epsilon squared [1], the variance between the groups without what
    chance puts there.

    References:
        [1] T. L. Kelley, "An Unbiased Correlation Ratio Measure", Proceedings of the National
            Academy of Sciences 21(9), 1935.
    """
    files, parameters = np.array(columns.file_numbers), columns.parameters
    shares, is_good = np.array(columns.shares), columns.is_good
    for number, file in enumerate(columns.files):
        chosen = files == number
        runs = int(chosen.sum())
        if runs < FEWEST_RUNS:
            yield FileSensitivity(file, runs)
            continue
        measured, values = _measured(shares[chosen], is_good[chosen])
        effects = [
            _effect(each, numbers, values, measured)
            for each in parameters
            if len(np.unique((numbers := each.numbers[chosen])[np.isfinite(numbers)])) > 1
        ]
        effects.sort(key=lambda each: -1.0 if each.share is None else each.share, reverse=True)
        yield FileSensitivity(file, runs, measured, effects)


def _measured(shares: FloatArray, is_good: NDArray[np.bool_]) -> tuple[str, FloatArray]:
    known = np.isfinite(shares)
    if known.mean() >= 1 - MOST_WITHOUT_MARGIN and np.ptp(shares[known]) > 0:
        return "worst margin", shares
    return "outcome", is_good.astype(float)


def _effect(
    parameter: VariedQuantity, numbers: FloatArray, values: FloatArray, measured: str
) -> Effect:
    known = np.isfinite(numbers) & np.isfinite(values)
    numbers, values = numbers[known], values[known]
    if not np.var(values):
        return Effect(parameter.path, None, f"every run has the same {measured}")
    distinct = np.unique(numbers)
    if len(distinct) < 2:
        return Effect(parameter.path, None, "one value in all runs with a margin")
    is_repeated = 2 * len(distinct) <= len(values)
    if len(values) < FEWEST_RUNS or (parameter.words and not is_repeated):
        return Effect(parameter.path, None, f"too few runs: {len(values)}")
    if is_repeated and (parameter.words or len(distinct) <= BINS):
        groups = [values[numbers == each] for each in distinct]
    else:
        count = min(BINS, len(values) // 4)
        groups = np.array_split(values[np.argsort(numbers, kind="stable")], count)
    within = sum(float(((group - group.mean()) ** 2).sum()) for group in groups)
    total = float(((values - values.mean()) ** 2).sum())
    freedom = (len(values) - 1) / (len(values) - len(groups))
    return Effect(parameter.path, max(0.0, 1 - within / total * freedom))
