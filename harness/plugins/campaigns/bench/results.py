"""A comparison as a file, `results.json`."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from harness.core.files import replaced, writing
from harness.plugins.campaigns.bench.collect import MotionTrials
from harness.plugins.campaigns.bench.trial import Trial
from harness.reporting.json_text import json_text

FORMAT = "armharness-bench/1"
RESULTS = "results.json"


def document(
    motions: Sequence[MotionTrials], planners: Sequence[str], seeds: Sequence[int]
) -> dict[str, Any]:
    """All measurements as plain data; deterministic for the same files, except `wall_times`.

    `wall_times` holds the planning times [s]: for each motion, one per trial in order.
    """
    return {
        "format": FORMAT,
        "planners": list(planners),
        "seeds": list(seeds),
        "motions": [
            {
                "file": motion.file,
                "step": motion.step,
                "summary": motion.summary,
                "line": motion.line,
                "is_searched": motion.is_searched,
                "trials": [_without_time(trial) for trial in motion.trials],
            }
            for motion in motions
        ],
        "wall_times": [[trial.planning_time for trial in motion.trials] for motion in motions],
    }


def write_bench(
    folder: Path, motions: Sequence[MotionTrials], planners: Sequence[str], seeds: Sequence[int]
) -> None:
    """Write the file into a folder, whole or not at all.

    Raises:
        HarnessError: The file cannot be written there.
    """
    with writing(folder), replaced(folder / RESULTS) as file:
        file.write(json_text(document(motions, planners, seeds)).encode())


def _without_time(trial: Trial) -> dict[str, Any]:
    plain = {each.name: getattr(trial, each.name) for each in dataclasses.fields(trial)}
    del plain["planning_time"]
    return plain
