"""jerk: joints change their accelerations gently."""

import numpy as np
import pytest

from harness.plugins.smoothness.expectations.jerk import Jerk
from tests.judging import evidence_runs as shared
from tests.judging.evidence import Evidence, Free, Three
from tests.judging.synthetic_run import DT, make_run, verdict

TIMES = np.arange(shared.N) * DT


def of_speeds(speeds):
    """A run in which the shoulder has speeds."""
    return {"joint_velocities": np.column_stack([speeds, np.zeros(len(speeds))])}


def growing(jerk):
    """A run in which the shoulder's jerk grows evenly, to a value at the last sample."""
    return make_run(**of_speeds(jerk * TIMES**3 / (6 * (TIMES[-1] - DT))))


WAVE = 0.5 * (1 - np.cos(2 * np.pi * TIMES))  # accelerates by up to pi rad/s^2, within a second
EVIDENCE = Evidence(
    three_runs=(Three(Jerk(at_most=10), growing(9), growing(10.5), -0.5, "rad/s**3"),),
    mutation_cases=((Jerk(at_most=25), shared.late(**of_speeds(WAVE)), "late"),),
    free_shifts=(Free("fingers stop at what they grasp", "jerk", "joint_velocities", "+-finger"),),
)


def test_a_jerk_is_the_second_change_of_the_velocity_over_its_window():
    jump = make_run(**of_speeds(np.where(TIMES < 1, 0.0, 0.1)))
    for window in (0.01, 0.05):
        answer = verdict(jump, Jerk(at_most=1, window=window))
        assert answer.measures[0].value == pytest.approx(0.1 / window**2)
