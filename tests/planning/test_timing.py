"""Trajectories from paths: limits kept, ends at rest, derivatives that belong together."""

from dataclasses import replace

import numpy as np
import pytest

from harness.planning.timing.profiles import (
    GRID,
    Trapezoid,
    cubic,
    quintic,
    smoothed,
    straight_curve,
)
from harness.planning.timing.timing import (
    BlendedPath,
    Limits,
    time_blended,
    time_stopping,
    time_straight,
)
from harness.simulation.set_points import sample_trajectory

NAMES = tuple("abcdef")
LIMITS = Limits.scaled(np.full(6, np.pi), np.full(6, 5.0), 0.3, 0.3)


def zigzag(seed, count=5):
    return np.cumsum(np.random.default_rng(seed).uniform(-1, 1, (count, 6)), axis=0)


def ways(seed):
    path = zigzag(seed)
    return {
        "straight": (path[:2], time_straight(NAMES, path[0], path[1], LIMITS)),
        "toppra": (path, time_blended(NAMES, BlendedPath(path, 0.05), LIMITS)),
        "stopping": (path, time_stopping(NAMES, path, LIMITS)),
    }


@pytest.mark.parametrize("seed", [1, 2])
def test_limits_are_kept_and_used_and_the_ends_rest(seed):
    for path, trajectory in ways(seed).values():
        speed = np.abs(trajectory.velocities / LIMITS.velocity).max()
        push = np.abs(trajectory.accelerations / LIMITS.acceleration).max()
        assert max(speed, push) <= 1.0 + 1e-9
        assert max(speed, push) > 0.98
        assert np.all(np.diff(trajectory.times) > 0)
        assert np.allclose(trajectory.positions[[0, -1]], path[[0, -1]], atol=1e-9)
        assert np.all(trajectory.velocities[[0, -1]] == 0)
        assert trajectory.duration / GRID == pytest.approx(round(trajectory.duration / GRID))


@pytest.mark.parametrize("seed", [1, 2])
def test_velocities_are_the_derivative_of_positions(seed):
    """Against the mean velocity of each interval, which lies within what acceleration allows."""
    for _, trajectory in ways(seed).values():
        steps = np.diff(trajectory.times)[:, None]
        mean = np.diff(trajectory.positions, axis=0) / steps
        halfway = 0.5 * (trajectory.velocities[1:] + trajectory.velocities[:-1])
        assert np.abs(mean - halfway).max() < 1.5 * 0.01
        slope = np.diff(trajectory.velocities, axis=0) / steps
        assert np.abs(slope).max() <= 1.5 * (1 + 1e-3)


def test_a_blended_path_stays_near_its_corners_and_on_its_lines():
    path = zigzag(3)
    blended = BlendedPath(path, 0.02)
    positions, first, _ = blended.cubics.evaluate(np.linspace(0, blended.length, 2000))
    assert max(np.linalg.norm(positions - corner, axis=1).min() for corner in path) <= 0.02 + 1e-3
    assert np.abs(np.diff(first, axis=0)).max() < 0.2  # no jump of direction
    middle = 0.5 * (path[0] + path[1])
    assert np.linalg.norm(positions - middle, axis=1).min() < 2e-3


def test_a_trapezoid_covers_its_length_in_its_time():
    profile = Trapezoid.fastest(2.0, 0.5, 1.0)
    times = np.linspace(0, profile.duration, 4001)
    s, rate, change = profile(times)
    assert (s[0], s[-1]) == (0.0, pytest.approx(2.0))
    assert np.abs(np.gradient(s, times) - rate).max() < 1e-3
    assert rate.max() <= 0.5
    assert np.abs(change).max() <= 1.0


def test_a_cubic_takes_the_time_it_is_given():
    curve = straight_curve(np.zeros(2), np.array([1.0, -2.0]), cubic(4.0))
    positions, velocities, accelerations = curve(np.array([0.0, 2.0, 4.0]))
    assert np.allclose(positions, [[0, 0], [0.5, -1.0], [1.0, -2.0]])
    assert np.allclose(velocities, [[0, 0], [0.375, -0.75], [0, 0]])
    assert np.allclose(accelerations[0], [0.375, -0.75])


@pytest.mark.parametrize("jerk", [5.0, 60.0])
def test_a_jerk_limit_holds_between_samples_of_every_kind_of_motion(jerk):
    limits = replace(LIMITS, jerk=jerk)
    path = zigzag(1)
    for trajectory, without in (
        (time_straight(NAMES, path[0], path[1], limits), ways(1)["straight"][1]),
        (time_blended(NAMES, BlendedPath(path, 0.05), limits), ways(1)["toppra"][1]),
    ):
        changes = np.diff(trajectory.accelerations, axis=0) / np.diff(trajectory.times)[:, None]
        assert np.abs(changes).max() <= jerk * (1 + 1e-6)
        assert np.abs(changes).max() > 0.5 * jerk
        assert np.abs(trajectory.velocities / limits.velocity).max() <= 1 + 1e-9
        assert np.abs(trajectory.accelerations / limits.acceleration).max() <= 1 + 1e-9
        assert np.allclose(trajectory.positions[[0, -1]], without.positions[[0, -1]], atol=1e-9)
        assert trajectory.duration > without.duration


def test_a_short_way_under_a_jerk_limit_takes_what_four_equal_phases_take():
    """Jerk up, down, down, up, a quarter of the time each: (32 d / j)^(1/3)."""
    way = np.array([0.01, 0, 0, 0, 0, 0])
    trajectory = time_straight(NAMES, np.zeros(6), way, replace(LIMITS, jerk=5.0))
    assert trajectory.duration == pytest.approx((32 * 0.01 / 5.0) ** (1 / 3), abs=GRID)


def test_a_quintic_begins_and_ends_without_acceleration():
    curve = straight_curve(np.zeros(1), np.ones(1), quintic(2.0))
    times = np.linspace(0.0, 2.0, 2001)
    positions, velocities, accelerations = curve(times)
    assert np.allclose(positions[[0, 1000, -1], 0], [0, 0.5, 1])
    assert np.abs(np.gradient(positions[:, 0], times) - velocities[:, 0]).max() < 1e-3
    assert np.abs(np.gradient(velocities[:, 0], times) - accelerations[:, 0]).max() < 1e-2
    assert np.allclose(accelerations[[0, -1]], 0)
    assert velocities.max() == pytest.approx(15 / 8 / 2)
    assert accelerations.max() == pytest.approx(10 / np.sqrt(3) / 4, rel=1e-5)


def test_a_smoothed_curve_is_its_running_mean():
    profile = Trapezoid.fastest(1.0, 0.5, 1.0)
    curve = straight_curve(np.zeros(1), np.ones(1), profile)
    mean = smoothed(curve, profile.duration, 0.2)
    fine = np.linspace(-0.2, profile.duration + 0.2, 200001)
    values = curve(np.clip(fine, 0, profile.duration))[0][:, 0]
    for time in (0.05, 0.3, 1.0, profile.duration + 0.1):
        window = (fine >= time - 0.2) & (fine <= time)
        assert mean(np.array([time]))[0][0, 0] == pytest.approx(values[window].mean(), abs=1e-5)


@pytest.mark.parametrize("scaling", [1.0, 0.9, 0.3])
@pytest.mark.parametrize("count", [2, 3, 6])
def test_commands_between_set_points_keep_the_joints_accelerations(scaling, count):
    """The simulator interpolates the set points by cubics at every physics step."""
    rng = np.random.default_rng(count)
    joints = np.array([5.0, 3.0, 5.0, 8.0, 5.0, 2.0])
    limits = Limits.scaled(np.full(6, np.pi), joints, scaling, scaling)
    for _ in range(5):
        waypoints = rng.uniform(-1.0, 1.0, (count, 6))
        if count == 2:
            trajectory = time_straight(NAMES, *waypoints, limits)
        else:
            trajectory = time_blended(NAMES, BlendedPath(waypoints, 0.05), limits)
        commands = sample_trajectory(trajectory, 0.001)
        assert (np.abs(commands.accelerations) <= joints * (1 + 1e-6)).all()
        changes = np.abs(np.diff(commands.velocities, axis=0)) / 0.001
        assert (changes <= joints * (1 + 1e-6)).all()


def test_a_scaled_motion_whose_commands_keep_the_limits_is_not_slowed():
    waypoints = np.array([np.zeros(6), np.full(6, 0.7), np.linspace(0, 1, 6)])
    scaled = Limits.scaled(np.full(6, np.pi), np.full(6, 5.0), 0.3, 0.3)
    free = replace(scaled, commanded=np.full_like(scaled.acceleration, np.inf))
    for limits in (scaled, free):
        assert time_blended(NAMES, BlendedPath(waypoints, 0.05), limits).duration == pytest.approx(
            time_blended(NAMES, BlendedPath(waypoints, 0.05), scaled).duration, abs=0
        )
