"""What is shortened is free at the states that are checked afterwards, not only before."""

import numpy as np

from harness.planning.collision.checker import MotionChecker
from harness.planning.model.robot_model import GroupSpace
from harness.planning.search.path_search import search
from harness.planning.search.shortening import shorten
from harness.ports.motion_planning import PlanningOptions
from tests.planning.lesson import ARM, FIRST_BOXES, Cell, boxes, ur

COARSE = 1 / 2  # [rad] so coarse that it matters which states of an edge are checked


def test_every_edge_of_a_shortened_path_is_free_at_its_own_states():
    cell = Cell(ur("ur3e"))
    cell.add(boxes(*FIRST_BOXES))
    start, goal = cell.named("mogi_down"), cell.named("up")
    space = GroupSpace(cell.kinematics.robot, ARM, cell.with_arm(start))
    for seed in range(40):
        checker = MotionChecker(cell.scene, space, start, 0.0)
        found = search(
            PlanningOptions(planner_id="BalancedConnect"),
            checker,
            start,
            [goal],
            resolution=COARSE,
            max_state_checks=20_000,
            seed=seed,
        )
        assert found.waypoints is not None
        short = shorten(np.asarray(found.waypoints), checker, COARSE, seed)
        assert checker.path_free(short, COARSE)
