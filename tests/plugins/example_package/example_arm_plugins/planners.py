"""Two planning pipelines: one that works, and one that is wrong on purpose."""

import numpy as np

from harness.ports import PathPlanner, PathRequest, PathResult


class ViaPoint(PathPlanner):
    """Two straight lines: to a random point, and from there to the nearest goal."""

    name = "via_point"
    parameters = ("spread",)

    def find_path(self, request: PathRequest) -> PathResult:
        """Try points near the middle, then farther away, until the budget ends the search."""
        rng, space = request.rng, request.space
        spread = request.parameters.get("spread", 0.3)
        start, goal = request.start, request.goals[0]
        tries = 0
        while True:
            tries += 1
            via = 0.5 * (start + goal) + spread * rng.normal(size=space.dof)
            via = np.clip(via, space.lower, space.upper)
            if request.is_edge_free(start, via) and request.is_edge_free(via, goal):
                return PathResult(np.array([start, via, goal]), vertices=tries)
            spread = min(1.01 * spread, np.pi)


class StraightThrough(PathPlanner):
    """Go straight to the nearest goal, through whatever is in the way: wrong on purpose."""

    name = "straight_through"

    def find_path(self, request: PathRequest) -> PathResult:
        """Return the straight line without a check."""
        return PathResult(np.array([request.start, request.goals[0]]))
