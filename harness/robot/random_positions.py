"""Random joint positions of a whole robot."""

from __future__ import annotations

import numpy as np

from harness.core.types import FloatArray
from harness.robot.description import RobotDescription
from harness.robot.mechanism import Joint


def sample_robot_positions(
    description: RobotDescription, samples: int, rng: np.random.Generator
) -> FloatArray:
    """Joint positions inside the limits, mimic joints following, shape (samples, n).

    Turning joints are drawn from one turn at most, prismatic ones without limits from one metre.
    """
    ends = np.array([_ends(joint) for joint in description.movable_joints]).reshape(-1, 2)
    drawn = rng.uniform(ends[:, 0], ends[:, 1], size=(samples, len(ends)))
    return np.array([description.with_mimics(row) for row in drawn]).reshape(samples, len(ends))


def _ends(joint: Joint) -> tuple[float, float]:
    if joint.kind != "prismatic":
        lower, upper = np.clip([-np.pi, np.pi], joint.lower, joint.upper)
        return float(lower), float(upper)
    lower = joint.lower if np.isfinite(joint.lower) else -0.5
    return lower, joint.upper if np.isfinite(joint.upper) else lower + 1.0
