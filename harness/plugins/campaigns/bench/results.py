"""A comparison as files: `results.json` and `benchmark.svg`."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from harness.core.files import replaced, writing
from harness.plugins.campaigns.bench.collect import MotionTrials
from harness.plugins.campaigns.bench.plot import plot
from harness.plugins.campaigns.bench.trial import Trial
from harness.reporting.json_text import json_text

FORMAT = "armharness-bench/1"
RESULTS, PICTURE = "results.json", "benchmark.svg"


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
    """Write both files into a folder, each whole or not at all.

    Raises:
        HarnessError: The files cannot be written there.
    """
    searched = sum(motion.is_searched for motion in motions)
    title = f"{searched} searched motions, {len(seeds)} seeds"
    texts = {
        RESULTS: json_text(document(motions, planners, seeds)),
        PICTURE: plot(motions, planners, title),
    }
    with writing(folder):
        for name, text in texts.items():
            with replaced(folder / name) as file:
                file.write(text.encode())


def _without_time(trial: Trial) -> dict[str, Any]:
    plain = {each.name: getattr(trial, each.name) for each in dataclasses.fields(trial)}
    del plain["planning_time"]
    return plain
