"""Joint positions: anywhere, near limits, near singularities."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from hypothesis import strategies as st

from harness.core.types import FloatArray
from harness.language.scenario import RobotSpec
from harness.plugins.iktest.chain import Chain
from harness.plugins.iktest.strategies.tasks import Task, manipulability, natural_task
from harness.robot.load import load_robot

Positions = st.SearchStrategy[FloatArray]

MOST_CELLS = 256  # Hypothesis draws up to this many numbers evenly; of more, mostly small ones
CELLS = (1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0)
"""Widths of the cells that divide a range [rad or m]; positions shrink to the cells' edges."""

PARTS = 100  # of a cell; positions are drawn between its edges too
OFFSETS = (0.0, 1e-9, 1e-6, 1e-4, 1e-2)  # distances from a limit or a singularity [rad or m]

SEARCHED, REFINED = 33, 4


def load_chain(robot: str, *, gripper: str | None = None, group: str = "", link: str = "") -> Chain:
    """The chain of a robot, its base at the world's origin.

    Args:
        robot: A bundled name (`ur3e`), a folder with a robot.yaml, a .urdf or a .xacro file.
        link: The link at the chain's end; by default the TCP.

    Raises:
        RobotError: The robot is unknown, or its files cannot be used.
    """
    suffix = Path(robot).suffix.lower()
    key = {".urdf": "urdf", ".xacro": "xacro"}.get(suffix, "model")
    spec = RobotSpec.of_options({key: robot, "gripper": gripper})
    return Chain.of(load_robot(spec), group, link)


def joint_positions(chain: Chain, *, margin: float = 0.0) -> Positions:
    """Positions anywhere between the limits, shape (dof,) [rad or m]; the simplest is home.

    Args:
        margin: Share of each range that is kept free on both sides, [0, 0.5).
    """
    return st.tuples(*_each_joint(chain, margin)).map(np.array)


def near_limit_positions(chain: Chain) -> Positions:
    """Positions with at least one joint at a limit or next to it."""
    limits = [
        (index, limit, inward)
        for index in range(chain.dof)
        for limit, inward in ((chain.lower[index], 1.0), (chain.upper[index], -1.0))
    ]
    chosen = st.lists(
        st.tuples(st.sampled_from(limits), st.sampled_from(OFFSETS)),
        min_size=1,
        max_size=chain.dof,
        unique_by=lambda one: one[0][0],
    )

    def placed(positions: FloatArray, changes: Sequence[tuple[tuple[int, float, float], float]]):  # noqa: ANN202
        positions = np.array(positions)
        for (index, limit, inward), offset in changes:
            positions[index] = limit + inward * offset
        return positions

    return st.builds(placed, joint_positions(chain), chosen)


def near_singular_positions(chain: Chain, task: Task | None = None) -> Positions:
    """Positions at a singularity of a task, or next to it.

    Starting from arbitrary positions, the joint with the strongest effect moves to the minimum of
    the Jacobian's smallest singular value.

    Args:
        task: The arm's task; by default `natural_task`.
    """
    fixed = task or natural_task(chain)

    def singular(positions: FloatArray, offset: float) -> FloatArray:
        found, joint = _to_singularity(chain, fixed, positions)
        moved = np.array(found)
        moved[joint] += offset if moved[joint] + offset <= chain.upper[joint] else -offset
        return moved

    return st.builds(singular, joint_positions(chain), st.sampled_from(OFFSETS))


def _to_singularity(chain: Chain, task: Task, positions: FloatArray) -> tuple[FloatArray, int]:
    """The most singular positions that differ in one joint, and which joint."""
    lower, upper = chain.lower, chain.upper
    best, joints = np.array(positions), list(range(chain.dof))
    for _ in range(REFINED):
        grid = np.linspace(lower, upper, SEARCHED)  # (SEARCHED, dof)
        samples = np.tile(best, (len(joints), SEARCHED, 1))
        for row, joint in enumerate(joints):
            samples[row, :, joint] = grid[:, joint]
        values = manipulability(chain, task, samples.reshape(-1, chain.dof))
        row, place = divmod(int(np.argmin(values)), SEARCHED)
        best, joints = samples[row, place], [joints[row]]
        width = (upper - lower) / (SEARCHED - 1)
        lower, upper = np.maximum(best - width, chain.lower), np.minimum(best + width, chain.upper)
    return best, joints[0]


def _each_joint(chain: Chain, margin: float) -> list[st.SearchStrategy[float]]:
    room = margin * (chain.upper - chain.lower)
    rows = zip(chain.lower + room, chain.upper - room, chain.home, strict=True)
    return [_position(float(low), float(high), float(home)) for low, high, home in rows]


def _position(low: float, high: float, home: float) -> st.SearchStrategy[float]:
    """A position between bounds: a number of cells from home, nearest first, and a part of one."""
    home = min(max(home, low), high)
    cell = next((width for width in CELLS if (high - low) / width < MOST_CELLS - 2), high - low)
    above, below = int(np.ceil((high - home) / cell)), int(np.ceil((home - low) / cell))
    cells = sorted(range(-below, above + 1), key=lambda number: (abs(number), -number))

    def position(part: int, number: int) -> float:
        away = number + np.copysign(part / PARTS, number)
        return min(max(round(home + away * cell, 9), low), high)

    return st.builds(position, st.integers(0, PARTS - 1), st.sampled_from(cells))
