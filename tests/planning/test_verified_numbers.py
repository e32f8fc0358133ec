"""The limits of verification on both of their sides, with a trajectory of two joints."""

from dataclasses import dataclass, field, replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from harness.core.trajectory import JointTrajectory
from harness.planning.timing.limits import Limits
from harness.planning.verification.verify import (
    FINAL_RESOLUTION,
    VERIFIED_RESOLUTION,
    distances_to_path,
    find_defect,
    find_departure,
    path_collision,
)
from harness.recording.motion_failures import ConstraintFailure

N = 11
TIMES = np.arange(N) * 0.1
START, END = np.array([0.0, 1.0]), np.array([0.5, 1.0])
LIMITS = Limits.scaled(np.array([2.0, 1.0]), np.array([4.0, 3.0]), 1.0, 1.0)
SPACE = SimpleNamespace(
    wraps=np.array([True, True]),
    lower=np.array([-1.0, -2.0]), upper=np.array([0.5, 2.0]), joint_names=("one", "two"),
    metric=np.array([1.0, 3.0]),
)  # fmt: skip


@dataclass
class Checker:
    """A checker whose states are blocked where the first joint is beyond a value."""

    beyond: float = np.inf
    space: SimpleNamespace = field(default_factory=lambda: SPACE)
    verified: object = None

    def path_free(self, path, resolution):
        assert resolution == VERIFIED_RESOLUTION
        self.verified = path
        return bool(np.all(path[:, 0] <= self.beyond))

    def touches(self, _):
        return []

    def first_block(self, path, resolution):
        assert resolution == FINAL_RESOLUTION
        for row in np.flatnonzero(path[:, 0] > self.beyond)[:1]:
            share = (self.beyond - path[row - 1, 0]) / (path[row, 0] - path[row - 1, 0])
            return row - 1 + share, path[row - 1] + share * (path[row] - path[row - 1]), []
        return None


def moving():
    positions = START + np.linspace(0, 1, N)[:, None] * (END - START)
    return JointTrajectory(("one", "two"), TIMES, positions, np.zeros((N, 2)), np.zeros((N, 2)))


def defect(limits=LIMITS, checker=None, **arrays):
    """What is wrong with the trajectory once some of its numbers are others; None if nothing."""
    base = moving()
    for name, (place, value) in arrays.items():
        rows = np.array(getattr(base, name))
        rows[place] = value
        base = replace(base, **{name: rows})
    return find_defect(base, checker or Checker(), START, END, limits)


@pytest.mark.parametrize(
    ("what", "row", "joint", "fits", "exceeds"),
    [
        ("positions", 3, 0, -1.0 - 0.9e-9, -1.0 - 2e-9),
        ("positions", 3, 1, 2.0 + 0.9e-9, 2.0 + 2e-9),
        ("velocities", 3, 0, 2.0 * 1.0009, 2.0 * 1.0011),
        ("velocities", 4, 1, -1.0 * 1.0009, -1.0 * 1.0011),
        ("accelerations", 5, 0, -4.0 * 1.0009, -4.0 * 1.0011),
        ("accelerations", 0, 1, 3.0 * 1.0009, 3.0 * 1.0011),
    ],
)
def test_limits_may_be_exceeded_by_rounding_and_a_thousandth(what, row, joint, fits, exceeds):
    assert defect(**{what: ((row, joint), fits)}) is None
    found = defect(**{what: ((row, joint), exceeds)})
    kind = {"positions": "position", "velocities": "velocity", "accelerations": "acceleration"}
    record = found.details.plain()
    assert record["broken"] == f"{kind[what]} limit"
    assert record["joint"] == ("one", "two")[joint]
    assert record["time"] == pytest.approx(TIMES[row])
    assert 0 < record["excess"] < 1e-3
    assert f"{('one', 'two')[joint]} is beyond its" in found.message


def test_of_several_samples_beyond_a_limit_the_worst_is_named():
    found = defect(velocities=(slice(2, 5), [[0, 1.5], [2.3, 1.7], [0, 1.2]]))
    assert (found.details.plain()["joint"], found.details.plain()["time"]) == (
        "two",
        0.30000000000000004,
    )


@pytest.mark.parametrize("place", [0, -1])
def test_ends_may_be_a_millionth_off_and_must_be_at_rest(place):
    name = "start" if place == 0 else "end"
    expected = START if place == 0 else END
    for joint in (0, 1):
        for sign in (1, -1):
            shifted = expected[joint] + sign * np.array([0.9e-6, 1.1e-6])
            bounds = Checker(
                space=SimpleNamespace(**{**vars(SPACE), "upper": np.array([9.0, 9.0])})
            )
            assert defect(checker=bounds, positions=((place, joint), shifted[0])) is None
            found = defect(checker=bounds, positions=((place, joint), shifted[1]))
            assert found.details.plain()["broken"] == name
            assert found.details.plain()["distance"] == pytest.approx(1.1e-6)
            assert f"trajectory's {name} is 6.303e-05 deg of " in found.message
            assert defect(velocities=((place, joint), sign * 0.9e-9)) is None
            found = defect(velocities=((place, joint), sign * 1.1e-9))
            assert found.details.plain()["broken"] == f"rest at {name}"


@pytest.mark.parametrize(("place", "time"), [(0.2, "0.40"), (0.225, "0.45"), (0.24, None)])
def test_a_broken_constraint_is_dated_by_its_sample_or_the_middle_of_two(place, time):
    """The first joint is at 0.2 at 0.4 s and at 0.25 at 0.5 s; between them at 0.225."""
    record = ConstraintFailure(place, 0.0, 0.1)
    broken = SimpleNamespace(what="it is broken", record=record)

    def first_violation(states):
        rows = np.flatnonzero(np.abs(states[:, 0] - place) < 1e-9)
        return (int(rows[0]), broken) if len(rows) else None

    held = SimpleNamespace(first_violation=first_violation)
    found = find_defect(moving(), Checker(), START, END, LIMITS, held)
    assert (found is None) is (time is None)
    assert time is None or found.message == f"at {time} s it is broken"


def test_time_stamps_begin_at_zero_and_rise():
    for place, value in ((0, 1e-12), (0, -1e-12), (3, 0.2), (3, 0.19), (4, 0.5)):
        assert defect(times=(place, value)).details.plain()["broken"] == "stamps"
    assert defect(times=(3, 0.2001)) is None


def test_jerks_are_those_between_samples():
    """A change of 1 in 0.1 s is a jerk of 10."""
    limited = replace(LIMITS, jerk=10.0)
    for value, is_defect in ((1.0009, False), (-1.0009, False), (1.002, True), (-1.002, True)):
        found = defect(limited, accelerations=((slice(6, None), 1), value))
        assert (found is not None) == is_defect
    record = found.details.plain()
    assert (record["broken"], record["joint"]) == ("jerk limit", "two")
    assert record["time"] == pytest.approx(0.5)
    assert "two has a jerk of 10, of at most 10, at 0.500 s" in found.message
    assert defect(accelerations=((slice(6, None), 1), 2.9)) is None, "no limit, no rule"
    uneven = np.array([*TIMES[:6], 0.7, 0.8, 0.9, 1.0, 1.1])
    slower = {"times": (slice(None), uneven), "accelerations": ((slice(6, None), 1), 1.9)}
    assert defect(limited, **slower) is None


def test_the_commanded_samples_are_verified_as_they_are():
    checker = Checker()
    assert defect(checker=checker, positions=((5, 1), 1.2)) is None
    assert checker.verified.shape == (N, 2)
    assert checker.verified[5].tolist() == [0.25, 1.2]


def test_what_is_in_the_way_is_found_at_its_time_even_after_a_rest():
    found = defect(checker=Checker(beyond=0.2))
    assert found.details.plain()["broken"] == "collision"
    assert found.details.plain()["time"] == pytest.approx(0.4, abs=0.006)
    rest = moving().positions.copy()
    rest[3:7] = rest[3]
    found = defect(checker=Checker(beyond=0.2), positions=(slice(None), rest))
    assert found.details.plain()["time"] == pytest.approx(0.6 + 0.1 * 0.05 / 0.2, abs=0.006)


def test_distances_are_those_to_the_nearest_point_of_the_lines():
    rng = np.random.default_rng(3)
    waypoints = np.array([[0.0, 0], [1, 0], [1, 0], [1, 1], [0.2, 1.5]])
    points = rng.uniform(-1, 2, (40, 2))
    shares = np.linspace(0, 1, 4001)[:, None]
    along = np.concatenate([a + shares * (b - a) for a, b in pairwise(waypoints)])
    expected = np.linalg.norm(points[:, None] - along[None], axis=2).min(axis=1)
    assert distances_to_path(points, waypoints) == pytest.approx(expected, abs=1e-3)
    assert distances_to_path(waypoints, waypoints) == pytest.approx(0.0, abs=1e-12)


def test_a_departure_is_named_where_it_is_largest():
    waypoints = np.array([START, END])
    away = moving()
    for off, is_found in ((0.0100009, False), (0.010002, True)):
        positions = away.positions.copy()
        positions[4, 1] -= off
        positions[7, 1] += 0.009
        distances = distances_to_path(positions, waypoints)
        found = find_departure(replace(away, positions=positions), distances, 0.01)
        assert (found is not None) == is_found
    assert found.details.plain()["time"] == pytest.approx(0.4)
    assert found.details.plain()["path_deviation"] == pytest.approx(0.010002)


def test_a_path_without_times_is_blocked_at_its_first_edge_that_is():
    path = np.array([[0.0, 0.0], [1.0, 1.0], [3.0, 2.0]])
    assert path_collision(path, Checker()) is None
    found = path_collision(path, Checker(beyond=1.5))
    assert found.message.startswith("after 25 % of the path between waypoints 2 and 3 it would")
    assert found.details.plain()["joint_positions"] == [1.5, 1.25]
    found = path_collision(path[:2], Checker(beyond=0.5))
    assert found.message.startswith("after 50 % of the path it would")
