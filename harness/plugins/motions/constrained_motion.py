"""Finds motions that satisfy path constraints, with two trees whose steps are projected."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.core.details import Details
from harness.core.errors import PlanningFailed
from harness.core.trajectory import JointTrajectory, path_length
from harness.core.types import FloatArray
from harness.planning.search.balanced_connect import search_connect
from harness.planning.search.planner_names import FAST_PLANNER
from harness.planning.search.shortening import find_shortcut, path_knots, without_repetitions
from harness.planning.task import PlanningTask
from harness.planning.timing.limits import TimingError
from harness.planning.timing.timing import time_stopping, time_straight
from harness.planning.verification.verify import FINAL_RESOLUTION, VERIFIED_RESOLUTION, Defect
from harness.plugins.motions.curve_timing import RatedCurve, time_curve
from harness.plugins.motions.held_constraints import PathBands
from harness.plugins.motions.joint_spline import JointSpline
from harness.ports.motion_planning import MotionPlan
from harness.ports.path_planning import PathRequest, PathResult
from harness.recording.motion_failures import SearchFailure
from harness.recording.plan_statistics import DIRECT, SearchStatistics

PLANNER_ID = f"{FAST_PLANNER}, projected"

LONGEST_STEP = 0.2
"""Largest distance between adjacent states of a tree [rad]; smaller for narrow tolerances."""

RESOLUTIONS = (FINAL_RESOLUTION, FINAL_RESOLUTION / 2, VERIFIED_RESOLUTION)
"""Distances between checked states during a search [rad]; finer after a path has failed."""

CHECKS_PER_VALUE = 20
"""State checks that take as long as evaluating the constraints at one state does."""

_LEAST_STEP = 0.01  # [rad] shortest chord that is tried
_SHORTCUTS = 10  # random chords that are tried in one pass
_SMOOTHINGS = 4  # passes over all points

WORTH = 0.01  # Share of the path that a shortcut must be able to save


def find_constrained_motion(
    task: PlanningTask,
    held: PathBands,
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
        TimingError: The arm cannot stand still where it starts, or at any goal.

    References:
        D. Berenson, S. Srinivasa, D. Ferguson, J. Kuffner, "Manipulation planning on constraint
        manifolds", ICRA 2009: CBiRRT.
    """
    names = task.space.joint_names
    goals = task.can_stand(goals)
    for end in goals:
        ends = np.array([task.start, end])
        is_free = task.checker.edge_free(task.start, end, FINAL_RESOLUTION)
        is_free = is_free and held.hold_between(task.start, end, 4 * FINAL_RESOLUTION)
        if is_free and task.overload(ends) is None:
            trajectory = time_straight(names, task.start, end, task.limits)
            if task.defect(trajectory, end) is None:
                statistics = task.statistics(DIRECT, trajectory, [task.start, end])
                return MotionPlan(trajectory, Details.of(statistics), explanation)
    defect: Defect | None = None
    for attempt in range(task.options.attempts):
        budget_end = _spent(task, held) + task.options.max_state_checks
        for level, resolution in enumerate(RESOLUTIONS):
            seeds = np.random.SeedSequence([task.options.seed % 2**63, attempt, level])
            search = _Search(task, held, seeds, resolution, budget_end)
            found = search.connect(goals)
            if found.waypoints is None:
                break
            short = search.smooth(search.shorten(found.waypoints))
            timed = _timed(task, short, with_stops=resolution == RESOLUTIONS[-1])
            if isinstance(timed, JointTrajectory):
                statistics = task.statistics(PLANNER_ID, timed, short, found.waypoints)
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
        SearchFailure(_spent(task, held)),
    )


def _timed(task: PlanningTask, path: FloatArray, *, with_stops: bool) -> JointTrajectory | Defect:
    """Time the path as a smooth curve; with stops, otherwise as a polyline at rest at corners."""
    names, end = task.space.joint_names, path[-1]
    overload = task.overload(path)
    if overload is not None:
        return overload
    spline = JointSpline(path)
    curve = RatedCurve(spline, "", [None] * len(spline.knots))
    try:
        trajectory = time_curve(curve, names, task.space, task.limits)
    except TimingError as problem:
        defect = Defect(str(problem), problem.details)
    else:
        defect = task.defect(trajectory, end)
        if defect is None:
            return trajectory
    if not with_stops:
        return defect
    trajectory = time_stopping(names, path, task.limits)
    return task.defect(trajectory, end) or trajectory


def _spent(task: PlanningTask, held: PathBands) -> int:
    return task.checker.checks + CHECKS_PER_VALUE * held.checks


class _Search:
    """A search of a path whose states are projected, with checks at one resolution."""

    def __init__(
        self,
        task: PlanningTask,
        held: PathBands,
        seeds: np.random.SeedSequence,
        resolution: float,
        budget_end: int,
    ) -> None:
        self.task, self.held, self.resolution = task, held, resolution
        self.budget_end = budget_end
        self.seed = int(seeds.generate_state(1)[0])
        self.rng = np.random.default_rng(seeds)
        # a chord leaves a curve of radius 1 rad by an eighth of its length squared
        step = float(np.clip(np.sqrt(held.narrowest), _LEAST_STEP, LONGEST_STEP))
        self.step = step * resolution / RESOLUTIONS[0] if resolution > 1e-4 else step / 4

    @property
    def checks(self) -> int:
        """What the planning call has used up of its budget."""
        return _spent(self.task, self.held)

    def connect(self, goals: Sequence[FloatArray]) -> PathResult:
        """Grow a tree from the start and one from the goals until they meet."""
        checker, before = self.task.checker, self.checks
        request = PathRequest(
            planner_id=FAST_PLANNER,
            space=self.task.space,
            start=self.task.start,
            goals=tuple(goals),
            is_state_free=checker.state_free,
            is_edge_free=self._passable,
            state_checks=lambda: self.checks - before,
            max_state_checks=self.budget_end - before,
            resolution=self.resolution,
            seed=self.seed,
            parameters={},
        )
        return search_connect(request, self.extend)

    def extend(self, here: FloatArray, target: FloatArray, longest: float) -> list[FloatArray]:
        """Free states that satisfy the constraints, towards a target.

        There is one where the straight line satisfies them, or else one every step.
        """
        space, found, travelled = self.task.space, list[FloatArray](), 0.0
        left = space.distance(here, target)
        there = target if left <= longest else here + longest / left * (target - here)
        if self.held.are_inside(here, there, 0.5 * self.step):
            return [there] if self._passable(here, there) else []
        while left > 1e-9 and travelled < longest and self.checks < self.budget_end:
            new: FloatArray | None = target
            if left > self.step:
                new = self.held.project(here + (target - here) * (self.step / left))
            elif not self.held.hold(target):
                new = self.held.project(target)
            if new is None:
                break
            rest, moved = space.distance(new, target), space.distance(here, new)
            is_nearer = rest < left - 0.1 * self.step or rest < 1e-9
            if not is_nearer or moved > 2 * self.step or not self._passable(here, new):
                break
            found.append(new)
            here, left, travelled = new, rest, travelled + moved
        return found

    def _passable(self, first: FloatArray, second: FloatArray) -> bool:
        return self.task.checker.edge_free(first, second, self.resolution)

    def shorten(self, path: FloatArray) -> FloatArray:
        """Replace parts of a path by shorter ways between their ends."""
        for places in np.sort(self.rng.random((_SHORTCUTS, 2))).tolist():
            knots = path_knots(path)
            shortcut = find_shortcut(path, knots, places, WORTH)
            if shortcut is None:
                continue
            before, here, there, after = shortcut
            length = (places[1] - places[0]) * knots[-1]
            way = np.array([here, *self.extend(here, there, length)])
            is_there = self.task.space.distance(way[-1], there) < 1e-9
            if is_there and path_length(way) < length:
                path = without_repetitions(np.vstack([path[:before], way, path[after:]]))
        return path

    def smooth(self, path: FloatArray) -> FloatArray:
        """Round the corners of a path state by state, where the way through it stays free."""
        points = list(_resampled(path, self.step))
        for _ in range(_SMOOTHINGS):
            for index in range(1, len(points) - 1):
                before, here, after = points[index - 1 : index + 2]
                new = self.held.project(0.25 * before + 0.5 * here + 0.25 * after)
                if new is not None and self._passable(before, new) and self._passable(new, after):
                    points[index] = new
        return np.array(points)


def _resampled(path: FloatArray, step: float) -> FloatArray:
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    count = max(4, int(np.ceil(lengths[-1] / step)))
    places = np.linspace(0.0, lengths[-1], count + 1)
    return np.column_stack([np.interp(places, lengths, column) for column in path.T])
