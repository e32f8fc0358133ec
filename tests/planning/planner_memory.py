"""Measures the memory that plans keep; for a process in which nothing else happened."""

import gc
import resource
from pathlib import Path

import numpy as np

from harness.planning.search.planner_names import planner_names
from tests.planning.planner_trial import Trial


def memory_kept_by_plans() -> dict[str, float]:
    """By how much 25 plans of each planner enlarge this process, at the least of two times [MB]."""
    trial = Trial()
    return {name: _kept(trial, name) for name in planner_names()}


def _kept(trial: Trial, name: str) -> float:
    after: list[float] = []
    for _ in range(3):  # what is kept grows each time, while the heap takes memory now and then
        for seed in range(25):
            trial.search(name, seed, 2000)
        gc.collect()
        after.append(_resident())
    return float(np.diff(after).min())


def _resident() -> float:
    """Memory of this process [MB]."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * resource.getpagesize() / 2**20
