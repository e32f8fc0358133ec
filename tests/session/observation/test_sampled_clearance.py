"""Which samples are measured, and what holds between them: small arrays, worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest

from harness.session.observation.sampled_clearance import (
    MOST_PARTS,
    around_smallest,
    between,
    inside_of,
    knots,
    largest_dip,
    nearest_measured,
    parts_of,
    parts_of_run,
)
from tests.judging.synthetic_run import BOX, TABLE, attachment

NAN = np.nan
MILLISECONDS = np.arange(101) * 0.001
EVERY_FIFTH = list(range(0, 101, 5))


def test_every_fifth_millisecond_is_measured_and_what_surrounds_a_change():
    assert knots(MILLISECONDS, (), ()).tolist() == EVERY_FIFTH
    assert knots(MILLISECONDS, (TABLE,), ()).tolist() == sorted({*EVERY_FIFTH, 1, 2, 99})
    assert knots(MILLISECONDS[:98], (), ()).tolist() == [*range(0, 96, 5), 97]
    come = replace(BOX, present=((0.033, 0.5),))
    assert knots(MILLISECONDS, (come,), ()).tolist() == sorted({*EVERY_FIFTH, 31, 32, 33, 34, 99})
    held = replace(attachment("box", 0, 0), start_time=0.001, end_time=0.051)
    around = {*range(4), *range(49, 54)}
    assert knots(MILLISECONDS, (), (held,)).tolist() == sorted({*EVERY_FIFTH, *around})
    slow = np.arange(5) * 0.02
    assert knots(slow, (), ()).tolist() == [0, 1, 2, 3, 4]
    assert knots(slow[:1], (), ()).tolist() == [0]


def test_a_run_is_measured_in_parts_of_five_seconds_that_share_a_sample():
    times = np.arange(1201) * 0.01
    samples = np.arange(0, 1201, 10)
    parts = parts_of_run(times, samples)
    assert [(part[0], part[-1]) for part in parts] == [(0, 500 * 2), (1000, 1200)]
    exact = parts_of_run(times[:1001], np.arange(0, 1001, 10))
    assert [(part[0], part[-1]) for part in exact] == [(0, 1000)]
    assert [part.tolist() for part in parts_of_run(times[:1], np.array([0]))] == [[0]]


def test_around_the_smallest_value_of_each_pair_every_sample_is_measured():
    samples = np.array([0, 5, 10, 15, 20])

    def around(*values):
        rows = {("a", str(place)): np.array(row) for place, row in enumerate(values)}
        return around_smallest(rows, samples, 21).tolist()

    assert around([3.0, 2, 1, 2, 3]) == list(range(5, 16))
    assert around([0.0, 2, 1, 2, 3]) == list(range(6))
    assert around([3.0, 2, 1, 2, 0]) == list(range(15, 21))
    assert around([NAN, 2, 1, NAN, 3]) == list(range(5, 16))
    assert around([NAN] * 5) == []
    assert around([0.0, 2, 1, 2, 3], [NAN] * 5, [3.0, 2, 1, 2, 0]) == [*range(6), *range(15, 21)]


def test_the_largest_dip_is_that_of_any_pair():
    dips = {("a", "b"): np.array([1.0, 5.0]), ("a", "c"): np.array([2.0, 3.0])}
    assert largest_dip(dips).tolist() == [2.0, 5.0]
    assert largest_dip({}).tolist() == []


def test_chosen_intervals_are_filled_with_their_samples():
    samples = np.array([0, 3, 5, 9])
    assert inside_of(samples, np.array([True, False, True])).tolist() == [0, 1, 2, 3, 5, 6, 7, 8, 9]
    none = inside_of(samples, np.zeros(3, dtype=bool))
    assert (none.tolist(), none.dtype) == ([], np.dtype(np.int64))


def test_positions_between_two_samples_divide_what_a_dip_could_be():
    owners, shares = parts_of(np.array([4, 7, 9]), np.array([0.0, 0.0021, 0.0061]), 20)
    assert owners.tolist() == [4, 7, 7, 9, 9, 9, 9]
    assert shares == pytest.approx([1 / 2, 1 / 3, 2 / 3, 1 / 5, 2 / 5, 3 / 5, 4 / 5])
    owners, shares = parts_of(np.array([1]), np.array([9.0]), 2)
    assert len(owners) == MOST_PARTS
    assert shares[[0, -1]] == pytest.approx([1 / (MOST_PARTS + 1), MOST_PARTS / (MOST_PARTS + 1)])


@pytest.mark.parametrize("count", [3000, 30_000])
def test_positions_between_samples_are_as_many_as_the_samples_where_everything_jumps(count):
    """Every joint jumps by a metre from each sample to the next; a few hundred samples may."""
    every = np.arange(count - 1)
    owners, shares = parts_of(every, np.full(count - 1, 1.0), count)
    assert len(owners) == len(shares) <= 10 * count
    assert np.bincount(owners, minlength=count - 1).min() >= 5
    owners, _ = parts_of(every[:50], np.full(50, 1.0), count)
    assert len(owners) == 50 * MOST_PARTS


def test_distances_are_linear_between_measured_samples_and_unknown_next_to_a_missing_one():
    samples = np.array([0, 4, 6, 8])
    whole = between(samples, np.array([0.0, 4.0, 2.0, 3.0]), 9)
    assert whole.tolist() == [0, 1, 2, 3, 4, 3, 2, 2.5, 3]
    holed = between(samples, np.array([0.0, 4.0, NAN, 3.0]), 9)
    assert holed[[0, 1, 2, 3, 4, 8]].tolist() == [0, 1, 2, 3, 4, 3]
    assert np.isnan(holed[5:8]).all()
    assert np.isnan(between(samples, np.full(4, NAN), 9)).all()
    after_a_known_one = between(samples, np.array([1.0, NAN, 2.0, 3.0]), 9)
    assert np.isnan(after_a_known_one).tolist() == [False, *[True] * 5, *[False] * 3]
    assert between(samples, np.array([NAN, NAN, 5.0, 3.0]), 9)[6:].tolist() == [5, 4, 3]
    assert between(samples[:3], np.array([1.0, 1.0, 2.0]), 9)[6:].tolist() == [2, 2, 2]


def test_a_distance_has_the_link_that_was_measured_before_it_or_after_it():
    samples, links = np.array([0, 4, 6]), np.array([7, -1, 9])
    distances = np.array([0.1, 0.1, 0.5, 0.1, 0.1, 0.1, 0.1, 0.4])
    found = nearest_measured(samples, links, distances, 0.5)
    assert found.tolist() == [7, 7, -1, 7, -1, 9, 9, 9]
