"""Plans motions whose link must be at a pose at each moment, as next to what moves by itself."""

from __future__ import annotations

import numpy as np

from harness.core.details import Details
from harness.core.errors import PlanningFailed
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.planning.ik.numeric import LinkTask
from harness.planning.ik.task import part_of_pose
from harness.planning.task import PlanningTask
from harness.planning.timing.cubic_spline import CubicSpline
from harness.planning.timing.profiles import SAMPLE_PERIOD
from harness.ports.motion_planning import MotionPlan
from harness.ports.motions import TimedLinkMotion
from harness.recording.motion_failures import TraceFailure

SOLVED = 1e-6  # Largest error of a solved pose [m, rad]


def plan_timed_link(task: PlanningTask, motion: TimedLinkMotion) -> MotionPlan:
    """A verified motion of the group that has the link at each pose in time.

    Raises:
        PlanningFailed: NO_IK_SOLUTION, when the arm does not reach a pose; INVALID_MOTION_PLAN,
            when a joint would be too fast, or a state is not free.
    """
    count = max(2, round(motion.duration / SAMPLE_PERIOD))
    times: FloatArray = np.linspace(0.0, motion.duration, count + 1)
    positions = [task.start]
    for time in times[1:].tolist():
        goal = part_of_pose(task.space.task_space, motion.link, motion.pose_at(time))
        guess = 2 * positions[-1] - positions[-2] if len(positions) > 1 else positions[-1]
        found, error = LinkTask(task.space, goal).polish(guess, iterations=20)
        if error > SOLVED:
            raise PlanningFailed(
                "NO_IK_SOLUTION",
                f"the arm does not reach where {motion.link} must be after {time:.2f} s: it is"
                f" {1e3 * error:.1f} mm (or mrad) short",
                TraceFailure("unreachable", residual=error),
            )
        positions.append(found)
    path = np.array(positions)
    if task.options.path_only:
        return task.jump(path[-1], task.lowered_margins, Details())
    _, velocities, accelerations = CubicSpline.through(times, path).evaluate(times)
    velocities[[0, -1]] = 0.0
    names = task.space.joint_names
    trajectory = JointTrajectory(names, times, path, velocities, accelerations)
    task.accept(trajectory, path[-1], "the motion with the object")
    statistics = task.statistics("timed link", trajectory, path)
    return MotionPlan(trajectory, Details.of(statistics), task.lowered_margins)
