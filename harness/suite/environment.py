"""The process around a run: one thread in the numeric libraries, the same everywhere."""

from __future__ import annotations

import os

ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


def use_one_thread() -> None:
    """Keep BLAS from starting threads, here and in child processes.

    A fork takes no threads along, and the order in which threads add up is not ours to choose.
    Counts only before numpy's first import; what the user has set stays.
    """
    for name in ONE_THREAD:
        os.environ.setdefault(name, "1")
