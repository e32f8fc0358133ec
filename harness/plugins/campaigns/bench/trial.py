"""One plan of one motion by one planner with one seed, and its measurements."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

import numpy as np

from harness.core.errors import PlanningFailed
from harness.core.trajectory import path_length
from harness.core.types import FloatArray
from harness.planning.collision.scene import CoalScene
from harness.ports.motion_planning import MotionPlanner, MotionRequest
from harness.recording.motion_failures import SearchFailure
from harness.recording.plan_statistics import DIRECT, PlanStatistics

SPACING = 0.05  # [rad], between the states at which smoothness and clearance are measured
STRAIGHT_TURN = 1e-6  # turns below this are rounding errors [rad]


@dataclass(frozen=True)
class Trial:
    """The result of one planning attempt.

    Attributes:
        planner: The planner's name, as `with_planner` takes it.
        seed: Seed of the scenario; `harness run --seed` plans the same motion.
        error_code: Code of the failure; empty when planning succeeded.
        state_checks: States checked for collision, including shortening and verification.
        path_length: Joint-space length of the motion [rad]; NaN when planning failed.
        duration: Duration of the motion [s].
        smoothness: Mean of (2 turn)^2 [rad^2], the turn between steps of `SPACING`; 0 is straight.
        clearance: Smallest distance of the robot and what it holds to any object [m].
        mean_clearance: Mean of that distance along the motion [m].
        planning_time: CPU time of the process [s], for information only; NaN when planning failed.
        is_straight: Whether no search was needed.
        message: Why planning failed, as a run reports it; empty when it succeeded.
    """

    planner: str
    seed: int
    error_code: str
    state_checks: int
    path_length: float = float("nan")
    duration: float = float("nan")
    smoothness: float = float("nan")
    clearance: float = float("nan")
    mean_clearance: float = float("nan")
    planning_time: float = field(default=float("nan"), compare=False)
    is_straight: bool = False
    message: str = ""

    @property
    def is_solved(self) -> bool:
        """Whether planning found a motion."""
        return not self.error_code


def try_plan(
    planner: MotionPlanner, scene: CoalScene, request: MotionRequest, name: str, seed: int
) -> Trial:
    """Plan once, and measure the result.

    Args:
        scene: The planning scene at the start of the motion.
        request: The motion; its options name the planner and hold the step's seed.
    """
    begin = time.process_time()
    try:
        plan = planner.plan(request)
    except PlanningFailed as failure:
        search = failure.details.find(SearchFailure)
        checks = 0 if search is None else search.state_checks
        return Trial(name, seed, failure.code, checks, message=failure.message)
    spent = time.process_time() - begin
    path = even(plan.trajectory.positions)
    nearest = _clearances(scene, request.group, request.start, path)
    statistics = plan.statistics.find(PlanStatistics)
    assert statistics is not None
    return Trial(
        name,
        seed,
        "",
        statistics.state_checks,
        path_length=path_length(plan.trajectory.positions),
        duration=plan.trajectory.duration,
        smoothness=smoothness(path),
        clearance=float(nearest.min()) if len(nearest) else float("nan"),
        mean_clearance=float(nearest.mean()) if len(nearest) else float("nan"),
        planning_time=spent,
        is_straight=statistics.planner_id == DIRECT,
    )


def even(positions: FloatArray) -> FloatArray:
    """Rows at even joint-space distances of about `SPACING` along a path, its ends included."""
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    moving = np.concatenate([[True], steps > 1e-12])
    travelled = np.concatenate([[0.0], np.cumsum(steps)])
    count = max(1, round(float(travelled[-1]) / SPACING))
    places = np.linspace(0.0, travelled[-1], count + 1)
    return np.column_stack(
        [np.interp(places, travelled[moving], column[moving]) for column in positions.T]
    )


def smoothness(path: FloatArray) -> float:
    """Mean of (2 turn)^2 over the inner rows of an even path [rad^2]; moveit_ros_benchmarks' sum.

    MoveIt divides by the number of waypoints too; here they are made even first, so that the number
    does not depend on how a planner spaces them.
    """
    steps = np.diff(path, axis=0)
    norms = np.linalg.norm(steps, axis=1)
    if len(steps) < 2 or np.any(norms < 1e-12):
        return 0.0
    cosines = np.sum(steps[1:] * steps[:-1], axis=1) / (norms[1:] * norms[:-1])
    turns = np.arccos(np.clip(cosines, -1.0, 1.0))
    turns[turns < STRAIGHT_TURN] = 0.0
    return float(np.mean((2 * turns) ** 2))


def _clearances(scene: CoalScene, group: str, start: FloatArray, path: FloatArray) -> FloatArray:
    """Smallest distance to an object at every row of a path; empty without objects."""
    state = np.array(start, dtype=float)
    indices = list(scene.description.group_indices(group))
    nearest: list[float] = []
    for positions in path:
        state[indices] = positions
        whole = scene.description.with_mimics(state)
        found = [touch.distance for touch, padded in scene.distances(whole) if padded]
        nearest += found[:1]
    return np.array(nearest)
