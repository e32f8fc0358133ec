"""The profile under a jerk limit is Ruckig's, the fastest one, and keeps its limits."""

# pyright: reportAttributeAccessIssue=false

import numpy as np
import pytest

from harness.planning.timing.profiles import GRID, JerkLimited

ruckig = pytest.importorskip("ruckig", reason="it has no wheel for this platform")


def drawn(seed):
    """Limits of rate, acceleration and jerk, each over five orders of magnitude."""
    return 10 ** np.random.default_rng(seed).uniform(-2, 3, 3)


def fastest_duration(velocity, acceleration, jerk):
    problem = ruckig.InputParameter(1)
    problem.current_position, problem.target_position = [0.0], [1.0]
    problem.max_velocity, problem.max_acceleration = [velocity], [acceleration]
    problem.max_jerk = [jerk]
    found = ruckig.Trajectory(1)
    assert ruckig.Ruckig(1).calculate(problem, found) == ruckig.Result.Working
    return found.duration


def test_the_duration_is_ruckigs_on_the_next_grid_point():
    for seed in range(500):
        limits = drawn(seed)
        shortest = fastest_duration(*limits)
        found = JerkLimited.fastest(*limits).duration
        assert shortest * (1 - 1e-9) - 1e-9 <= found <= shortest * (1 + 1e-9) + GRID, seed


@pytest.mark.parametrize("seed", range(30))
def test_the_profile_moves_from_rest_to_rest_within_its_limits(seed):
    velocity, acceleration, jerk = drawn(seed)
    profile = JerkLimited.fastest(velocity, acceleration, jerk)
    times = np.linspace(0.0, profile.duration, 20001)
    s, rate, change = profile(times)
    assert [s[0], rate[0], change[0]] == [0.0, 0.0, 0.0]
    assert s[-1] == pytest.approx(1.0, abs=1e-9)
    assert abs(rate[-1]) <= 1e-9 * rate.max()
    assert abs(change[-1]) <= 1e-9 * change.max()
    assert np.all(np.diff(s) >= -1e-12)
    assert rate.max() <= velocity * (1 + 1e-9)
    assert np.abs(change).max() <= acceleration * (1 + 1e-9)
    step = times[1]
    assert np.abs(np.diff(change)).max() / step <= jerk * (1 + 1e-6)
    means = (rate[1:] + rate[:-1]) / 2
    assert np.abs(np.diff(s) / step - means).max() <= 1e-3 * rate.max()


@pytest.mark.parametrize(
    ("limits", "phases"),
    [
        ((0.5, 1.0, 100.0), "every phase"),
        ((0.01, 100.0, 1.0), "no constant acceleration"),
        ((100.0, 1.0, 100.0), "no constant rate"),
        ((100.0, 100.0, 1.0), "neither"),
    ],
)
def test_phases_that_the_limits_leave_no_room_for_last_no_time(limits, phases):
    lengths = np.diff(JerkLimited.fastest(*limits).knots)
    assert (lengths[1] > 1e-9) == (phases in {"every phase", "no constant rate"})
    assert (lengths[3] > 1e-9) == (phases in {"every phase", "no constant acceleration"})
