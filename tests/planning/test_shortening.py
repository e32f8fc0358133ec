"""A shortened path is shorter and as free as the one before, at other states too."""

import numpy as np

from harness.planning.collision.checker import MotionChecker
from harness.planning.model.robot_model import GroupSpace
from harness.planning.search.path_search import search
from harness.planning.search.shortening import shorten
from harness.planning.verification.verify import VERIFIED_RESOLUTION
from harness.ports.motion_planning import PlanningOptions
from tests.planning.lesson import ARM, FIRST_BOXES, Cell, boxes, ur


def test_a_path_shortened_at_the_resolution_of_verification_is_verified():
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
            max_state_checks=200_000,
            seed=seed,
        )
        assert found.waypoints is not None
        path = np.asarray(found.waypoints)
        short = shorten(path, checker, VERIFIED_RESOLUTION, seed)
        assert checker.path_free(short, VERIFIED_RESOLUTION)
        lengths = [np.linalg.norm(np.diff(each, axis=0), axis=1).sum() for each in (short, path)]
        assert lengths[0] <= lengths[1]
