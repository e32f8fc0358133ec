"""The fast planner: two trees of equal size that grow towards low-discrepancy samples."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from harness.core.types import FloatArray
from harness.ports.path_planning import PathRequest, PathResult

RANGE = 1.5  # Longest edge [rad]
SHORTER, SHORTEST = 0.95, 1 / 16
"""Factor by which a blocked edge shortens the next ones from its vertex, and the shortest edge as a
share of the longest. Trees whose edges were halved took ten times as long in cages."""

STALLED, STALLED_PER_CHECK = 300, 1 / 500
"""Blocked edges in a row after which the search gives up: the smaller tree cannot leave its place.

With a larger budget it is more of them. Of 132 searches in cages, which all found a path, none had
more than 134; from a closed box the search gives up before a tenth of its budget is used.
"""

BEYOND = 1.5
"""How far samples are from the tree that grows, along each joint, at most [rad]: every other one
from the box about the tree, the others from its vertices.

Both boxes grow with the tree, so that every posture is reached in the end. In the cages of
MotionBenchMaker around a UR5 and a Panda a search takes 750 and 470 edges on average, around an FR3
in other cages 100. Dynamic domains took 520, 480 and 200 with the best radius of each arm, and up
to 950 with that of another one.
"""

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
"""Multiples of it, modulo 1, are spread evenly: they select the vertices that samples surround."""

Extend = Callable[[FloatArray, FloatArray, float], Sequence[FloatArray]]
"""Returns states on the way from a state towards another one, at most a distance away [rad]: each
is joined to the one before it, and the last one is the other one where that is reached."""

_BLOCK = 256  # samples that are computed at once

PARAMETERS = ("range",)


def search_connect(request: PathRequest, extend: Extend | None = None) -> PathResult:
    """Search a path.

    RRT-Connect [1] in which the smaller tree grows [2], towards samples near it from a Halton
    sequence, whose first index follows from the seed.
    Distances are measured in the group's metric.

    Args:
        extend: How trees are extended; along free straight lines by default.

    Raises:
        ValueError: The parameter is unknown.

    References:
        [1] J. Kuffner, S. LaValle, "RRT-Connect: An Efficient Approach to Single-Query Path
            Planning", ICRA 2000. [2] The same, "An Efficient Approach to Path Planning Using
            Balanced Bidirectional RRT Search", 2005.
    """
    step = step_length(request.planner_id, request.parameters)
    space, start, goals = request.space, request.start, request.goals
    metric = space.metric
    limits = np.array([space.lower, space.upper]) * metric
    trees = (
        _Tree([start * metric], step, limits),
        _Tree([np.asarray(goal) * metric for goal in goals], step, limits),
    )

    def straight(here: FloatArray, target: FloatArray, longest: float) -> Sequence[FloatArray]:
        distance = space.distance(here, target)
        there = target if distance <= longest else here + longest / distance * (target - here)
        return [there] if request.is_edge_free(here, there) else []

    def scaled(here: FloatArray, target: FloatArray, longest: float) -> list[FloatArray]:
        way = (extend or straight)(here / metric, target / metric, longest)
        return [state * metric for state in way]

    def outcome(path: FloatArray | None) -> PathResult:
        count = trees[0].count + trees[1].count
        return PathResult(path, count, 0.0 if path is not None else _gap(*trees))

    for goal in goals:
        met = trees[0].connect(np.asarray(goal) * metric, scaled, math.inf)
        if met is not None:
            way = trees[0].branch(met)[-2::-1] / metric
            return outcome(_ending_exactly(np.vstack([start, way if met else goal]), goals))
    samples = _Samples(space.dof, 1 + request.seed % 1_000_003)
    growing = blocked = 0
    stalled = max(STALLED, STALLED_PER_CHECK * request.max_state_checks)
    while request.state_checks() < request.max_state_checks and blocked < stalled:
        if trees[growing].count > trees[1 - growing].count:
            growing = 1 - growing
        tree = trees[growing]
        vertex = tree.grow(tree.draw(samples), scaled)
        if vertex is None:
            blocked += 1
            continue
        blocked = 0
        other = trees[1 - growing]
        met = other.connect(trees[growing].points[vertex], scaled, step)
        if met is not None:
            halves = [trees[growing].branch(vertex), other.branch(met)]
            first, last = halves if growing == 0 else halves[::-1]
            path = np.vstack([first[::-1], last[1:]]) / metric
            path[0] = start
            return outcome(_ending_exactly(path, goals))
        growing = 1 - growing
    return outcome(None)


def step_length(planner_id: str, parameters: Mapping[str, float]) -> float:
    """Read the longest edge [rad], the only parameter of this planner.

    Raises:
        ValueError: The parameter is unknown, or its value is not a positive length.
    """
    for name in parameters:
        if name not in PARAMETERS:
            raise ValueError(
                f"planner {planner_id} has no parameter '{name}' (it has: {', '.join(PARAMETERS)})"
            )
    step = float(parameters.get("range", RANGE))
    if step <= 0:
        raise ValueError(f"planner parameter 'range' cannot be {step:g}; it is a distance [rad]")
    return step


def halton(first: int, count: int, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """Compute points of the Halton sequence in a box, from an index on, shape (count, dof)."""
    points = np.empty((count, len(lower)))
    for column, base in enumerate(_primes(len(lower))):
        index = np.arange(first, first + count)
        share, value = 1.0, np.zeros(count)
        while index.any():
            share /= base
            value += share * (index % base)
            index //= base
        points[:, column] = value
    return lower + (upper - lower) * points


def _primes(count: int) -> list[int]:
    found: list[int] = []
    number = 2
    while len(found) < count:
        if all(number % prime for prime in found):
            found.append(number)
        number += 1
    return found


class _Samples:
    """The Halton sequence in the unit cube, from an index on."""

    def __init__(self, dof: int, first: int) -> None:
        self._lower, self._upper = np.zeros(dof), np.ones(dof)
        self._first = first
        self._points: list[FloatArray] = []

    def next(self) -> FloatArray:
        """The next sample, shape (dof,)."""
        if not self._points:
            self._points = list(halton(self._first, _BLOCK, self._lower, self._upper)[::-1])
            self._first += _BLOCK
        return self._points.pop()


class _Tree:
    """Vertices in the scaled joint space, each with its parent and the length of its next edges."""

    def __init__(self, roots: Sequence[FloatArray], step: float, limits: FloatArray) -> None:
        self.points = np.empty((max(256, 2 * len(roots)), len(roots[0])))
        self.count = 0
        self._drawn = 0
        self._parents: list[int] = []
        self._steps: list[float] = []
        self._step = step
        self._limits = limits
        self._lower, self._upper = np.full_like(limits[0], np.inf), np.full_like(limits[0], -np.inf)
        for root in roots:
            self._add(root, -1)

    def _add(self, point: FloatArray, parent: int) -> int:
        if self.count == len(self.points):
            self.points = np.concatenate([self.points, np.empty_like(self.points)])
        self.points[self.count] = point
        self._parents.append(parent)
        self._steps.append(self._step)
        self._lower = np.minimum(self._lower, np.maximum(point - BEYOND, self._limits[0]))
        self._upper = np.maximum(self._upper, np.minimum(point + BEYOND, self._limits[1]))
        self.count += 1
        return self.count - 1

    def nearest(self, point: FloatArray) -> tuple[int, float]:
        """The vertex nearest to a point, and its distance [rad]."""
        away = self.points[: self.count] - point
        squares = np.einsum("ij,ij->i", away, away)
        index = int(squares.argmin())
        return index, math.sqrt(squares[index])

    def draw(self, samples: _Samples) -> FloatArray:
        """The next sample: in turn in the box about the tree, and around one of its vertices."""
        share = samples.next()
        self._drawn += 1
        if self._drawn % 2:
            return self._lower + (self._upper - self._lower) * share
        vertex = int(self._drawn * GOLDEN % 1.0 * self.count)
        around = self.points[vertex] + BEYOND * (2.0 * share - 1.0)
        return np.clip(around, *self._limits)

    def grow(self, sample: FloatArray, extend: Extend) -> int | None:
        """Extend from the nearest vertex towards a sample, by at most a step; None where blocked.

        Every blocked extension shortens the steps from its vertex a little, so that a tree leaves a
        place where no longer edge is free.
        """
        near, distance = self.nearest(sample)
        if distance < 1e-9:
            return None
        vertex = self._extended(near, sample, self._steps[near], extend)
        if vertex is None:
            self._steps[near] = max(SHORTER * self._steps[near], SHORTEST * self._step)
        return vertex

    def connect(self, point: FloatArray, extend: Extend, longest: float) -> int | None:
        """Extend step by step to a point of the other tree; the vertex that reaches it, or None."""
        vertex, distance = self.nearest(point)
        while distance > 1e-9:
            there = self._extended(vertex, point, longest, extend)
            if there is None:
                return None
            vertex, distance = there, math.dist(self.points[there], point)
        return vertex

    def _extended(
        self, vertex: int, target: FloatArray, longest: float, extend: Extend
    ) -> int | None:
        """Add the states on the way from a vertex towards a target; the last one, None if none."""
        way = extend(self.points[vertex], target, longest)
        for state in way:
            vertex = self._add(state, vertex)
        return vertex if way else None

    def branch(self, index: int) -> FloatArray:
        """Points from a vertex to its root, shape (K, dof)."""
        found = []
        while index >= 0:
            found.append(self.points[index])
            index = self._parents[index]
        return np.array(found)


def _gap(first: _Tree, second: _Tree) -> float:
    """The smallest distance between two trees [rad]."""
    points = second.points[: second.count]
    return float(
        min(np.min(np.sum((points - q) ** 2, axis=1)) for q in first.points[: first.count]) ** 0.5
    )


def _ending_exactly(path: FloatArray, goals: Sequence[FloatArray]) -> FloatArray:
    """The path with its last point set exactly to the goal that it reached."""
    away = [float(np.max(np.abs(path[-1] - goal))) for goal in goals]
    path[-1] = goals[int(np.argmin(away))]
    return path
