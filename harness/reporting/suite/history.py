"""Worst margins of earlier runs, from the `results.json` files of a folder."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, cast

from harness.core.files import read_at_most
from harness.core.limits import RESULTS_DOCUMENT
from harness.core.untrusted_json import parse_json
from harness.reporting.suite.record import FORMAT

MOST_RUNS = 30  # earlier runs that count

Key = tuple[str, str]  # file and name of a case
History = Mapping[Key, Sequence[float | None]]


def history_of(folder: Path) -> dict[Key, list[float | None]]:
    """For each case its worst margin in each earlier run, as a share of its limit, oldest first.

    Args:
        folder: Its `*.json` files, and `results.json` files in folders below, count in the order
            of their names, the last `MOST_RUNS` of them. Others are left out.

    Returns:
        None where a run has no such case, or the case no margin.
    """
    runs = list(_runs(folder))[-MOST_RUNS:]
    keys = dict.fromkeys(key for run in runs for key in run)
    return {key: [run.get(key) for run in runs] for key in keys}


def _runs(folder: Path) -> Iterator[dict[Key, float | None]]:
    files = {*folder.glob("*.json"), *folder.glob("**/results.json")}
    for file in sorted(files):
        try:
            document = cast("dict[str, Any]", parse_json(read_at_most(file, RESULTS_DOCUMENT)))
            if document["format"] != FORMAT:
                continue
            yield {(case["file"], case["case"]): _share(case) for case in document["cases"]}
        except (OSError, ValueError, KeyError, TypeError, OverflowError):
            continue


def _share(case: dict[str, Any]) -> float | None:
    margin = case.get("worst_margin")
    share = math.nan if margin is None else float(margin["share"])
    return share if math.isfinite(share) else None
