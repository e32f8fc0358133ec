"""Planning with the bundled arms, all of primitive shapes, on the lesson's tables."""

import statistics
import time
from itertools import pairwise

import numpy as np
import pytest

from harness.planning.collision.checker import MotionChecker
from harness.planning.model.robot_model import GroupSpace
from harness.planning.search.path_search import Effort, verified_paths
from harness.planning.search.shortening import shorten
from harness.planning.verification.verify import FINAL_RESOLUTION
from harness.ports.motion_planning import PlanningOptions
from tests.planning.lesson import FIRST_BOXES, Cell, boxes
from tests.planning.problem import HOMES, description_of

GOALS = 60
"""Random free positions that each arm goes to, one after the other."""

OPTIONS = PlanningOptions(seed=1, padding=0.002)
"""As scenarios have it when they say nothing."""

FEW = GOALS // 4
"""This share may not be solved within the budget: the problems are random."""


@pytest.mark.benchmark
@pytest.mark.parametrize("model", list(HOMES))
def test_bundled_arms_plan_and_shorten_in_milliseconds(model, print_row):
    cell = Cell(description_of(model))
    cell.add(boxes(*FIRST_BOXES))
    ends = list(_free_positions(cell, np.array(HOMES[model])))
    _motion(cell, ends[0], ends[1])  # warm
    spent = {"straight": [], "searched": [], "not solved": []}
    for start, end in pairwise(ends):
        seconds, how = _motion(cell, start, end)
        spent[how].append(seconds)
    every = [seconds for part in spent.values() for seconds in part]
    heading = (
        "bundled arms on the lesson's tables: number of motions, median ms to plan and shorten "
        "(goal: 10 ms)"
    )
    if model == next(iter(HOMES)):
        print_row(heading, "arm", "all", *spent)
    print_row(heading, model, *(_cell(part) for part in (every, *spent.values())))
    assert len(spent["not solved"]) <= FEW


def _motion(cell: Cell, start: np.ndarray, end: np.ndarray) -> tuple[float, str]:
    """Time of what `move_to` does before it times a path [s], and how the path came about."""
    begin = time.process_time()
    group = cell.description.arm_group
    space = GroupSpace(cell.kinematics.robot, group, cell.with_arm(start))
    checker = MotionChecker(cell.scene, space, start, OPTIONS.padding)
    how = "straight"
    if not checker.edge_free(start, end, FINAL_RESOLUTION):
        how = "not solved"
        for found, path in verified_paths(checker, start, [end], OPTIONS, Effort()):
            shorten(path, checker, FINAL_RESOLUTION, found.seed)
            how = "searched"
            break
    return time.process_time() - begin, how


def _free_positions(cell: Cell, home: np.ndarray):
    """The home and random positions that keep the padding."""
    space = GroupSpace(cell.kinematics.robot, cell.description.arm_group, cell.with_arm(home))
    checker = MotionChecker(cell.scene, space, home, OPTIONS.padding)
    rng = np.random.default_rng(4)
    yield home
    found = 0
    while found < GOALS:
        positions = rng.uniform(np.maximum(space.lower, -np.pi), np.minimum(space.upper, np.pi))
        if checker.state_free(positions):
            found += 1
            yield positions


def _cell(seconds: list[float]) -> str:
    return f"{len(seconds)}: {1000 * statistics.median(seconds):.2f}" if seconds else "-"
