"""One search of the lesson's first motion past its boxes, as tests of the planners share it."""

from harness.planning.collision.checker import MotionChecker
from harness.planning.model.robot_model import GroupSpace
from harness.planning.search.path_search import Search, search
from harness.ports.motion_planning import PlanningOptions
from harness.ports.path_planning import PathRequest
from tests.planning.lesson import ARM, FIRST_BOXES, Cell, boxes, ur

RESOLUTION = 1 / 16


class Trial:
    """A UR3e that has to come from `mogi_down` to other positions."""

    def __init__(self) -> None:
        self.cell = Cell(ur("ur3e"))
        self.cell.add(boxes(*FIRST_BOXES))
        self.start, self.goal = self.cell.named("mogi_down"), self.cell.named("up")
        self.space = GroupSpace(self.cell.kinematics.robot, ARM, self.cell.with_arm(self.start))

    def checker(self) -> MotionChecker:
        return MotionChecker(self.cell.scene, self.space, self.start, 0.0)

    def request(self) -> PathRequest:
        checker = self.checker()
        return PathRequest(
            planner_id="RRTConnect",
            space=checker.space,
            start=self.start,
            goals=(self.goal,),
            is_state_free=checker.state_free,
            is_edge_free=lambda first, second: checker.edge_free(first, second, RESOLUTION),
            state_checks=lambda: checker.checks,
            max_state_checks=3000,
            resolution=RESOLUTION,
            seed=0,
            parameters={},
        )

    def search(self, name, seed=5, budget=3000, goals=None, **parameters) -> Search:
        return search(
            PlanningOptions(planner_id=name, parameters=parameters),
            self.checker(),
            self.start,
            [self.goal] if goals is None else goals,
            max_state_checks=budget,
            seed=seed,
        )


def signature(found: Search) -> tuple[int, int, float, str]:
    """All of a search, to the bit."""
    path = "" if found.waypoints is None else found.waypoints.tobytes().hex()
    return found.checks, found.vertices, found.gap, path
