"""A planned motion that is shown before anything moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.core.errors import StepFailed
from harness.core.trajectory import path_length
from harness.core.types import FloatArray
from harness.ports.motion_planning import MotionPlan
from harness.recording.plan_statistics import PlanStatistics
from harness.recording.step_record import StepRecord
from harness.studio.live_cell import LiveCell

MOST_POINTS = 120
"""Points of a drawn path."""


@dataclass(frozen=True, eq=False)
class Preview:
    """A motion as it would be executed, or why there is none.

    Attributes:
        positions: Joint positions along it, description order, shape (N, n); None without one.
        tcp_path: Positions of the TCP along it, shape (N, 3).
        duration: The time it takes [s].
        length: The length of the path of the TCP [m].
        planner: The name of the planner.
        record: The failed step; None where there is a motion.
    """

    positions: FloatArray | None
    tcp_path: FloatArray | None
    duration: float = 0.0
    length: float = 0.0
    planner: str = ""
    record: StepRecord | None = None


def preview(cell: LiveCell, text: str) -> Preview:
    """Plan the motion of a step with the options and the seed that its execution has.

    Raises:
        SpecError: The step has a mistake.
    """
    plans: list[MotionPlan] = []

    def keep(plan: MotionPlan) -> None:
        plans.append(plan)
        raise StepFailed("PREEMPTED", "it is only planned")

    record = cell.planned_only(text, keep)
    if not plans:
        return Preview(None, None, record=record)
    plan = plans[0]
    description, trajectory = cell.description, plan.trajectory
    count = len(trajectory.positions)
    drawn = np.unique(np.linspace(0, count - 1, MOST_POINTS).astype(int))
    rows = np.repeat(cell.cell.planning_start()[None], len(drawn), axis=0)
    index = [description.joint_index[name] for name in trajectory.joint_names]
    rows[:, index] = trajectory.positions[drawn]
    positions = np.array([description.with_mimics(row) for row in rows])
    path = cell.prepared.kinematics.link_poses(positions, [description.tcp_link])[:, 0, :3]
    length = path_length(path)
    statistics = plan.statistics.find(PlanStatistics)
    planner = "" if statistics is None else statistics.planner_id
    return Preview(positions, path, trajectory.duration, length, planner)
