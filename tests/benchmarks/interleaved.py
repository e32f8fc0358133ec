"""Timings taken in turns, so that a busy machine slows all of them alike."""

import os
import statistics
import time
from collections.abc import Callable, Mapping
from pathlib import Path


def with_bytecode(folder: Path) -> dict[str, str]:
    """The environment of a command that finds its modules compiled, as an installation does.

    Without bytecode, importing the modules of a run takes half as long again.

    Args:
        folder: Keeps the bytecode from one command to the next.
    """
    kept = {key: word for key, word in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    return {**kept, "PYTHONPYCACHEPREFIX": str(folder)}


def median_seconds(
    actions: Mapping[str, Callable[[], object]], repetitions: int
) -> dict[str, float]:
    """Median wall time of each action, all run once before anything is timed [s]."""
    seconds: dict[str, list[float]] = {name: [] for name in actions}
    for action in actions.values():
        action()
    for _ in range(repetitions):
        for name, action in actions.items():
            begin = time.perf_counter()
            action()
            seconds[name].append(time.perf_counter() - begin)
    return {name: statistics.median(times) for name, times in seconds.items()}
