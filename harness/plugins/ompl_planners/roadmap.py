"""Finds a path through a roadmap that OMPL grows: in rounds, on one thread, then queries it."""

# pyright: reportAttributeAccessIssue=false, reportIndexIssue=false

from __future__ import annotations

import heapq
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import ompl.base as ob
import ompl.geometric as og

from harness.core.types import FloatArray

ROUND = 600
"""State checks of the first rounds; later ones take a quarter of what was used before them."""

Point = tuple[float, ...]


class _EndsFirst(ob.ValidStateSampler):
    """Draws the start and the goals, so that they are milestones, then free states."""

    def __init__(self, information: ob.SpaceInformation, ends: Sequence[Point]) -> None:
        super().__init__(information)
        self._ends = list(ends)
        self._free = ob.UniformValidStateSampler(information)

    def sample(self, state: ob.State) -> bool:
        if not self._ends:
            return self._free.sample(state)
        for index, value in enumerate(self._ends.pop(0)):
            state[index] = value
        return True


@dataclass(frozen=True, eq=False)
class _Roadmap:
    """Milestones by number, the start and the goals first, and what each is joined to."""

    points: list[Point]
    joined: list[list[int]]

    def ways_from(self, sources: Sequence[int]) -> dict[int, tuple[float, int]]:
        """Milestone -> length of the shortest way to it [rad], the milestone before it."""
        settled: dict[int, tuple[float, int]] = {}
        queue = [(0.0, source, source) for source in sources]
        while queue:
            length, here, before = heapq.heappop(queue)
            if here in settled:
                continue
            settled[here] = (length, before)
            for there in self.joined[here]:
                if there not in settled:
                    further = length + math.dist(self.points[here], self.points[there])
                    heapq.heappush(queue, (further, there, here))
        return settled


def find_in_roadmap(
    planner: og.PRM,
    ends: Sequence[Point],
    used: Callable[[], int],
    enough: int,
    end: int,
) -> tuple[FloatArray | None, float]:
    """Grow a roadmap until it joins the start to a goal; the shortest way through it, and the gap.

    OMPL's `solve` looks for a way on a second thread while the first one grows the roadmap, and
    turns from growing to expanding by the clock: equal runs differ. Here both take state checks,
    two to one as in OMPL, and the way is looked for between rounds.

    Args:
        enough: A way that is found before is improved until then [state checks].
        end: When to stop without one [state checks].

    Returns:
        Waypoints, shape (N, dof), or None; joint-space distance left between what the start and
        what the goals are joined to [rad], 0 when solved.

    References:
        L. Kavraki, P. Svestka, J.-C. Latombe, M. Overmars, "Probabilistic Roadmaps for Path
        Planning in High-Dimensional Configuration Spaces", IEEE T-RA 12(4), 1996.
    """
    information = planner.getSpaceInformation()
    information.setValidStateSamplerAllocator(lambda owner: _EndsFirst(owner, ends))
    first = used()
    while True:
        stop = used() + max(ROUND, (used() - first) // 4)
        stop = min(stop, enough if used() < enough else end)
        planner.growRoadmapPtc(_until(stop - (stop - used()) // 3, used))
        planner.expandRoadmapPtc(_until(stop, used))
        if used() < enough:
            continue
        way, gap = _query(_read(planner, information, ends), ends)
        if way is not None or used() >= end:
            return way, gap


def _until(checks: int, used: Callable[[], int]) -> ob.PlannerTerminationCondition:
    return ob.PlannerTerminationCondition(lambda: used() >= checks)


def _read(planner: og.PRM, information: ob.SpaceInformation, ends: Sequence[Point]) -> _Roadmap:
    """What has grown; milestones that nothing is joined to are missing in OMPL's data."""
    data = ob.PlannerData(information)
    planner.getPlannerData(data)
    numbers: dict[Point, int] = {}
    for point in ends:
        numbers.setdefault(point, len(numbers))
    vertices: list[int] = []
    for vertex in range(data.numVertices()):
        state = data.getVertex(vertex).getState()
        point = tuple(state[index] for index in range(len(ends[0])))
        vertices.append(numbers.setdefault(point, len(numbers)))
    joined: list[list[int]] = [[] for _ in numbers]
    for vertex, number in enumerate(vertices):
        joined[number] += [vertices[other] for other in data.getEdges(vertex)]
    return _Roadmap(list(numbers), joined)


def _query(roadmap: _Roadmap, ends: Sequence[Point]) -> tuple[FloatArray | None, float]:
    """The shortest way from the start to the goal that is nearest by it, or None; the gap."""
    start, *goals = (roadmap.points.index(point) for point in ends)
    ways = roadmap.ways_from([start])
    reached = [goal for goal in goals if goal in ways]
    if not reached:
        near = np.array([roadmap.points[number] for number in ways])
        far = np.array([roadmap.points[number] for number in roadmap.ways_from(goals)])
        return None, min(float(np.linalg.norm(far - point, axis=1).min()) for point in near)
    way = [min(reached, key=lambda goal: ways[goal])]
    while way[-1] != start:
        way.append(ways[way[-1]][1])
    return np.array([roadmap.points[number] for number in way[::-1]]), 0.0
