"""How success depends on what varies, as lines for the terminal and the page."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from harness.reporting.suite.columns import Columns, VariedQuantity
from harness.reporting.terminal import PLAIN, Style

BINS = 4  # parts of equal size into which numbers are cut for a table

MOST_ROWS = 12  # of a table on a terminal


def table_lines(columns: Columns, style: Style = PLAIN) -> Iterator[str]:
    """Passed of all, by each quantity that varies; the worst rows show where to look.

    Args:
        columns: What varied in each case, and whether it passed.
    """
    for parameter in columns.parameters:
        rows = list(_rows(parameter, columns.is_good))
        if len(rows) < 2:
            continue
        yield style.strong(parameter.path)
        width = max(len(label) for label, _ in rows)
        for label, goods in rows[:MOST_ROWS]:
            passed, total = int(goods.sum()), len(goods)
            mark = style.mark(passed == total)
            yield f"  {mark} {label:<{width}}  {passed:>4} of {total:<4} {passed / total:7.1%}"
        if len(rows) > MOST_ROWS:
            yield f"  ... {len(rows) - MOST_ROWS} more"
    yield from one_run_lines(columns)


def one_run_lines(columns: Columns) -> Iterator[str]:
    """A sentence for each file of which all runs are one and the same."""
    for file, count in columns.one_run:
        yield f"{file}: its {count} runs have equal digests: nothing that varies matters in them"


def _rows(
    parameter: VariedQuantity, is_good: NDArray[np.bool_]
) -> Iterator[tuple[str, NDArray[np.bool_]]]:
    """Label of each value, or of each part of a range of numbers, and which runs passed there."""
    known = np.isfinite(parameter.numbers)
    numbers, goods = parameter.numbers[known], is_good[known]
    values, first = np.unique(numbers, return_index=True)
    if parameter.words or len(values) <= BINS:
        for value in values[np.argsort(first)]:
            label = parameter.words[int(value)] if parameter.words else f"{value:.6g}"
            yield f"{label} {parameter.unit}".rstrip(), goods[numbers == value]
        return
    for chosen in np.array_split(np.argsort(numbers, kind="stable"), BINS):
        low, high = numbers[chosen[0]], numbers[chosen[-1]]
        yield f"{low:.4g} to {high:.4g} {parameter.unit}".rstrip(), goods[chosen]
