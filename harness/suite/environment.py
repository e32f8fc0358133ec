"""The process around a run: one thread in the numeric libraries, the same everywhere."""

from __future__ import annotations

import os

MUJOCO_GL = "MUJOCO_GL"
"""Names a graphics library; where that is missing, mujoco refuses to be imported, even by a run
that draws nothing. Pictures are drawn with what there is, so the variable is kept from mujoco."""

ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


def prepare_process() -> None:
    """Prepare this process for a run, before anything of it is imported."""
    use_one_thread()
    without_mujoco_gl = os.environ.pop(MUJOCO_GL, None)
    try:
        import harness.simulation  # noqa: F401
    finally:
        if without_mujoco_gl is not None:
            os.environ[MUJOCO_GL] = without_mujoco_gl


def server_environment() -> dict[str, str]:
    """The environment variables of the process that runs are forked from."""
    return {name: value for name, value in os.environ.items() if name != MUJOCO_GL}


def use_one_thread() -> None:
    """Keep BLAS from starting threads, here and in child processes.

    A fork does not copy threads, and the order in which threads sum numbers is not deterministic.
    Counts only before numpy's first import; what the user has set stays.
    """
    for name in ONE_THREAD:
        os.environ.setdefault(name, "1")
