"""Finds motions that satisfy path constraints, with two trees whose steps are projected."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from harness.core.details import Details
from harness.core.errors import PlanningFailed
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.cartesian.curve_timing import RatedCurve, time_curve
from harness.planning.ik.numeric import sample_group_positions
from harness.planning.task import PlanningTask
from harness.planning.timing.joint_spline import JointSpline
from harness.planning.timing.limits import TimingError
from harness.planning.timing.timing import time_stopping, time_straight
from harness.planning.verification.path_constraints import HeldConstraints
from harness.planning.verification.verify import (
    FINAL_RESOLUTION,
    VERIFIED_RESOLUTION,
    Defect,
)
from harness.ports.motion_planning import MotionPlan
from harness.recording.motion_failures import SearchFailure
from harness.recording.plan_statistics import SearchStatistics

PLANNER_ID = "RRTConnect, projected"

LONGEST_STEP = 0.1
"""Largest distance between adjacent states of a tree [rad]; smaller for narrow tolerances."""

RESOLUTIONS = (FINAL_RESOLUTION, FINAL_RESOLUTION / 2, VERIFIED_RESOLUTION)
"""Distances between checked states during a search [rad]; finer after a path has failed."""

_LEAST_STEP = 0.01
_SHORTCUTS = 60
_SMOOTHINGS = 8
_MOST_ROUNDS = 20_000


def find_constrained_motion(
    task: PlanningTask,
    held: HeldConstraints,
    goals: Sequence[FloatArray],
    explanation: Details,
) -> MotionPlan:
    """Plan a verified motion to a goal that satisfies the constraints at every sample.

    Args:
        task: The planning call; its verification checks the constraints too.
        held: The constraints; the start satisfies them.
        goals: Free group positions that satisfy the constraints, nearest first.
        explanation: The explanation of the goals.

    Raises:
        PlanningFailed: PLANNING_FAILED, when the budget is used up; INVALID_MOTION_PLAN, when no
            path passes verification after timing.

    References:
        D. Berenson, S. Srinivasa, D. Ferguson, J. Kuffner, "Manipulation planning on constraint
        manifolds", ICRA 2009: CBiRRT.
    """
    names = task.space.joint_names
    for end in goals:
        if held.hold_between(task.start, end, FINAL_RESOLUTION):
            trajectory = time_straight(names, task.start, end, task.limits)
            if task.defect(trajectory, end) is None:
                statistics = task.statistics("straight line", trajectory, [task.start, end])
                return MotionPlan(trajectory, Details.of(statistics), explanation)
    defect: Defect | None = None
    for attempt in range(task.options.attempts):
        for level, resolution in enumerate(RESOLUTIONS):
            rng = np.random.default_rng([task.options.seed % 2**63, attempt, level])
            search = _Search(task, held, rng, resolution)
            path = search.connect(goals)
            if path is None:
                break
            short = search.smooth(search.shorten(path))
            timed = _timed(task, short)
            if isinstance(timed, JointTrajectory):
                statistics = task.statistics(PLANNER_ID, timed, short, np.array(path))
                details = Details.of(statistics, SearchStatistics(attempt + 1))
                return MotionPlan(timed, details, explanation)
            defect = timed
    if defect is not None:
        raise PlanningFailed(
            "INVALID_MOTION_PLAN",
            "paths were found, but none passes verification: " + defect.message,
            *explanation,
            *defect.details,
        )
    raise PlanningFailed(
        "PLANNING_FAILED",
        "no free path that satisfies the constraints was found in at most "
        f"{task.options.max_state_checks} state checks",
        *explanation,
        SearchFailure(task.checker.checks + held.checks),
    )


def _timed(task: PlanningTask, path: FloatArray) -> JointTrajectory | Defect:
    """Time the path as a smooth curve, otherwise as a polyline with a stop at every corner."""
    names, end = task.space.joint_names, path[-1]
    spline = JointSpline(path)
    try:
        curve = RatedCurve(spline, "", [None] * len(spline.knots))
        trajectory = time_curve(curve, names, task.space, task.limits)
        if task.defect(trajectory, end) is None:
            return trajectory
    except TimingError:
        pass
    trajectory = time_stopping(names, path, task.limits)
    return task.defect(trajectory, end) or trajectory


@dataclass
class _Tree:
    nodes: list[FloatArray]
    parents: list[int]

    def nearest(self, positions: FloatArray, metric: FloatArray) -> int:
        """Index of the node nearest to group positions."""
        away = (np.array(self.nodes) - positions) * metric
        return int(np.argmin((away**2).sum(axis=1)))

    def branch(self, index: int) -> list[FloatArray]:
        """The states from the root to a node."""
        found: list[FloatArray] = []
        while index >= 0:
            found.append(self.nodes[index])
            index = self.parents[index]
        return found[::-1]


class _Search:
    def __init__(
        self,
        task: PlanningTask,
        held: HeldConstraints,
        rng: np.random.Generator,
        resolution: float,
    ) -> None:
        self.task, self.held, self.rng, self.resolution = task, held, rng, resolution
        # a chord leaves a curve of radius 1 rad by an eighth of its length squared
        self.step = float(np.clip(np.sqrt(held.narrowest), _LEAST_STEP, LONGEST_STEP))
        self._budget_end = self._spent + task.options.max_state_checks

    @property
    def _spent(self) -> int:
        return self.task.checker.checks + self.held.checks

    @property
    def _is_over(self) -> bool:
        return self._spent >= self._budget_end

    def connect(self, goals: Sequence[FloatArray]) -> list[FloatArray] | None:
        """Grow a tree from the start and one from the goals until they meet."""
        space, metric = self.task.space, self.task.space.metric
        first = _Tree([self.task.start], [-1])
        second = _Tree(list(goals), [-1] * len(goals))
        from_start = True
        for _ in range(_MOST_ROUNDS):
            if self._is_over:
                return None
            sample = sample_group_positions(space, self.rng)
            reached = self._extend(first, first.nearest(sample, metric), sample)
            target = first.nodes[reached]
            met = self._extend(second, second.nearest(target, metric), target)
            if space.distance(second.nodes[met], target) < 1e-9:
                branches = first.branch(reached), second.branch(met)
                forth, back = branches if from_start else branches[::-1]
                return [*forth, *back[::-1][1:]]
            first, second = second, first
            from_start = not from_start
        return None

    def _extend(self, tree: _Tree, index: int, target: FloatArray) -> int:
        """Extend a tree from a node towards a target as far as possible; the last node's index."""
        for positions in self._walk(tree.nodes[index], target):
            tree.nodes.append(positions)
            tree.parents.append(index)
            index = len(tree.nodes) - 1
        return index

    def _walk(self, start: FloatArray, target: FloatArray) -> list[FloatArray]:
        """Free states that satisfy the constraints, one step apart, towards a target."""
        space, here, found = self.task.space, start, list[FloatArray]()
        left = space.distance(here, target)
        while left > 1e-9 and not self._is_over:
            if left <= self.step:
                new: FloatArray | None = target
            else:
                new = self.held.project(here + (target - here) * (self.step / left))
            if new is None or not self._passable(here, new):
                break
            rest = space.distance(new, target)
            if rest > left - 0.1 * self.step and rest > 1e-9:
                break
            found.append(new)
            here, left = new, rest
        return found

    def _passable(self, first: FloatArray, second: FloatArray) -> bool:
        if self.task.space.distance(first, second) > 2 * self.step:
            return False
        return self.held.hold_between(first, second, self.step / 4) and (
            self.task.checker.edge_free(first, second, self.resolution)
        )

    def shorten(self, path: list[FloatArray]) -> list[FloatArray]:
        """Replace parts of a path by shorter walks between their ends."""
        space = self.task.space
        for _ in range(_SHORTCUTS):
            if len(path) < 4:
                break
            low, high = np.sort(self.rng.choice(len(path), 2, replace=False))
            if high - low < 2:
                continue
            walk = [path[low], *self._walk(path[low], path[high])]
            if space.distance(walk[-1], path[high]) > 1e-9:
                continue
            if _length(space.metric, walk) < _length(space.metric, path[low : high + 1]) - 1e-6:
                path = [*path[:low], *walk, *path[high + 1 :]]
        return path

    def smooth(self, path: list[FloatArray]) -> FloatArray:
        """Smooth the corners of a path and project every state again, while the path stays free."""
        points = list(_resampled(np.array(path), 0.5 * self.step))
        for _ in range(_SMOOTHINGS):
            middles = [points[0]]
            for before, here, after in zip(points, points[1:], points[2:], strict=False):
                middles.append(self.held.project(0.25 * before + 0.5 * here + 0.25 * after))
            middles.append(points[-1])
            if any(point is None for point in middles):
                break
            smoother = [point for point in middles if point is not None]
            if not all(self._passable(*edge) for edge in pairwise(smoother)):
                break
            points = smoother
        return np.array(points)


def _resampled(path: FloatArray, step: float) -> FloatArray:
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    count = max(4, int(np.ceil(lengths[-1] / step)))
    places = np.linspace(0.0, lengths[-1], count + 1)
    return np.column_stack([np.interp(places, lengths, column) for column in path.T])


def _length(metric: FloatArray, path: Sequence[FloatArray]) -> float:
    steps = np.diff(np.array(path), axis=0) * metric
    return float(np.linalg.norm(steps, axis=1).sum())
